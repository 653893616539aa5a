// SPDX-License-Identifier: MIT
// Memory ends in a query or an edit: the program ends with the message that SECURITY.md promises, or goes on; nothing
// else, whichever allocation it was.
#include <doctest/doctest.h>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/collide/broadphase.hpp>
#include <crofton/collide/narrow_phase.hpp>
#include <crofton/crofton.hpp>
#include <crofton/cull/bound_set.hpp>
#include <crofton/cull/cull.hpp>
#include <crofton/cull/lights.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <crofton/occlude/occlusion.hpp>
#include <crofton/radiosity/patches.hpp>
#include <crofton/radiosity/solver.hpp>
#include <crofton/scene/scene.hpp>
#include <cstdlib>
#include <limits>

#include "ending.hpp"
#include "shapes.hpp"

using namespace crofton;

namespace {

using testing::boxes, testing::grid, testing::sweep_ending;

const Frustum kFrustum = *frustum_of(Camera{});
const cull::View kView{kFrustum, ~0u};

boxtree::BoxTree tree_of(std::size_t count) {
    return boxtree::BoxTree::build(boxes(count)).value();
}

Obb moved(Obb box, double x) {
    box.center.x += x;
    return box;
}

TriangleMesh solid_box() {
    TriangleMesh mesh;
    Obb box;
    box.half_extents = glm::vec3(1.0f);
    for (const glm::dvec3& p : corners(box)) mesh.positions.emplace_back(p);
    mesh.indices = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                    2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
    return mesh;
}

// Objects with bounds, and with a mesh under a node; updated.
struct Lived {
    World world;
    Vector<ObjectHandle> objects;
    MeshHandle mesh;
    NodeHandle node;

    Lived() {
        const TriangleMesh triangles = solid_box();
        mesh = world.add_mesh({triangles.positions, triangles.indices, true, true}).value();
        node = world.add_node().value();
        for (const Obb& box : boxes(100)) objects.push_back(world.add({.bound = Bound(box)}).value());
        for (int i = 0; i < 4; ++i) {
            Transform place;
            place.translation = {2.5 * i, 0.0, -10.0};
            objects.push_back(world.add({.mesh = mesh, .node = node, .transform = place}).value());
        }
        REQUIRE(world.update());
    }
};

}  // namespace

