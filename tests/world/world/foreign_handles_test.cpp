// SPDX-License-Identifier: MIT
// Handles, and answers, of another World are refused by name.
#include <doctest/doctest.h>
#include <crofton/crofton.hpp>
#include <error_of.hpp>
#include <set>
#include <vector>

#include "box_at.hpp"
#include "occlusion_town.hpp"

using namespace crofton;
using namespace crofton::testing;

namespace {

// A World with a node, a mesh, an object of the mesh and a bound.
struct Furnished {
    World world;
    NodeHandle node = world.add_node().value();
    MeshHandle mesh = world.add_mesh(description_of(cuboid({1.0f, 1.0f, 1.0f}), true)).value();
    ObjectHandle object = world.add({.mesh = mesh, .node = node, .transform = at(0.0, 0.0, -5.0)}).value();
    ObjectHandle bound = world.add({.bound = box_at({0.0, 0.0, -9.0})}).value();
};

template <class T>
void check_foreign(const Result<T>& result) {
    const Error error = error_of(result);
    CHECK(error.code == ErrorCode::stale_handle);
    CHECK(error.message.find("another World") != std::string::npos);
}

}  // namespace

TEST_SUITE("world/foreign_handles") {
    TEST_CASE("every call that takes a handle refuses one of another World, and changes nothing") {
        Furnished a, b;
        REQUIRE(a.world.update().has_value());
        REQUIRE(b.world.update().has_value());
        CHECK(a.object.index == b.object.index);
        check_foreign(b.world.remove(a.object));
        check_foreign(b.world.remove(a.mesh));
        check_foreign(b.world.remove(a.node));
        check_foreign(b.world.set_transform(a.object, {}));
        check_foreign(b.world.set_transform(a.node, {}));
        check_foreign(b.world.set_transforms(std::vector{a.object}, std::vector{Transform{}}));
        check_foreign(b.world.set_transforms(std::vector{a.node}, std::vector{Transform{}}));
        check_foreign(b.world.set_bound(a.bound, box_at({})));
        check_foreign(b.world.set_bounds(std::vector{a.bound}, std::vector{box_at({})}));
        check_foreign(b.world.set_mesh(a.object, b.mesh));
        check_foreign(b.world.set_mesh(b.object, a.mesh));
        check_foreign(b.world.set_hidden(a.object, true));
        check_foreign(b.world.set_collides_with(a.object, 1));
        check_foreign(b.world.replace_mesh(a.mesh, description_of(cuboid({2.0f, 2.0f, 2.0f}), true)));
        check_foreign(b.world.set_vertices(a.mesh, cuboid({2.0f, 2.0f, 2.0f}).positions));
        check_foreign(b.world.set_layers(a.object, 1));
        check_foreign(b.world.set_layers(a.node, 1));
        check_foreign(b.world.set_parent(a.node, {}));
        check_foreign(b.world.set_parent(b.node, a.node));
        check_foreign(b.world.set_user(a.object, 1));
        check_foreign(b.world.set_occludes(a.object, false));
        check_foreign(b.world.set_shape(a.object, nullptr));
        check_foreign(b.world.find_occluders(a.mesh));
        check_foreign(b.world.set_occluders(a.mesh, {}));
        check_foreign(b.world.user_of(a.object));
        check_foreign(b.world.box_of(a.object));
        check_foreign(b.world.transform_of(a.object));
        check_foreign(b.world.add({.mesh = a.mesh}));
        check_foreign(b.world.add({.mesh = b.mesh, .node = a.node}));
        check_foreign(b.world.add_node({.parent = a.node}));
        CHECK_FALSE(b.world.contains(a.object));
        CHECK_FALSE(b.world.contains(a.mesh));
        CHECK_FALSE(b.world.contains(a.node));
        CHECK(b.world.occluders_of(a.mesh).empty());
        CHECK(b.world.clusters_of(a.mesh) == nullptr);
        CHECK(b.world.object_count() == 2);
        REQUIRE(b.world.update().has_value());
        CHECK(b.world.statistics().boxes_changed == 0);
    }

    TEST_CASE("a list with a handle of another World: the other handles are obeyed, and the error names its place") {
        Furnished a, b;
        const ObjectHandle second = b.world.add({.bound = box_at({2.0, 0.0, -9.0})}).value();
        REQUIRE(b.world.update().has_value());
        const std::vector objects{b.bound, a.bound, second};
        const std::vector boxes{box_at({0.0, 7.0, 0.0}), box_at({0.0, 8.0, 0.0}), box_at({0.0, 9.0, 0.0})};
        const Result<void> moved = b.world.set_bounds(objects, boxes);
        check_foreign(moved);
        CHECK(moved.error().item == 1);
        REQUIRE(b.world.update().has_value());
        CHECK(b.world.box_of(b.bound).value().center.y == 7.0);
        CHECK(b.world.box_of(second).value().center.y == 9.0);
        const NodeHandle node = b.world.add_node().value();
        const Result<void> turned = b.world.set_transforms(std::vector{a.node, node}, std::vector<Transform>(2));
        check_foreign(turned);
        CHECK(turned.error().item == 0);
    }

    TEST_CASE("an answer to a view of another World names no occluders") {
        Furnished a, b;
        REQUIRE(a.world.update().has_value());
        REQUIRE(b.world.update().has_value());
        ViewResult visible;
        REQUIRE(a.world.view({.camera = Camera{}, .occlusion = OcclusionOptions{}}, visible).has_value());
        Vector<OccluderRef> occluders;
        CHECK(error_of(b.world.hidden_by(b.bound, visible, occluders)).code == ErrorCode::invalid_argument);
        CHECK(error_of(b.world.drawn_occluders(visible, occluders)).code == ErrorCode::invalid_argument);
        REQUIRE(a.world.hidden_by(a.bound, visible, occluders).has_value());
        CHECK(occluders.size() == 1);
        check_foreign(a.world.hidden_by(b.object, visible, occluders));
        CHECK(occluders.size() == 1);
    }

    TEST_CASE("handles of removed objects, of other Worlds and unset ones give different errors") {
        Furnished a;
        REQUIRE(a.world.remove(a.object).has_value());
        const Error removed = error_of(a.world.user_of(a.object));
        CHECK(removed.code == ErrorCode::stale_handle);
        CHECK(removed.message.find("has been removed") != std::string::npos);
        for (const ObjectHandle unset : {ObjectHandle{}, ObjectHandle{0, 0}}) {
            const Error error = error_of(a.world.user_of(unset));
            CHECK(error.code == ErrorCode::stale_handle);
            CHECK(error.message.find("never set") != std::string::npos);
        }
    }

    TEST_CASE("a thousand Worlds whose objects came and went accept no handle of another") {
        std::set<std::pair<std::uint32_t, std::uint32_t>> given;
        for (int w = 0; w < 1000; ++w) {
            World world({.pairs = false});
            for (int i = 0; i < 4; ++i) {
                const ObjectHandle object = world.add({.bound = box_at({})}).value();
                CHECK(object.generation != 0);
                CHECK(given.emplace(object.index, object.generation).second);
                REQUIRE(world.remove(object).has_value());
                REQUIRE(world.update().has_value());
            }
        }
        static_assert(sizeof(ObjectHandle) == 8 && sizeof(NodeHandle) == 8 && sizeof(MeshHandle) == 8);
    }

    TEST_CASE("a World that is moved keeps its handles") {
        Furnished a;
        World moved(std::move(a.world));
        CHECK(moved.contains(a.object));
        CHECK(moved.user_of(a.bound).has_value());
    }
}
