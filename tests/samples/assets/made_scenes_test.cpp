// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <assets/mesh_builder.hpp>
#include <assets/scene_source.hpp>
#include <cmath>
#include <cstring>
#include <error_of.hpp>
#include <filesystem>
#include <fstream>
#include <glm/geometric.hpp>
#include <map>
#include <numbers>
#include <set>

#include <box_mesh.hpp>

#include "gltf_asset.hpp"

using namespace crofton;
using assets::load_scene;
using assets::SceneSource;

namespace {

SceneSource made(const std::string& name, std::uint64_t seed = 1) {
    auto source = load_scene(name, {.seed = seed});
    REQUIRE_MESSAGE(source.has_value(), name);
    source->scene.update();
    return std::move(*source);
}

std::size_t triangles_of(const scene::Scene& scene, const char* begins = "") {
    std::size_t sum = 0;
    for (scene::InstanceId i = 0; i < scene.instance_count(); ++i)
        if (scene.mesh_name(scene.mesh_of(i)).starts_with(begins)) sum += scene.mesh(scene.mesh_of(i)).triangle_count();
    return sum;
}

// Corners by place, to the bit.
using Corner = std::array<float, 3>;

// Whether each edge is passed as often in one direction as in the other.
bool is_closed(const TriangleMesh& mesh) {
    std::map<std::pair<Corner, Corner>, int> open;
    const auto at = [&](std::size_t i) {
        const glm::vec3& p = mesh.positions[mesh.indices[i]];
        return Corner{p.x, p.y, p.z};
    };
    for (std::size_t t = 0; t < mesh.indices.size(); t += 3)
        for (std::size_t k = 0; k < 3; ++k) {
            const Corner a = at(t + k), b = at(t + (k + 1) % 3);
            open[a < b ? std::pair(a, b) : std::pair(b, a)] += a < b ? 1 : -1;
        }
    return std::all_of(open.begin(), open.end(), [](const auto& edge) { return edge.second == 0; });
}

std::size_t degenerate_triangles(const TriangleMesh& mesh) {
    std::size_t count = 0;
    for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
        const glm::dvec3 a(mesh.positions[mesh.indices[t]]), b(mesh.positions[mesh.indices[t + 1]]),
            c(mesh.positions[mesh.indices[t + 2]]);
        count += glm::length(glm::cross(b - a, c - a)) < 1e-10;
    }
    return count;
}

// Six times the volume.
double volume_of(const TriangleMesh& mesh) {
    double sum = 0.0;
    for (std::size_t t = 0; t < mesh.indices.size(); t += 3)
        sum += glm::dot(glm::dvec3(mesh.positions[mesh.indices[t]]),
                        glm::cross(glm::dvec3(mesh.positions[mesh.indices[t + 1]]),
                                   glm::dvec3(mesh.positions[mesh.indices[t + 2]])));
    return sum / 6.0;
}

// A digest of what there is and where, to a millimetre.
std::uint64_t digest(const scene::Scene& scene) {
    std::uint64_t hash = 14695981039346656037ull;
    const auto add = [&](double value) {
        hash = (hash ^ static_cast<std::uint64_t>(std::llround(1000.0 * value))) * 1099511628211ull;
    };
    for (scene::InstanceId i = 0; i < scene.instance_count(); ++i) {
        add(static_cast<double>(scene.mesh(scene.mesh_of(i)).triangle_count()));
        const glm::dvec3& at = scene.world(scene.node_of(i)).translation;
        for (int k = 0; k < 3; ++k) add(at[k]);
    }
    return hash;
}

bool same(const SceneSource& a, const SceneSource& b) {
    if (a.scene.mesh_count() != b.scene.mesh_count() || a.scene.instance_count() != b.scene.instance_count())
        return false;
    for (scene::MeshId m = 0; m < a.scene.mesh_count(); ++m) {
        const TriangleMesh &p = a.scene.mesh(m), &q = b.scene.mesh(m);
        if (p.positions.size() != q.positions.size() || p.indices != q.indices ||
            std::memcmp(p.positions.data(), q.positions.data(), p.positions.size() * sizeof(glm::vec3)) != 0)
            return false;
    }
    return std::memcmp(a.scene.world_boxes().data(), b.scene.world_boxes().data(),
                       a.scene.world_boxes().size_bytes()) == 0;
}

