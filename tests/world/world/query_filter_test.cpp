// SPDX-License-Identifier: MIT
// Queries that ignore objects answer as a World in which these objects are hidden.
#include <doctest/doctest.h>
#include <array>
#include <cmath>
#include <crofton/convex/query.hpp>
#include <crofton/crofton.hpp>
#include <glm/geometric.hpp>
#include <span>
#include <string>
#include <vector>

#include "../../shape/convex/surfaces.hpp"
#include "cubes.hpp"

using namespace crofton;
using namespace crofton::testing;

namespace {

std::string text_of(const std::optional<ObjectHit>& hit) {
    if (!hit) return "none";
    return doctest::toString(hit->object.index).c_str() + std::string(" at ") + std::to_string(hit->t) + " " +
           std::to_string(hit->triangle);
}

// The same objects twice: bounds, meshes, shapes, ground, a region; resting and moving.
class Pair {
  public:
    explicit Pair(std::uint64_t seed) : random(seed) {
        const auto ground = convex::Shape::half_space({{0.0, -1.0, 0.0}, 0.0}).value();
        std::vector<RegionObject> of_region;
        for (int i = 0; i < 12; ++i)
            of_region.push_back({.bound = Sphere{4.0 * random.direction(), 0.6}, .layers = layers()});
        const Region region = Region::prepare(of_region).value();
        std::vector<std::array<ObjectHandle, 2>> made;
        for (int i = 0; i < 40; ++i) {
            const convex::Shape shape = any_shape(random, 0.8);
            const Obb box{4.0 * random.direction(), glm::mat3(random.rotation()), glm::vec3(0.7f)};
            ObjectDescription description{.bound = box, .layers = layers()};
            if (i % 4 == 1) description.bound = Sphere{box.center, 0.8};
            if (i % 4 == 2) description.shape = &shape;
            if (i == 0) description.bound = Obb{{0.0, -4.0, 0.0}}, description.shape = &ground;
            made.push_back({});
            for (std::size_t w = 0; w < 2; ++w) {
                if (i % 4 == 3) {
                    description.bound = {};
                    description.mesh = meshes[w];
                    description.transform = Transform{glm::dmat3(random_turn), box.center};
                }
                made.back()[w] = world(w).add(description).value();
            }
            if (i % 4 == 3) random_turn = random.rotation();
        }
        for (std::size_t w = 0; w < 2; ++w) regions[w] = world(w).attach(region, {0.0, 1.0, 0.0}).value();
        update();
        for (int step = 0; step < 2; ++step) {
            for (int i = 1; i < 40; i += 8) {
                const Bound to = Sphere{4.0 * random.direction(), 0.8};
                for (std::size_t w = 0; w < 2; ++w)
                    world(w).set_bound(made[static_cast<std::size_t>(i)][w], to).value();
            }
            update();
        }
        for (const auto& both : made) {
            if (random.index(3) != 0) continue;
            ignored.push_back(both[0]);
            hidden.set_hidden(both[1], true).value();
        }
        for (std::uint32_t i = 0; i < 12; i += 3) {
            ignored.push_back(all.object_in(regions[0], i).value());
            hidden.set_hidden(hidden.object_in(regions[1], i).value(), true).value();
        }
        update();
    }

    World& world(std::size_t w) { return w == 0 ? all : hidden; }
    void update() {
        all.update().value();
        hidden.update().value();
    }
    std::uint32_t layers() { return 1u + static_cast<std::uint32_t>(random.index(3)); }

    RandomShapes random;
    World all, hidden;  // the second: those of `ignored` are hidden
    MeshHandle meshes[2] = {all.add_mesh(described(box_mesh(glm::vec3(-0.7f), glm::vec3(0.7f)))).value(),
                            hidden.add_mesh(described(box_mesh(glm::vec3(-0.7f), glm::vec3(0.7f)))).value()};
    RegionHandle regions[2];
    glm::dmat3 random_turn{1.0};
    std::vector<ObjectHandle> ignored;
};

std::vector<std::uint32_t> indices_of(const Vector<ObjectRef>& found) {
    std::vector<std::uint32_t> indices;
    for (const ObjectRef& ref : found) indices.push_back(ref.object.index);
    return indices;
}

void check_closest(const std::optional<ClosestObject>& found, const std::optional<ClosestObject>& expected) {
    REQUIRE(found.has_value() == expected.has_value());
    if (!found) return;
    CHECK(found->object.index == expected->object.index);
    CHECK(found->distance == expected->distance);
    CHECK(found->on_object == expected->on_object);
}

}  // namespace

