// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <algorithm>
#include <assets/scene_source.hpp>
#include <cmath>
#include <cstring>
#include <error_of.hpp>

using namespace crofton;
using assets::load_scene;
using assets::SceneSource;

namespace {

SceneSource town(std::uint64_t seed, std::uint32_t instances = 0) {
    assets::LoadOptions options;
    options.seed = seed;
    options.instances = instances;
    auto source = load_scene("town", options).value();
    source.scene.update();
    return source;
}

std::size_t triangles(const scene::Scene& scene) {
    std::size_t sum = 0;
    for (scene::InstanceId i = 0; i < scene.instance_count(); ++i) sum += scene.mesh(scene.mesh_of(i)).triangle_count();
    return sum;
}

bool same_boxes(const scene::Scene& a, const scene::Scene& b) {
    return a.instance_count() == b.instance_count() &&
           std::memcmp(a.world_boxes().data(), b.world_boxes().data(), a.world_boxes().size_bytes()) == 0;
}

}  // namespace

TEST_SUITE("assets/town") {
    TEST_CASE("more than 16 million instances are refused") {
        assets::LoadOptions options;
        options.instances = 16'000'001;
        const auto source = load_scene("town", options);
        REQUIRE_FALSE(source.has_value());
        CHECK(error_of(source).code == ErrorCode::out_of_range);
    }

    TEST_CASE("every seed makes a town of about 3,000 instances and 300,000 triangles") {
        for (const std::uint64_t seed : {1u, 2u, 3u, 4u, 5u}) {
            const SceneSource source = town(seed);
            CHECK(source.scene.instance_count() > 2500);
            CHECK(source.scene.instance_count() < 3500);
            CHECK(triangles(source.scene) > 250'000);
            CHECK(triangles(source.scene) < 400'000);
            CHECK(source.movers.size() > 100);
            CHECK(source.walk.size() >= 4);
        }
    }

    TEST_CASE("the smallest and larger towns have about the requested size") {
        CHECK(town(1, 1).scene.instance_count() > 100);
        for (const std::uint32_t wanted : {1000u, 10'000u, 50'000u}) {
            const double made = static_cast<double>(town(1, wanted).scene.instance_count());
            CHECK(made > 0.75 * wanted);
            CHECK(made < 1.25 * wanted);
        }
    }

    TEST_CASE("the same seed makes the same town, another seed another one") {
        CHECK(same_boxes(town(7).scene, town(7).scene));
        CHECK_FALSE(same_boxes(town(7).scene, town(8).scene));
    }

    TEST_CASE("movers, and only they, move - a frame's poses do not depend on the frames before") {
        SceneSource a = town(1), b = town(1);
        for (const std::uint32_t frame : {1u, 2u, 50u}) {
            a.animate(frame);
            a.scene.update();
        }
        b.animate(50);
        b.scene.update();
        CHECK(same_boxes(a.scene, b.scene));
        const auto moved = b.scene.moved_instances();
        CHECK(std::equal(moved.begin(), moved.end(), b.movers.begin(), b.movers.end()));
    }

    TEST_CASE("vehicles drive forward without a jump, on the carriageway") {
        SceneSource source = town(2);
        const scene::InstanceId car = source.movers.back();
        glm::dvec3 last(0.0);
        for (std::uint32_t frame = 0; frame < 3000; ++frame) {
            source.animate(frame);
            source.scene.update();
            const Transform& world = source.scene.world(source.scene.node_of(car));
            if (frame > 0) {
                const glm::dvec3 step = world.translation - last;
                const double length = std::sqrt(step.x * step.x + step.y * step.y + step.z * step.z);
                CHECK(length < 13.5 / 60.0);
                CHECK(step.x * world.linear[0].x + step.z * world.linear[0].z > 0.0);
            }
            last = world.translation;
        }
    }

    TEST_CASE("facades are planar polygons with holes") {
        const SceneSource source = town(1);
        std::size_t with_holes = 0, parcels = 0;
        for (scene::MeshId m = 0; m < source.scene.mesh_count(); ++m) {
            const scene::PlanarPolygon* polygon = source.scene.polygon(m);
            if (!polygon || polygon->polygon.ring_count() < 2) continue;
            ++with_holes;
            if (source.scene.mesh_name(m) == "parcel") ++parcels;
            // Triangles of a polygon with n vertices and h holes, all vertices used: n + 2h − 2.
            const auto& p = polygon->polygon;
            CHECK(source.scene.mesh(m).triangle_count() == p.points.size() + 2 * (p.ring_count() - 1) - 2);
        }
        CHECK(with_holes > 100);
        CHECK(parcels > 0);
    }
}