// Parts of a city as small as can be: tiles of 2 × 2, a house, a car.
std::string city_folder(bool with_buildings) {
    const std::filesystem::path folder =
        std::filesystem::temp_directory_path() / (with_buildings ? "crofton_city_parts" : "crofton_city_roads");
    std::filesystem::create_directories(folder);
    const auto write = [&](const char* name, float width, float height) {
        const TriangleMesh box =
            testing::box_mesh({-0.5f * width, 0.0f, -0.5f * width}, {0.5f * width, height, 0.5f * width});
        test_files::Asset asset;
        std::vector<float> corners;
        for (const glm::vec3& p : box.positions) corners.insert(corners.end(), {p.x, p.y, p.z});
        const std::size_t positions = asset.accessor(corners, "VEC3");
        asset.mesh(positions,
                   asset.accessor(std::vector<std::uint32_t>(box.indices.begin(), box.indices.end()), "SCALAR"));
        std::ofstream(folder / name, std::ios::binary) << asset.glb();
    };
    write("road_straight.glb", 2.0f, 0.1f);
    write("car_red.glb", 0.4f, 0.3f);
    if (with_buildings) write("building_A.glb", 1.8f, 2.0f);
    return folder.string();
}

}  // namespace

TEST_SUITE("assets/made scenes") {
    TEST_CASE("solids that the builder turns, cuts and draws out are closed, and their faces look outward") {
        const glm::vec3 color(1.0f);
        constexpr glm::dvec2 kCone[] = {{0.0, 0.0}, {1.0, 0.0}, {0.0, 3.0}};
        constexpr glm::dvec2 kRing[] = {{2.0, 0.0}, {3.0, 0.0}, {3.0, 1.0}, {2.0, 1.0}};
        const glm::dvec3 line[] = {{0, 0, 0}, {0, 0, 2}, {0, 0, 7}},
                         bent[] = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {2, 2, 5}};
        const double pi = std::numbers::pi;
        for (const bool turned : {false, true}) {
            assets::MeshBuilder cone, ring, gear, pipe;
            for (assets::MeshBuilder* b : {&cone, &ring, &gear, &pipe})
                if (turned) b->frame = {glm::dmat3(0, -1, 0, 1, 0, 0, 0, 0, 1), {5.0, 6.0, 7.0}};
            cone.lathe(kCone, 200, color);
            ring.lathe(kRing, 200, color, true);
            gear.gear(50, 2.0, 0.2, 1.0, 0.5, color);
            pipe.pipe(line, 0.1, 200, color);
            assets::MeshBuilder corners;
            corners.pipe(bent, 0.1, 40, color);
            CHECK(is_closed(corners.take()));
            const auto check = [&](assets::MeshBuilder& b, double volume, double tolerance) {
                const TriangleMesh mesh = b.take();
                CHECK(is_closed(mesh));
                CHECK(degenerate_triangles(mesh) == 0);
                CHECK(volume_of(mesh) == doctest::Approx(volume).epsilon(tolerance));
            };
            check(cone, pi, 1e-3);                            // π r² h / 3
            check(ring, pi * (9.0 - 4.0), 1e-3);              // π (R² − r²) h
            check(gear, 0.5 * pi * (2.1 * 2.1 - 1.0), 0.02);  // halfway up the teeth
            check(pipe, pi * 0.01 * 7.0, 1e-3);               // π r² length
        }
    }
    TEST_CASE("office, valley and hall have the intended size, and a path to walk") {
        const SceneSource office = made("office"), valley = made("valley"), hall = made("hall");
        CHECK(office.scene.instance_count() > 1500);
        CHECK(triangles_of(office.scene) > 700'000);
        CHECK(valley.scene.instance_count() > 7000);
        CHECK(triangles_of(valley.scene, "terrain") > 200'000);
        CHECK(triangles_of(valley.scene) > 1'000'000);
        CHECK(triangles_of(hall.scene, "engine") > 900'000);
        CHECK(triangles_of(hall.scene, "engine") < 1'200'000);
        std::size_t largest = 0;
        for (scene::MeshId m = 0; m < hall.scene.mesh_count(); ++m)
            largest = std::max(largest, hall.scene.mesh(m).triangle_count());
        CHECK(largest > 300'000);
        for (const SceneSource* source : {&office, &valley, &hall}) {
            CHECK(source->walk.size() >= 6);
            CHECK(source->one_sided.size() == source->scene.mesh_count());
            CHECK(source->movers.empty());
        }
    }
    TEST_CASE("no mesh of a made scene has a triangle without area, and what is built of solids is closed") {
        for (const char* name : {"office", "valley", "hall"}) {
            CAPTURE(name);
            const SceneSource source = made(name);
            for (scene::MeshId m = 0; m < source.scene.mesh_count(); ++m) {
                const TriangleMesh& mesh = source.scene.mesh(m);
                const std::string mesh_name(source.scene.mesh_name(m));
                CAPTURE(mesh_name);
                CHECK(degenerate_triangles(mesh) == 0);
                if (std::string(name) != "valley") CHECK(is_closed(mesh));
            }
        }
    }
    TEST_CASE("the same seed makes the same scene, another seed another one") {
        for (const char* name : {"office", "valley", "hall"}) {
            CAPTURE(name);
            CHECK(same(made(name, 3), made(name, 3)));
            CHECK_FALSE(same(made(name, 3), made(name, 4)));
        }
        CHECK(digest(made("office").scene) == 5640824108426789625u);
        CHECK(digest(made("valley").scene) == 13585132603926744496u);
        CHECK(digest(made("hall").scene) == 3210787049168668279u);
    }
    TEST_CASE("nobody walks through a wall of the office or into the valley's ground") {
        // Each step of the walk against each triangle of walls and ground, by signs of volumes.
        for (const char* name : {"office", "valley"}) {
            const SceneSource source = made(name);
            const auto side = [](const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d) {
                return glm::dot(glm::cross(b - a, c - a), d - a);
            };
            // Edges of walls lie in the walk's own plane.
            const glm::dvec3 aside(0.011, 0.0, 0.007);
            std::size_t crossed = 0;
            for (scene::InstanceId i = 0; i < source.scene.instance_count(); ++i) {
                const std::string_view mesh_name = source.scene.mesh_name(source.scene.mesh_of(i));
                if (mesh_name != "wall" && mesh_name != "terrain" && mesh_name != "column") continue;
                const TriangleMesh& mesh = source.scene.mesh(source.scene.mesh_of(i));
                const Transform& world = source.scene.world(source.scene.node_of(i));
                for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
                    std::array<glm::dvec3, 3> p;
                    for (std::size_t k = 0; k < 3; ++k) p[k] = world * glm::dvec3(mesh.positions[mesh.indices[t + k]]);
                    for (std::size_t s = 0; s + 1 < source.walk.size(); ++s) {
                        const glm::dvec3 a = source.walk[s] + aside, b = source.walk[s + 1] + aside;
                        if (side(p[0], p[1], p[2], a) * side(p[0], p[1], p[2], b) > 0.0) continue;
                        const double u = side(a, b, p[0], p[1]), v = side(a, b, p[1], p[2]), w = side(a, b, p[2], p[0]);
                        crossed += (u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0);
                    }
                }
            }
            CAPTURE(std::string(name));
            CHECK(crossed == 0);
        }
    }
    TEST_CASE("a folder of parts makes a city: tiles side by side, every car on the road") {
        const std::string folder = city_folder(true);
        CHECK(assets::is_made(folder));
        const SceneSource city = made(folder), again = made(folder), other = made(folder, 2);
        CHECK(same(city, again));
        CHECK(digest(city.scene) != digest(other.scene));
        CHECK(city.walk.size() == 4);
        std::map<std::string, std::size_t> count;
        std::set<std::pair<long, long>> tiles;
        for (scene::InstanceId i = 0; i < city.scene.instance_count(); ++i) {
            const std::string part(city.scene.mesh_name(city.scene.mesh_of(i)));
            ++count[part];
            const Aabb box = aabb_of(city.scene.world_boxes()[i]);
            if (part == "car_red") CHECK(box.min.y == doctest::Approx(0.6));  // on the road, at a scale of 6
            if (part == "car_red") continue;
            CHECK(box.min.y == doctest::Approx(0.0).epsilon(1e-3));
            const glm::dvec3 middle = box.center();
            // No two on one tile of 12 m.
            CHECK(tiles.insert({std::lround(middle.x / 12.0), std::lround(middle.z / 12.0)}).second);
        }
        CHECK(count["road_straight"] == 301);  // 7 + 7 streets of 25 tiles, less 49 crossings
        CHECK(count["building_A"] == 288);     // 36 blocks of 8
        CHECK(count["car_red"] > 50);
        for (const glm::dvec3& place : city.walk) CHECK(place.y == doctest::Approx(0.6 + 1.7));
    }
    TEST_CASE("a folder without buildings, or with a damaged part, is refused by name") {
        const auto roads = load_scene(city_folder(false));
        REQUIRE_FALSE(roads);
        CHECK(error_of(roads).code == ErrorCode::empty);
        CHECK(error_of(roads).message.find("building_") != std::string::npos);
        const std::string folder = city_folder(false);
        std::ofstream(std::filesystem::path(folder) / "building_B.gltf") << "{";
        const auto damaged = load_scene(folder);
        REQUIRE_FALSE(damaged);
        CHECK(error_of(damaged).message.find("building_B.gltf") != std::string::npos);
        std::filesystem::remove(std::filesystem::path(folder) / "building_B.gltf");
        CHECK_FALSE(assets::is_made(std::filesystem::temp_directory_path().string()));
    }
    TEST_CASE("KayKit's parts make a city of 2,000 instances") {
        const std::string folder = std::string(CROFTON_SHARED_DATA) + "/scenes/kaykit_city";
        if (!assets::holds_city_parts(folder)) {
            MESSAGE("skipped: " << folder << " is not there");
            return;
        }
        const SceneSource city = made(folder);
        CHECK(city.scene.instance_count() > 2000);
        CHECK(triangles_of(city.scene) > 500'000);
        CHECK(city.warnings.empty());
    }
}