TEST_CASE("queries that ignore objects answer as if these were hidden") {
    int hits = 0, found_objects = 0, casts = 0;
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
        Pair worlds(seed);
        for (int query = 0; query < 50; ++query) {
            CAPTURE(seed);
            CAPTURE(query);
            const std::uint32_t layers = query % 3 == 0 ? 1u : ~0u;
            const QueryFilter filter{layers, worlds.ignored};
            const glm::dvec3 from = 5.0 * worlds.random.direction(), way = 9.0 * worlds.random.direction();
            const Ray ray{from, way};
            const auto hit = worlds.all.raycast(ray, filter);
            CHECK(text_of(hit) == text_of(worlds.hidden.raycast(ray, {layers})));
            hits += hit ? 1 : 0;
            CHECK(worlds.all.raycast_any(ray, filter) == hit.has_value());
            Vector<ObjectHit> along, expected_along;
            worlds.all.raycast_all(ray, along, filter);
            worlds.hidden.raycast_all(ray, expected_along, {layers});
            REQUIRE(along.size() == expected_along.size());
            for (std::size_t i = 0; i < along.size(); ++i) CHECK(text_of(along[i]) == text_of(expected_along[i]));

            Vector<ObjectRef> found, expected;
            const auto compare = [&](const auto&... probe) {
                worlds.all.overlap(probe..., found, filter);
                worlds.hidden.overlap(probe..., expected, {layers});
                CHECK(indices_of(found) == indices_of(expected));
                found_objects += static_cast<int>(found.size());
                for (const double limit : {0.3, 1e300})
                    check_closest(worlds.all.closest(probe..., limit, filter),
                                  worlds.hidden.closest(probe..., limit, {layers}));
            };
            const convex::Shape shape = any_shape(worlds.random, 0.6);
            const RigidTransform pose{worlds.random.rotation(), 0.8 * from};
            compare(Obb{pose.translation, glm::mat3(pose.rotation), glm::vec3(1.0f)});
            compare(Sphere{pose.translation, 1.0});
            compare(collide::Capsule{pose.translation, pose.translation + glm::dvec3(0, 1, 0), 0.5});
            compare(shape, pose);
            const bool ignore_overlaps = query % 2 == 0;
            const convex::CastOptions options{.ignore_initial_overlaps = ignore_overlaps};
            const auto met = worlds.all.cast(shape, pose, {.velocity = way}, options, filter).value(),
                       expected_met = worlds.hidden.cast(shape, pose, {.velocity = way}, options, {layers}).value();
            REQUIRE(met.has_value() == expected_met.has_value());
            if (!met) continue;
            ++casts;
            CHECK(met->object.index == expected_met->object.index);
            // Within the tolerance of a cast: where it ends depends on the order in which objects are visited.
            CHECK(std::abs(met->time - expected_met->time) <= 1e-6);
            CHECK(glm::dot(met->normal, expected_met->normal) >=
                  (expected_met->normal == glm::dvec3(0.0) ? 0.0 : 1.0 - 1e-6));
            CHECK(std::abs(met->distance - expected_met->distance) <= 1e-6);
        }
    }
    CHECK(hits > 500);
    CHECK(found_objects > 2000);
    CHECK(casts > 500);
}

TEST_CASE("an object does not hit itself if it is ignored") {
    World world;
    const auto capsule = convex::Shape::capsule(0.6f, 0.3f).value();
    const RigidTransform standing{glm::dmat3(1.0), {0.0, 0.9, 0.0}};
    const auto hero =
        world.add({.transform = Transform{standing.rotation, standing.translation}, .shape = &capsule}).value();
    const auto wall = world.add({.bound = Obb{{5.0, 0.0, 0.0}, glm::mat3(1.0f), glm::vec3(1.0f)}}).value();
    world.update().value();
    const Ray ray{standing.translation, {1.0, 0.0, 0.0}};
    const QueryFilter others{.ignored = {&hero, 1}};
    CHECK(world.raycast(ray)->object == hero);
    CHECK(world.raycast(ray, others)->object == wall);
    CHECK(world.closest(capsule, standing, 100.0)->object == hero);
    CHECK(world.closest(capsule, standing, 100.0, others)->object == wall);
    const auto hit = world.cast(capsule, standing, {.velocity = {10.0, 0.0, 0.0}}, {}, others).value();
    REQUIRE(hit.has_value());
    CHECK(hit->object == wall);
    CHECK(hit->time == doctest::Approx((5.0 - 1.0 - 0.3) / 10.0).epsilon(1e-3));
}

TEST_CASE("stale handles and handles of other Worlds ignore nothing") {
    World world, other;
    const auto gone = world.add({.bound = Obb{{2.0, 0.0, 0.0}}}).value();
    const auto foreign = other.add({.bound = Obb{{2.0, 0.0, 0.0}}}).value();
    world.update().value();
    world.remove(gone).value();
    world.update().value();
    const auto now = world.add({.bound = Obb{{2.0, 0.0, 0.0}}}).value();
    world.update().value();
    REQUIRE(now.index == gone.index);
    REQUIRE(now.index == foreign.index);
    const Ray ray{{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}};
    const std::vector<ObjectHandle> without_effect{gone, foreign, ObjectHandle{}};
    CHECK(world.raycast(ray, {~0u, without_effect})->object == now);
    CHECK(world.closest(Sphere{{0.0, 0.0, 0.0}, 0.5}, 10.0, {~0u, without_effect})->object == now);
}
