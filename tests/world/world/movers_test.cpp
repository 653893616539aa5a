// SPDX-License-Identifier: MIT
// Objects that move in every frame, and meshes that deform.
#include <doctest/doctest.h>
#include <algorithm>
#include <array>
#include <box_mesh.hpp>
#include <cmath>
#include <error_of.hpp>
#include <limits>
#include <oracle/random_boxes.hpp>

#include "../../view_request.hpp"
#include "box_at.hpp"
#include "model.hpp"

using namespace crofton;
using oracle::Model;
using oracle::NearMisses;

namespace {

std::vector<std::pair<std::uint32_t, std::uint32_t>> listed_pairs(const World& world) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
    for (const ObjectPair& pair : world.pairs()) pairs.emplace_back(pair.first.object.index, pair.second.object.index);
    return pairs;
}

std::vector<std::uint32_t> seen_ids(const World& world, const cull::View& view) {
    ViewResult visible;
    (void)world.view(request_of(view), visible);
    return {visible.ids().begin(), visible.ids().end()};
}

cull::View view_of_a_part() {
    Camera camera;
    camera.position.z = 40.0;
    camera.fov_y = 0.5;
    return {.frustum = frustum_of(camera).value(), .layer_mask = ~0u};
}

// A sheet of n · n vertices over [0, 1]² that waves.
TriangleMesh sheet(std::uint32_t n, double time) {
    TriangleMesh mesh;
    for (std::uint32_t i = 0; i < n * n; ++i) {
        const double x = double(i % n) / (n - 1), y = double(i / n) / (n - 1);
        mesh.positions.push_back(glm::vec3(x, y, 0.3 * std::sin(7.0 * x + time) * std::cos(5.0 * y - 2.0 * time)));
    }
    for (std::uint32_t y = 0; y + 1 < n; ++y)
        for (std::uint32_t x = 0; x + 1 < n; ++x) {
            const std::uint32_t a = y * n + x;
            for (const std::uint32_t i : {a, a + 1, a + n, a + n, a + 1, a + n + 1}) mesh.indices.push_back(i);
        }
    return mesh;
}

}  // namespace

