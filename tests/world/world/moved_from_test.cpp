// SPDX-License-Identifier: MIT
// What has been moved from, of all modules. tests/view/cull/moved_from_test.cpp has the answers of culling alone.
#include <doctest/doctest.h>
#include <crofton/bake/baked_scene.hpp>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/collide/broadphase.hpp>
#include <crofton/convex/query.hpp>
#include <crofton/cull/bound_set.hpp>
#include <crofton/cull/lights.hpp>
#include <crofton/lines/lines.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <crofton/occlude/occlusion.hpp>
#include <crofton/pvs/pvs.hpp>
#include <crofton/scene/scene.hpp>
#include <crofton/triangulate/triangulate.hpp>
#include <crofton/world/object_manifold.hpp>
#include <crofton/world/world.hpp>
#include <error_of.hpp>
#include <utility>

#include "box_at.hpp"

using namespace crofton;
using testing::box_at;

namespace {

TriangleMesh cube() {
    TriangleMesh mesh;
    for (int i = 0; i < 8; ++i)
        mesh.positions.push_back({i & 1 ? 1.0f : -1.0f, i & 2 ? 1.0f : -1.0f, i & 4 ? 1.0f : -1.0f});
    mesh.indices = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                    2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
    return mesh;
}

const TriangleMesh kCube = cube();

World one_box() {
    World world;
    REQUIRE(world.add({.bound = Bound(box_at({0, 0, -5}, 1.0f))}).has_value());
    REQUIRE(world.update().has_value());
    return world;
}

ViewRequest forward() {
    return {.camera = Camera{}, .occlusion = OcclusionOptions{}};
}

// What a class promises that owns a state which it alone knows: it may be assigned to, and destroyed.
template <class Type>
void move_around(Type first, Type second) {
    Type third(std::move(first));
    first = std::move(third);
    third = std::move(second);
    Type& same = third;
    third = std::move(same);
    second = std::move(third);
    std::swap(first, second);
}

}  // namespace