TEST_SUITE("memory/ending") {
    TEST_CASE("edits of a tree, and what it hands out") {
        const testing::FailingMemory memory;
        boxtree::BoxTree tree = tree_of(3000);
        const Vector<Obb> more = boxes(200);
        sweep_ending("insert", [&] {
            for (const Obb& box : more) (void)tree.insert(box);
        });
        sweep_ending("move, refit", [&] {
            for (boxtree::ItemId i = 0; i < 500; ++i) (void)tree.move(i, moved(tree.boxes()[i], 50.0));
            tree.refit();
        });
        sweep_ending("remove", [&] {
            for (boxtree::ItemId i = 0; i < 500; ++i) (void)tree.remove(i);
            tree.refit();
        });
        sweep_ending("detach, insert_detached, attach", [&] {
            for (boxtree::ItemId i = 0; i < 100; ++i) (void)tree.detach(i);
            const auto item = tree.insert_detached();
            (void)tree.attach(*item, more[0]);
        });
        sweep_ending("rebuild_step", [&] {
            for (boxtree::ItemId i = 0; i < 1500; ++i) (void)tree.move(i, moved(tree.boxes()[i], 90.0));
            tree.refit();
            for (std::size_t i = 0; i < 400 && !tree.rebuild_step(20000); ++i) (void)tree.insert(more[i % 200]);
        });
        sweep_ending("serialise", [&] { (void)tree.serialise(); });
        sweep_ending("spatial_order", [&] { (void)tree.spatial_order(); });
    }

    TEST_CASE("refusals name what was wrong, also where memory has ended for their text") {
        const testing::FailingMemory memory;
        boxtree::BoxTree tree = tree_of(20);
        const Obb bad = moved({}, std::numeric_limits<double>::quiet_NaN());
        sweep_ending("a box that is not finite", [&] {
            const auto refused = tree.move(7, bad);
            const Error& error = refused.error();
            if (error.code != ErrorCode::non_finite || error.item != 7) std::_Exit(1);
        });
        CHECK(testing::endings_survived > 0);
    }

    TEST_CASE("views of trees, lists, moving items, lights") {
        const testing::FailingMemory memory;
        const boxtree::BoxTree tree = tree_of(3000);
        const Vector<Obb> list = boxes(3000);
        for (const auto order : {cull::ResultOrder::ascending, cull::ResultOrder::tree}) {
            sweep_ending("tree", [&] {
                cull::VisibleSet visible;
                find_visible(tree, kView, visible, {.order = order});
            });
            sweep_ending("list", [&] {
                cull::VisibleSet visible;
                cull::find_visible(list, {}, kView, visible, {.order = order});
            });
        }
        sweep_ending("many views", [&] {
            const cull::View views[2] = {kView, kView};
            cull::MaskedVisibleSet visible;
            (void)find_visible(tree, views, visible);
        });
        sweep_ending("ranges", [&] {
            const boxtree::ItemId ids[] = {1, 2, 70};
            Vector<std::uint64_t> bits;
            Vector<cull::ItemRange> ranges;
            cull::to_bits(ids, 100, bits);
            cull::merge_ranges(bits, 1, ranges);
        });
        sweep_ending("BoundSet", [&] {
            cull::BoxSet set;
            set.assign(list);
            cull::VerdictBits bits;
            cull::find_visible(set, std::span<const Obb>(list), kView, bits);
        });
        sweep_ending("MovingBoxes", [&] {
            auto built = boxtree::BoxTree::build(std::span(list).first(100));
            if (!built) return;
            boxtree::BoxTree& resting = *built;
            Vector<boxtree::ItemId> items;
            for (int i = 0; i < 50; ++i) {
                items.push_back(static_cast<boxtree::ItemId>(i));
                (void)resting.detach(items.back());
            }
            resting.refit();
            cull::MovingBoxes moving;
            if (!moving.update(resting, items, std::span(list).first(50))) return;
            cull::VisibleSet visible;
            cull::find_visible(resting, moving, kView, visible);
        });
        sweep_ending("lights", [&] {
            const auto froxels = cull::FroxelGrid::build(Camera{});
            if (!froxels) return;
            const Sphere points[] = {{{0, 0, -5}, 2.0}, {{1, 0, -9}, 3.0}};
            cull::FroxelLights lights;
            (void)cull::find_lights(*froxels, points, {}, lights);
            cull::CasterFilter receivers;
            (void)receivers.set_sun(kFrustum, std::span(list).first(20), {0, 1, 0});
            Vector<std::uint32_t> wanted;
            receivers.find_casters(list, wanted);
        });
    }

    TEST_CASE("pairs, contacts, rays") {
        const testing::FailingMemory memory;
        const boxtree::BoxTree tree = tree_of(3000);
        const Vector<Obb> list = boxes(500);
        sweep_ending("Broadphase", [&] {
            collide::Broadphase broadphase;
            (void)broadphase.update(list);
            const std::uint32_t first[] = {3};
            (void)broadphase.update_moved(list, first);
        });
        sweep_ending("overlapping", [&] {
            Vector<boxtree::ItemId> items;
            collide::overlapping(tree, list[0], items);
        });
        const TriangleMesh flat = grid(8);
        TriangleMesh turned = flat;
        for (glm::vec3& p : turned.positions) p = {p.x, p.z, p.y - 4.0f};
        auto a = mesh::MeshTree::build(flat, {.refittable = true}).value();
        const auto b = mesh::MeshTree::build(turned).value();
        sweep_ending("contacts of meshes", [&] {
            Vector<mesh::MeshContact> found;
            mesh::contacts(a, b, {}, found);
            Vector<mesh::TrianglePair> pairs;
            mesh::intersecting_triangles(a, b, {}, pairs);
            (void)mesh::separating_motion(a, b, {}, found);
        });
        sweep_ending("a mesh that deforms, is copied, gets rays", [&] {
            (void)a.refit(flat.positions);
            mesh::MeshTree copy = a;
            (void)copy.prepare_rays();
        });
    }

    TEST_CASE("a World") {
        const testing::FailingMemory memory;
        Lived lived;
        World& world = lived.world;
        const Vector<Obb> more = boxes(30);
        sweep_ending("create", [] { (void)World().update(); });
        sweep_ending("add, update", [&] {
            for (const Obb& box : more) (void)world.add({.bound = Bound(moved(box, 1.0))});
            (void)world.update();
        });
        sweep_ending("move, update, three times", [&] {
            for (int frame = 0; frame < 3; ++frame) {
                for (std::size_t i = 0; i < 30; ++i)
                    (void)world.set_bound(lived.objects[i], Bound(moved(more[i], frame)));
                Transform place;
                place.translation.x = frame;
                (void)world.set_transform(lived.node, place);
                (void)world.update();
            }
        });
        sweep_ending("remove, update", [&] {
            for (std::size_t i = 0; i < 30; ++i) (void)world.remove(lived.objects[i]);
            (void)world.remove(lived.node);
            (void)world.update();
        });
        const TriangleMesh triangles = solid_box();
        sweep_ending("meshes and nodes", [&] {
            (void)world.add_mesh({triangles.positions, triangles.indices});
            (void)world.replace_mesh(lived.mesh, {triangles.positions, triangles.indices});
            (void)world.set_vertices(lived.mesh, triangles.positions);
            (void)world.find_occluders(lived.mesh);
            const auto node = world.add_node({.parent = lived.node});
            if (node) (void)world.set_parent(*node, {});
            (void)world.update();
        });
        sweep_ending("views", [&] {
            ViewResult visible;
            (void)world.view({.camera = Camera{}}, visible);
            (void)world.view(
                {.camera = Camera{}, .occlusion = OcclusionOptions{.size = {32, 32}, .list_occluded = true}}, visible);
            Vector<OccluderRef> occluders;
            REQUIRE(world.drawn_occluders(visible, occluders).has_value());
            (void)world.hidden_by(lived.objects[0], visible, occluders);
        });
        sweep_ending("queries", [&] {
            Vector<ObjectRef> found;
            world.overlap(more[0], found);
            Vector<ObjectHit> hits;
            world.raycast_all({{0, 0, 0}, {0, 0, -1}}, hits);
            (void)world.raycast({{0, 0, 0}, {0, 0, -1}});
            (void)world.closest(more[0], 100.0);
        });
    }

    TEST_CASE("scenes, occluders, light") {
        const testing::FailingMemory memory;
        scene::Scene scene;
        const auto mesh = scene.add_mesh(grid(2)).value();
        Vector<scene::NodeId> nodes;
        for (int i = 0; i < 40; ++i) {
            nodes.push_back(scene.add_node(scene::kNone, {}).value());
            (void)scene.add_instance(nodes.back(), mesh);
        }
        scene.update();
        sweep_ending("Scene::update", [&] {
            Transform place;
            place.translation.x = 1.0;
            for (const scene::NodeId node : nodes) (void)scene.set_local(node, place);
            (void)scene.set_parent(nodes[3], nodes[4]);
            (void)scene.remove_node(nodes[5]);
            (void)scene.replace_mesh(mesh, grid(3));
            scene.update();
        });
        Camera camera;
        const auto view = occlude::occlusion_view_of(camera).value();
        const Vector<Obb> list = boxes(200);
        sweep_ending("OccluderSet, OcclusionBuffer", [&] {
            occlude::OccluderSet set;
            const auto shape = set.add_mesh(solid_box());
            if (shape) (void)set.place(*shape, {});
            Obb wall;
            wall.center = {0, 0, -3};
            (void)set.place(wall);
            auto buffer = occlude::OcclusionBuffer::create({32, 32});
            if (!buffer) return;
            buffer->draw(set, view);
            occlude::VisibleSet visible;
            occlude::find_visible(list, {}, *buffer, visible);
            Vector<occlude::OccluderId> ids;
            buffer->hidden_by(moved(wall, 0.0), ids);
        });
        sweep_ending("find_occluders", [&] { (void)occlude::find_occluders(solid_box()); });
        const TriangleMesh floor = grid(3);
        const Vector<radiosity::Material> materials(floor.triangle_count(), {glm::vec3(1.0f), glm::vec3(0.5f)});
        const auto patches = radiosity::make_patches(TriangleMesh(floor), materials).value();
        auto solver = radiosity::Solver::create(patches, {.lines = 1000}).value();
        sweep_ending("Solver::run", [&] {
            solver.run();
            (void)solver.checkpoint();
            (void)solver.irradiance();
        });
        MESSAGE(testing::endings_tried << " allocations failed, " << testing::endings_survived
                                       << " of which the operation survived");
    }
}