TEST_SUITE("world/movers") {
    TEST_CASE("boxes that are set many at once count from the next update on, whatever part of them moves") {
        NearMisses random(31);
        World world({.updates_to_rest = 4});
        Model model;
        std::vector<ObjectHandle> objects;
        for (int i = 0; i < 300; ++i) {
            oracle::ModelObject object;
            object.bound = oracle::random_box(random, {}, 20.0);
            object.handle = world.add({.bound = object.bound}).value();
            model.objects[object.handle.index] = object;
            objects.push_back(object.handle);
        }
        const cull::View view = view_of_a_part();
        std::size_t most_moving = 0, bad_ones = 0;
        for (int frame = 0; frame < 90; ++frame) {
            // All, most, a few; some to where they are, a bad one now and then.
            const unsigned share = frame < 30 ? 1 : frame < 60 ? 2 : 9;
            std::vector<ObjectHandle> moved;
            std::vector<Obb> boxes;
            std::size_t bad = ~std::size_t{0};
            for (const ObjectHandle object : objects) {
                if (random.index(share) != 0 && object.index % 3 != 0) continue;
                Obb& box = model.objects[object.index].bound.box;
                if (random.index(8) != 0) box.center += 0.3 * random.direction();
                moved.push_back(object);
                boxes.push_back(box);
                if (random.index(400) != 0 || bad != ~std::size_t{0}) continue;
                bad = boxes.size() - 1;
                boxes.back().axes[1][0] = std::numeric_limits<float>::quiet_NaN();
            }
            const std::vector<std::uint32_t> seen_before = seen_ids(world, view);
            const auto set = world.set_bounds(moved, boxes);
            CHECK(set.has_value() == (bad == ~std::size_t{0}));
            if (!set) {
                ++bad_ones;
                CHECK(error_of(set).item == bad);
                CHECK(error_of(set).code == ErrorCode::non_finite);
                boxes[bad] = model.objects[moved[bad].index].bound.box;
                REQUIRE(world.set_bounds(moved, boxes).has_value());
            }
            CHECK(seen_ids(world, view) == seen_before);  // nothing counts before the update
            // One that moves gets other layers or another kind of bound in the same frame, or is hidden.
            oracle::ModelObject& other = model.objects[objects[random.index(300)].index];
            if (frame % 7 == 0) {
                other.hidden = !other.hidden;
                REQUIRE(world.set_hidden(other.handle, other.hidden).has_value());
                other.bound = oracle::random_box(random, {}, 20.0);
                REQUIRE(world.set_bound(other.handle, other.bound).has_value());
            } else if (frame % 7 == 1) {
                REQUIRE(world.set_bound(other.handle, Sphere{{}, 1.0}).has_value());
                REQUIRE(world.set_bound(other.handle, other.bound).has_value());
            }
            REQUIRE(world.update().has_value());
            most_moving = std::max(most_moving, world.statistics().moving);
            for (const auto& [id, object] : model.objects)
                CHECK(world.box_of(object.handle)->center == object.bound.box.center);
            CHECK(seen_ids(world, view) == model.visible(view));
            CHECK(listed_pairs(world) == model.pairs());
        }
        CHECK(most_moving > 290);
        CHECK(bad_ones > 3);
    }

    TEST_CASE("if a mover gets several boxes before an update, the last counts, read from the caller's structs") {
        struct Enemy {
            std::uint32_t health = 3;
            ObjectHandle object;
            Obb box;
        };
        constexpr std::size_t kCount = 150;
        World world({.pairs = false});
        std::vector<Enemy> enemies(kCount);
        for (std::size_t i = 0; i < kCount; ++i) {
            enemies[i].box.center.x = 3.0 * double(i);
            enemies[i].object = world.add({.bound = enemies[i].box}).value();
        }
        const auto set = [&] {
            return world.set_bounds({&enemies[0].object, kCount, sizeof(Enemy)},
                                    {&enemies[0].box, kCount, sizeof(Enemy)});
        };
        for (int frame = 0; frame < 4; ++frame) {
            for (Enemy& enemy : enemies) enemy.box.center.y += 1.0;
            REQUIRE(set().has_value());
            REQUIRE(world.update().has_value());
        }
        REQUIRE(world.statistics().moving == kCount);
        const auto move_first = [&](double by) {
            for (std::size_t i = 0; i < 10; ++i) enemies[i].box.center.y += by;
            REQUIRE(set().has_value());
        };
        move_first(1.0);
        move_first(-1.0);  // back to where they are
        REQUIRE(world.update().has_value());
        CHECK(world.statistics().boxes_changed == 0);
        move_first(2.0);
        move_first(3.0);
        REQUIRE(world.update().has_value());
        CHECK(world.statistics().boxes_changed == 10);
        for (const Enemy& enemy : enemies) CHECK(world.box_of(enemy.object)->center == enemy.box.center);
        // One becomes a sphere and a box again, another is removed: its handle is stale.
        REQUIRE(world.set_bound(enemies[70].object, Sphere{{}, 1.0}).has_value());
        REQUIRE(world.remove(enemies[80].object).has_value());
        for (Enemy& enemy : enemies) enemy.box.center.y += 1.0;
        const auto stale = set();
        REQUIRE(!stale);
        CHECK(error_of(stale).code == ErrorCode::stale_handle);
        CHECK(error_of(stale).item == 80);
        REQUIRE(world.update().has_value());
        for (const Enemy& enemy : enemies)
            if (&enemy != &enemies[80]) CHECK(world.box_of(enemy.object)->center == enemy.box.center);
        REQUIRE(world.set_bound(enemies[70].object, Sphere{{5.0, 0.0, 0.0}, 1.0}).has_value());
        REQUIRE(world.update().has_value());
        CHECK(world.box_of(enemies[70].object)->center.x == 5.0);
        Ray ray;
        ray.origin = {5.0, 0.0, 9.0};
        ray.direction = {0.0, 0.0, -1.0};
        const auto hit = world.raycast(ray);
        REQUIRE(hit.has_value());
        CHECK(hit->t == 8.0);  // a sphere's, not its box's
        // The index of the removed one is used again: the old handle stays stale.
        const auto fresh = world.add({.bound = Sphere{{}, 1.0}}).value();
        CHECK(fresh.index == enemies[80].object.index);
        CHECK(error_of(set()).item == 80);
    }

    TEST_CASE("set_transforms refuses bad nodes and names the first, and the others move") {
        constexpr std::size_t kCount = 200;
        World world;
        std::vector<NodeHandle> nodes;
        std::vector<Transform> places(kCount);
        for (std::size_t i = 0; i < kCount; ++i) {
            places[i].translation.x = double(i);
            nodes.push_back(world.add_node().value());
        }
        const TriangleMesh triangles = sheet(2, 0.0);
        const auto mesh = world.add_mesh({.positions = triangles.positions, .indices = triangles.indices}).value();
        std::vector<ObjectHandle> objects;
        for (const NodeHandle node : nodes) objects.push_back(world.add({.mesh = mesh, .node = node}).value());
        const auto check = [&](std::size_t bad, std::size_t other) {
            REQUIRE(world.update().has_value());
            for (std::size_t i = 0; i < kCount; ++i)
                if (i != bad && i != other) CHECK(world.transform_of(objects[i])->translation == places[i].translation);
        };
        REQUIRE(world.set_transforms(nodes, places).has_value());
        check(kCount, kCount);
        for (Transform& place : places) place.translation.y = 1.0;
        places[130].linear[1][1] = std::numeric_limits<double>::infinity();
        places[150].translation.z = 1e16;
        const auto set = world.set_transforms(nodes, places);
        REQUIRE(!set);
        CHECK(error_of(set).code == ErrorCode::non_finite);
        CHECK(error_of(set).item == 130);
        check(130, 150);
        CHECK(world.transform_of(objects[130])->translation.y == 0.0);
        CHECK(world.transform_of(objects[150])->translation.y == 0.0);
        places[130] = places[150] = {};
        REQUIRE(world.remove(nodes[64]).has_value());
        const auto stale = world.set_transforms(nodes, places);
        REQUIRE(!stale);
        CHECK(error_of(stale).code == ErrorCode::stale_handle);
        CHECK(error_of(stale).item == 64);
        REQUIRE(world.update().has_value());
        for (std::size_t i = 0; i < kCount; ++i)
            if (i != 64) CHECK(world.transform_of(objects[i])->translation == places[i].translation);
    }

    TEST_CASE("an update counts the nodes it moved and the pairs it looked at, and one without changes counts none") {
        World world;
        const NodeHandle root = world.add_node().value();
        std::array<NodeHandle, 3> nodes{};
        for (NodeHandle& node : nodes) node = world.add_node({.parent = root}).value();
        for (int i = 0; i < 6; ++i)
            (void)world.add({.bound = testing::box_at({i < 5 ? 0.9 * i : 20.0, 0.0, 0.0})}).value();
        REQUIRE(world.update().has_value());
        const auto counted = [&] {
            const collide::BatchStatistics& tests = world.statistics().box_tests;
            return tests.separated_by_face_a + tests.separated_by_face_b + tests.separated_by_edges + tests.hits;
        };
        // Four neighbours in a row meet, and the next ones are 0.8 apart.
        CHECK(world.statistics().objects == 6);
        CHECK(world.statistics().box_tests.hits == 4);
        CHECK(world.statistics().box_tests.separated_by_edges == 0);
        CHECK(world.statistics().box_pairs_tested >= 4);
        CHECK(counted() == world.statistics().box_pairs_tested);
        CHECK(world.statistics().contact_pairs_tested == 4);
        CHECK(world.statistics().contacts_us >= 0.0);
        REQUIRE(world.set_transform(root, Transform{glm::dmat3(1.0), {1.0, 0.0, 0.0}}).has_value());
        REQUIRE(world.set_transform(nodes[1], Transform{glm::dmat3(1.0), {0.0, 1.0, 0.0}}).has_value());
        REQUIRE(world.update().has_value());
        CHECK(world.statistics().nodes_updated == 4);
        REQUIRE(world.update().has_value());
        CHECK(world.statistics().nodes_updated == 0);
        CHECK(world.statistics().boxes_changed == 0);
        CHECK(world.statistics().box_pairs_tested == 0);
        CHECK(world.statistics().contact_pairs_tested == 0);
        CHECK(counted() == 0);
        CHECK(world.statistics().box_tests.refined == 0);
    }

    TEST_CASE("an object that is set to its present place comes to rest, also when others move on") {
        World world({.updates_to_rest = 3});
        std::vector<ObjectHandle> objects;
        std::vector<Obb> boxes(10);
        for (std::size_t i = 0; i < 10; ++i) {
            boxes[i].center.x = 3.0 * double(i);
            objects.push_back(world.add({.bound = boxes[i]}).value());
        }
        REQUIRE(world.update().has_value());
        const auto move_first = [&](std::size_t count) {
            for (std::size_t i = 0; i < count; ++i) boxes[i].center.y += 0.25;
            REQUIRE(world.set_bounds(objects, boxes).has_value());
            REQUIRE(world.update().has_value());
        };
        for (int frame = 0; frame < 4; ++frame) move_first(10);
        CHECK(world.statistics().moving == 10);
        for (int frame = 0; frame < 4; ++frame) {
            move_first(2);
            CHECK(world.statistics().boxes_changed == 2);
        }
        CHECK(world.statistics().moving == 2);
        CHECK(world.statistics().resting == 8);
    }

    TEST_CASE("a mesh that deforms costs its own pairs, wherever it stays within its box") {
        World world;
        const TriangleMesh block = testing::cube_mesh(0.5f);
        const auto still = world.add_mesh({.positions = block.positions, .indices = block.indices}).value(),
                   soft = world.add_mesh({.positions = block.positions, .indices = block.indices}).value();
        for (int i = 0; i < 40; ++i)
            REQUIRE(
                world.add({.mesh = still, .transform = Transform{glm::dmat3(1.0), {0.9 * i, 0.0, 0.0}}}).has_value());
        const auto object = world.add({.mesh = soft, .transform = Transform{glm::dmat3(1.0), {0.0, 0.9, 0.0}}}).value();
        REQUIRE(world.update().has_value());
        const std::size_t all = world.contacts().size();
        const auto touches = [&] {
            return std::count_if(world.contacts().begin(), world.contacts().end(), [&](const Contact& contact) {
                return contact.phase != ContactPhase::ended &&
                       (contact.first.object == object || contact.second.object == object);
            });
        };
        REQUIRE(touches() == 2);
        for (int frame = 0; frame < 6; ++frame) {
            // A tetrahedron in the upper half of the block's box, which one corner holds open, and the block again.
            auto now = block.positions;
            if (frame % 2 == 0)
                for (glm::vec3& p : now) p.y = p.y < 0.0f && p.x > 0.0f ? 0.4f : p.y;
            REQUIRE(world.set_vertices(soft, now).has_value());
            REQUIRE(world.update().has_value());
            CHECK(world.statistics().contact_pairs_tested <= 2);
            CHECK(touches() == (frame % 2 == 0 ? 1 : 2));
            CHECK(world.contacts().size() == all);  // one has ended, or began
        }
    }

    TEST_CASE("a mesh that deforms answers like one that has just been loaded") {
        constexpr std::uint32_t kSide = 40;
        World world({.mesh_depth = true});
        const TriangleMesh first = sheet(kSide, 0.0);
        const auto mesh = world.add_mesh({.positions = first.positions, .indices = first.indices}).value();
        const auto object = world.add({.mesh = mesh, .transform = Transform()}).value();
        const auto sphere = world.add({.bound = Sphere{{0.4, 0.6, 0.2}, 0.1}}).value();
        REQUIRE(world.update().has_value());
        std::size_t hits = 0, touches = 0;
        for (int frame = 0; frame < 30; ++frame) {
            TriangleMesh now = sheet(kSide, 0.4 * frame);
            if (frame % 10 == 9) std::reverse(now.indices.begin(), now.indices.end());  // other triangles
            if (frame % 13 == 12)
                for (glm::vec3& p : now.positions) p = {p.y, 4.0f * p.x * p.x, p.z};  // boxes wear out
            if (frame % 10 == 9 || frame % 10 == 0)
                REQUIRE(world.replace_mesh(mesh, {.positions = now.positions, .indices = now.indices}).has_value());
            else
                REQUIRE(world.set_vertices(mesh, now.positions).has_value());
            REQUIRE(world.update().has_value());

            World fresh({.mesh_depth = true});
            const auto copy = fresh.add_mesh({.positions = now.positions, .indices = now.indices}).value();
            REQUIRE(fresh.add({.mesh = copy, .transform = Transform()}).value().index == object.index);
            REQUIRE(fresh.add({.bound = Sphere{{0.4, 0.6, 0.2}, 0.1}}).value().index == sphere.index);
            REQUIRE(fresh.update().has_value());
            NearMisses random(static_cast<std::uint64_t>(40 + frame));
            for (int i = 0; i < 200; ++i) {
                Ray ray;
                ray.origin = {random.number(0.0, 1.0), random.number(0.0, 1.0), 2.0};
                ray.direction = {random.number(-0.2, 0.2), random.number(-0.2, 0.2), -1.0};
                const auto a = world.raycast(ray), b = fresh.raycast(ray);
                REQUIRE(a.has_value() == b.has_value());
                if (!a) continue;
                ++hits;
                CHECK(a->t == b->t);
                CHECK(a->triangle == b->triangle);
            }
            REQUIRE(world.pairs().size() == fresh.pairs().size());
            std::size_t met = 0;
            for (const Contact& contact : world.contacts()) {
                if (contact.phase == ContactPhase::ended) continue;
                ++met;
                REQUIRE(fresh.contacts().size() == 1);
                CHECK(contact.depth == fresh.contacts()[0].depth);
            }
            CHECK(met == fresh.contacts().size());
            touches += met;
        }
        CHECK(hits > 1000);
        CHECK(touches > 3);
    }
}