TEST_SUITE("world/moved_from") {
    TEST_CASE("a moved-from ViewResult is empty, and may be used again") {
        const World world = one_box();
        ViewResult visible;
        REQUIRE(world.view(forward(), visible).has_value());
        const ViewResult kept(std::move(visible));
        CHECK(kept.size() == 1);
        CHECK(visible.size() == 0);
        CHECK(visible.inside_count() == 0);
        CHECK_FALSE(visible.has_occlusion());
        CHECK(visible.occlusion_buffer() == nullptr);
        CHECK(visible.occlusion_statistics().occluders_drawn == 0);
        REQUIRE(world.view(forward(), visible).has_value());
        CHECK(visible.size() == 1);
    }

    TEST_CASE("a moved-from MultiViewResult is empty, and may be used again") {
        const World world = one_box();
        const ViewRequest views[2] = {forward(), forward()};
        MultiViewResult visible;
        REQUIRE(world.view(std::span(views), visible).has_value());
        const MultiViewResult kept(std::move(visible));
        CHECK(kept.view_count() == 2);
        CHECK(visible.size() == 0);
        CHECK(visible.view_count() == 0);
        REQUIRE(world.view(std::span(views), visible).has_value());
        CHECK(visible.view_count() == 2);
        CHECK(visible.size() == 1);
    }

    TEST_CASE("a moved-from occlude::VisibleSet is empty") {
        const Obb boxes[1] = {box_at({0, 0, -5}, 1.0f)};
        auto buffer = *occlude::OcclusionBuffer::create();
        buffer.draw(occlude::OccluderSet(), *occlude::occlusion_view_of(Camera{}));
        occlude::VisibleSet visible;
        occlude::find_visible(boxes, {}, buffer, visible);
        const occlude::VisibleSet kept(std::move(visible));
        CHECK(kept.size() == 1);
        CHECK(visible.size() == 0);
        CHECK(visible.ids().empty());
        CHECK(visible.verdicts().empty());
    }

    TEST_CASE("lists of boxes that were moved from are empty, and views of them see nothing") {
        const Obb boxes[2] = {box_at({0, 0, -5}, 1.0f), box_at({3, 0, -5}, 1.0f)};
        auto tree = *boxtree::BoxTree::build(boxes);
        const boxtree::ItemId items[2] = {0, 1};
        for (const boxtree::ItemId item : items) REQUIRE(tree.detach(item).has_value());
        cull::MovingBoxes moving;
        REQUIRE(moving.update(tree, items, boxes).has_value());
        const cull::MovingBoxes kept(std::move(moving));
        CHECK(kept.size() == 2);
        CHECK(moving.size() == 0);
        cull::VisibleSet visible;
        cull::find_visible(tree, moving, {*frustum_of(Camera{})}, visible);
        CHECK(visible.size() == 0);
        cull::find_visible(tree, kept, {*frustum_of(Camera{})}, visible);
        CHECK(visible.size() == 2);
    }

    TEST_CASE("shadow receivers that were moved from need no caster") {
        const Obb receivers[1] = {box_at({0, 0, -5}, 1.0f)};
        cull::CasterFilter set;
        REQUIRE(set.set_sun(*frustum_of(Camera{}), receivers, {0, 1, 0}).has_value());
        const cull::CasterFilter kept(std::move(set));
        CHECK(kept.wants(box_at({0, 3, -5}, 1.0f)));
        CHECK_FALSE(set.wants(box_at({0, 3, -5}, 1.0f)));
    }

    TEST_CASE("visible sets that have been moved from hold no cell: all is drawn") {
        pvs::BakeGeometry geometry{cube(), {}, {}, {box_at({0, 0, 0}, 1.0f)}};
        geometry.object_of.assign(geometry.mesh.triangle_count(), 0);
        const Aabb room[1] = {{{-3, -3, -3}, {-2, -2, -2}}};
        const glm::dvec3 eye(-2.5);
        const std::uint32_t ids[1] = {0};
        for (const auto& cells : {*pvs::Cells::grid(room[0], {2, 2, 2}), *pvs::Cells::boxes(room)}) {
            auto bake = *pvs::Bake::create(geometry, cells, {.epsilon = 0.1});
            REQUIRE(bake.run().has_value());
            auto sets = *pvs::Pvs::finish(bake);
            const pvs::Pvs kept(std::move(sets));
            CHECK(kept.visible_from(eye, pvs::Mode::conservative).size() == 1);
            CHECK(sets.find_cell(eye) == pvs::kNoCell);
            CHECK(sets.object_count() == 0);
            CHECK(sets.visible_from(eye, pvs::Mode::conservative).empty());
            CHECK(sets.counts().all() == 0);
            Vector<std::uint32_t> seen;
            CHECK(sets.keep_visible(eye, pvs::Mode::conservative, ids, seen) == pvs::kNoCell);
            CHECK(seen.size() == 1);
        }
        auto cells = *pvs::Cells::boxes(room);
        const pvs::Cells kept(std::move(cells));
        CHECK(kept.find(eye) == 0);
        CHECK(cells.size() == 0);
        CHECK(cells.find(eye) == pvs::kNoCell);
    }

    TEST_CASE("contacts that have been moved from are none, and may be looked for again") {
        const auto sphere = *convex::Shape::sphere(1.0);
        const RigidTransform place;
        convex::Manifolds found;
        convex::contact_manifolds({sphere, place}, {sphere, place}, {}, found);
        convex::Manifolds kept(std::move(found));
        CHECK(kept.all().size() == 1);
        CHECK(found.all().empty());
        convex::contact_manifolds({sphere, place}, {sphere, place}, {}, found);
        CHECK(found.all().size() == 1);
    }

    TEST_CASE("a moved-from World answers as an empty one, knows none of the old handles, and may be used again") {
        World world({.contact_margin = 0.5});
        const auto sphere = *convex::Shape::sphere(1.0);
        const auto mesh = *world.add_mesh({.positions = kCube.positions, .indices = kCube.indices});
        const ObjectHandle box = *world.add({.bound = Bound(box_at({0, 0, -5}, 1.0f))}),
                           ball = *world.add({.shape = &sphere});
        const NodeHandle node = *world.add_node();
        REQUIRE(world.update().has_value());
        World kept(std::move(world));
        CHECK(kept.object_count() == 2);

        const auto is_empty = [&](const World& empty) {
            ViewResult visible;
            MultiViewResult views;
            Vector<ObjectHit> hits;
            Vector<ObjectRef> found{{box, 7}};
            Vector<ShapeHit> shape_hits;
            Vector<ObjectManifold> manifolds;
            Vector<OccluderRef> occluders;
            const ViewRequest requests[] = {forward(), forward()};
            const RigidTransform here;
            CHECK(empty.object_count() == 0);
            CHECK_FALSE(empty.contains(box));
            CHECK_FALSE(empty.contains(node));
            CHECK_FALSE(empty.contains(mesh));
            CHECK(error_of(empty.user_of(box)).code == ErrorCode::stale_handle);
            CHECK_FALSE(empty.box_of(box).has_value());
            CHECK_FALSE(empty.transform_of(ball).has_value());
            CHECK_FALSE(empty.place_of(box).has_value());
            CHECK(empty.occluders_of(mesh).empty());
            CHECK(empty.clusters_of(mesh) == nullptr);
            CHECK(empty.statistics().objects == 0);
            CHECK(empty.tree().item_count() == 0);
            CHECK(empty.pairs().empty());
            CHECK(empty.contacts().empty());
            CHECK(empty.view(forward(), visible).has_value());
            CHECK(visible.size() == 0);
            CHECK(empty.view(requests, views).has_value());
            CHECK(views.size() == 0);
            CHECK(empty.drawn_occluders(visible, occluders).has_value());
            CHECK_FALSE(empty.raycast({{0, 0, 0}, {0, 0, -1}}).has_value());
            CHECK_FALSE(empty.raycast_any({{0, 0, 0}, {0, 0, -1}}));
            empty.raycast_all({{0, 0, 0}, {0, 0, -1}}, hits);
            CHECK(hits.empty());
            empty.overlap(Sphere{{0, 0, -5}, 1.0}, found);
            CHECK(found.empty());
            empty.overlap(sphere, here, found);
            CHECK(found.empty());
            CHECK_FALSE(empty.closest(Sphere{{0, 0, -5}, 1.0}, 10.0).has_value());
            CHECK_FALSE(empty.closest(sphere, here, 10.0).has_value());
            const auto hit = empty.cast(sphere, here, {{0, 0, -9}}, {});
            CHECK((hit.has_value() && !hit->has_value()));
            CHECK(empty.cast_all(sphere, here, {{0, 0, -9}}, {}, shape_hits).has_value());
            CHECK(empty.contact_manifolds(sphere, here, {}, manifolds).has_value());
            CHECK(manifolds.empty());
        };
        is_empty(world);
        CHECK(error_of(world.remove(box)).code == ErrorCode::stale_handle);
        CHECK(error_of(world.set_transform(node, {})).code == ErrorCode::stale_handle);
        CHECK(error_of(world.remove(mesh)).code == ErrorCode::stale_handle);
        CHECK(world.update().has_value());
        is_empty(world);

        World again = World();
        const World other(std::move(again));
        const ObjectHandle added = *again.add({.shape = &sphere});
        CHECK(again.update().has_value());
        CHECK(again.contains(added));
        CHECK_FALSE(again.contains(ball));
        CHECK(again.raycast({{0, 0, 5}, {0, 0, -1}}).has_value());
    }

    TEST_CASE("every class that may be moved can be assigned to and destroyed afterwards") {
        const Obb boxes[2] = {box_at({0, 0, -5}, 1.0f), box_at({3, 0, -5}, 1.0f)};
        const TriangleMesh mesh = cube();
        move_around(one_box(), World());
        move_around(scene::Scene(), scene::Scene());
        move_around(*boxtree::BoxTree::build(boxes), *boxtree::BoxTree::build(boxes));
        move_around(collide::Broadphase(), collide::Broadphase());
        move_around(*mesh::MeshTree::build(mesh), *mesh::MeshTree::build(mesh));
        move_around(*convex::Hull::build(mesh.positions), *convex::Hull::build(mesh.positions));
        move_around(occlude::OccluderSet(), occlude::OccluderSet());
        move_around(*occlude::OcclusionBuffer::create(), *occlude::OcclusionBuffer::create());
        move_around(triangulate::Triangulator(), triangulate::Triangulator());
        move_around(*lines::LineTracer::build(mesh), *lines::LineTracer::build(mesh));
        move_around(*lines::BundleTracer::build(mesh), *lines::BundleTracer::build(mesh));
        scene::Scene scene;
        const auto node = *scene.add_node(scene::kNone, {});
        REQUIRE(scene.add_instance(node, *scene.add_mesh(mesh)).has_value());
        scene.update();
        const auto file = *bake::bake(scene);
        move_around(*bake::BakedScene::from_memory(file), *bake::BakedScene::from_memory(file));
    }
}
