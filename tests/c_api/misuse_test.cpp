// SPDX-License-Identifier: MIT
// Callers' mistakes that no handle is to blame for: counts beyond memory, dead handles, calls without anything.
#include <cmath>
#include <cstdint>

#include "world_fixture.hpp"

using namespace crofton::capi_test;

namespace {

Tree tree_of_one_box() {
    const crofton_box box = box_at(0, 0, 0);
    crofton_tree* tree = nullptr;
    REQUIRE(crofton_tree_create(&box, nullptr, 1, nullptr, &tree) == CROFTON_OK);
    return Tree(tree);
}

}  // namespace

TEST_SUITE("capi/misuse") {
    TEST_CASE("a count larger than any array is refused before anything is read") {
        const crofton_box box = box_at(0, 0, 0);
        const View view = default_view();
        const VisibleSet visible = make_visible_set();
        const Broadphase broadphase = make_broadphase();
        const Scene scene = make_scene();
        const Triangulator triangulator = make_triangulator();
        const DepthCuller culler = make_depth_culler();
        crofton_tree* tree = nullptr;
        REQUIRE(crofton_tree_create(&box, nullptr, 1, nullptr, &tree) == CROFTON_OK);
        const Tree owner(tree);
        const Tetrahedron tetrahedron;
        std::uint32_t id = 0;
        std::uint8_t verdict = 0;
        const float floats[3] = {};
        const double doubles[3] = {};
        const crofton_ray ray{{0, 0, 0}, {0, 0, 1}, 1.0};
        crofton_ray_hit hit{};
        crofton_box result;
        for (const std::size_t count : {SIZE_MAX, SIZE_MAX / 2, SIZE_MAX / 8}) {
            crofton_tree* none = nullptr;
            CHECK(crofton_tree_create(&box, nullptr, count, nullptr, &none) == CROFTON_OUT_OF_RANGE);
            CHECK(none == nullptr);
            CHECK(crofton_tree_move(tree, &id, &box, count) == CROFTON_OUT_OF_RANGE);
            CHECK(cull_boxes(&box, nullptr, count, &view, nullptr, nullptr, visible.get()) == CROFTON_OUT_OF_RANGE);
            CHECK(crofton_classify(&view.frustum, &box, count, &verdict) == CROFTON_OUT_OF_RANGE);
            CHECK(crofton_broadphase_update(broadphase.get(), &box, nullptr, count, nullptr) == CROFTON_OUT_OF_RANGE);
            CHECK(crofton_boxes_validate(&box, count) == CROFTON_OUT_OF_RANGE);
            CHECK(crofton_fit_points(floats, count, 0, nullptr, &result) == CROFTON_OUT_OF_RANGE);
            CHECK(crofton_fit_points(doubles, count, 1, nullptr, &result) == CROFTON_OUT_OF_RANGE);
            CHECK(crofton_fit_boxes(&box, count, nullptr, &result) == CROFTON_OUT_OF_RANGE);
            CHECK(crofton_tree_raycast(tree, &ray, count, ~0u, &hit) == CROFTON_OUT_OF_RANGE);
            crofton_mesh mesh = tetrahedron.mesh();
            mesh.vertex_count = count;
            CHECK(crofton_scene_add_mesh(scene.get(), &mesh, &id) == CROFTON_OUT_OF_RANGE);
            mesh = tetrahedron.mesh();
            mesh.index_count = SIZE_MAX;
            CHECK(crofton_scene_add_mesh(scene.get(), &mesh, &id) == CROFTON_OUT_OF_RANGE);
            crofton_clustered_mesh* clustered = nullptr;
            CHECK(crofton_clustered_mesh_create(&mesh, 0, &clustered) == CROFTON_OUT_OF_RANGE);
            CHECK(clustered == nullptr);
            const crofton_depth_object object = crofton_default_depth_object();
            const crofton_picture_view picture = crofton_default_picture_view();
            const crofton_visible_cluster* clusters = nullptr;
            std::size_t found = 0;
            CHECK(crofton_depth_culler_find_visible(culler.get(), &object, count, &picture, nullptr, &clusters, &found,
                                                    nullptr) == CROFTON_OUT_OF_RANGE);
            auto polygon = sized<crofton_polygon>();
            polygon.points = doubles;
            polygon.point_count = count;
            auto triangles = sized<crofton_triangulation>();
            CHECK(crofton_triangulate(triangulator.get(), &polygon, 0, &triangles) == CROFTON_OUT_OF_RANGE);
        }
        // All is as before.
        CHECK(cull_tree(tree, &view, nullptr, nullptr, visible.get()) == CROFTON_OK);
    }

#if SIZE_MAX > UINT32_MAX
    TEST_CASE("a number of vertices, indices, meshes or children that 32 bits do not tell apart is refused unread") {
        const WorldHandle world = make_world();
        const Tetrahedron tetrahedron;
        const crofton_mesh solid = tetrahedron.mesh();
        const crofton_mesh_data data = data_of(tetrahedron);
        crofton_world_mesh mesh{};
        REQUIRE(crofton_world_add_mesh(world.get(), &data, &mesh) == CROFTON_OK);
        crofton_shape* shape = nullptr;
        crofton_region* region = nullptr;
        crofton_clustered_mesh* clustered = nullptr;
        const Triangulator triangulator = make_triangulator();
        const crofton_transform pose = translation(0, 0, 0);
        constexpr std::size_t kBeyond = std::size_t{UINT32_MAX} + 1;
        for (const std::size_t count : {kBeyond, 3 * kBeyond, SIZE_MAX / 64, SIZE_MAX / 16, SIZE_MAX / 8, SIZE_MAX}) {
            CAPTURE(count);
            crofton_world_mesh other{};
            for (const bool vertices : {true, false}) {
                auto large = data;
                (vertices ? large.position_count : large.index_count) = vertices ? count : std::max(count, 3 * kBeyond);
                CHECK(crofton_world_add_mesh(world.get(), &large, &other) == CROFTON_OUT_OF_RANGE);
                CHECK(crofton_world_replace_mesh(world.get(), mesh, &large) == CROFTON_OUT_OF_RANGE);
                auto options = crofton_default_region_options();
                options.meshes = &large;
                options.mesh_count = 1;
                CHECK(crofton_region_prepare(nullptr, 0, &options, nullptr, &region) == CROFTON_OUT_OF_RANGE);
                crofton_mesh triangles = solid;
                triangles.vertex_count = large.position_count;
                triangles.index_count = large.index_count;
                CHECK(crofton_clustered_mesh_create(&triangles, 0, &clustered) == CROFTON_OUT_OF_RANGE);
                auto description = crofton_default_shape_description();
                description.kind = CROFTON_SHAPE_MESH;
                description.mesh = &triangles;
                CHECK(crofton_shape_create(&description, &shape) == CROFTON_OUT_OF_RANGE);
                auto occluder = sized<crofton_occluder>();
                occluder.kind = CROFTON_OCCLUDER_PATCH;
                occluder.positions = solid.positions;
                occluder.indices = solid.indices;
                occluder.position_count = triangles.vertex_count;
                occluder.index_count = triangles.index_count;
                CHECK(crofton_world_set_occluders(world.get(), mesh, &occluder, 1) == CROFTON_OUT_OF_RANGE);
            }
            auto vertices = data;
            vertices.position_count = count;
            CHECK(crofton_world_set_vertices(world.get(), mesh, &vertices) != CROFTON_OK);
            auto options = crofton_default_region_options();
            options.max_objects = UINT64_MAX;
            const crofton_region_object object = crofton_default_region_object();
            CHECK(crofton_region_prepare(&object, count, &options, nullptr, &region) == CROFTON_OUT_OF_RANGE);
            options.meshes = &data;
            options.mesh_count = count;
            CHECK(crofton_region_prepare(nullptr, 0, &options, nullptr, &region) == CROFTON_OUT_OF_RANGE);
            auto description = crofton_default_shape_description();
            description.kind = CROFTON_SHAPE_COMPOUND;
            const crofton_shape* child = nullptr;
            description.children = &child;
            description.poses = &pose;
            description.child_count = count;
            CHECK(crofton_shape_create(&description, &shape) == CROFTON_OUT_OF_RANGE);
            const double square[8] = {0, 0, 1, 0, 1, 1, 0, 1};
            const std::uint32_t end = 4;
            auto polygon = sized<crofton_polygon>();
            polygon.points = square;
            polygon.point_count = 4;
            polygon.ring_ends = &end;
            polygon.ring_count = count;
            auto triangles = sized<crofton_triangulation>();
            CHECK(crofton_triangulate(triangulator.get(), &polygon, 0, &triangles) == CROFTON_OUT_OF_RANGE);
        }
        CHECK(shape == nullptr);
        CHECK(region == nullptr);
        CHECK(clustered == nullptr);
        CHECK(crofton_world_set_vertices(world.get(), mesh, &data) == CROFTON_OK);
    }
#endif

    TEST_CASE("a message says which number is at fault, and why") {
        const Tree tree = tree_of_one_box();
        std::uint32_t id = 0;
        std::size_t found = 0;
        const double center[3] = {}, nan = std::nan(""), nowhere[3] = {0, 0, nan};
        const auto near = [&](const double* at, double radius) {
            return tree_within_sphere(tree.get(), at, radius, ~0u, &id, 1, &found);
        };
        CHECK(near(center, nan) == CROFTON_NON_FINITE);
        CHECK(mentions(crofton_last_error(), "crofton_tree_overlap: radius is NaN or infinite"));
        CHECK(near(center, -1) == CROFTON_INVALID_ARGUMENT);
        CHECK(mentions(crofton_last_error(), "crofton_tree_overlap: radius is negative"));
        CHECK(near(nowhere, 1) == CROFTON_NON_FINITE);
        CHECK(mentions(crofton_last_error(), "center is NaN or infinite"));
        auto options = sized<crofton_world_options>();
        crofton_world* world = nullptr;
        options.contact_margin = nan;
        CHECK(crofton_world_create(&options, &world) == CROFTON_NON_FINITE);
        CHECK(mentions(crofton_last_error(), "crofton_world_create: contact_margin is NaN or infinite"));
        options.contact_margin = -1;
        CHECK(crofton_world_create(&options, &world) == CROFTON_INVALID_ARGUMENT);
        CHECK(mentions(crofton_last_error(), "contact_margin is negative"));
    }

    TEST_CASE("coordinates whose sum is beyond doubles are finite") {
        const Tree tree = tree_of_one_box();
        std::uint32_t id = 0;
        std::size_t found = 77;
        const double far[3] = {1.5e308, 1.5e308, 0};
        CHECK(tree_within_sphere(tree.get(), far, 1, ~0u, &id, 1, &found) == CROFTON_OK);
        CHECK(found == 0);
    }

    TEST_CASE("no arrays at all are empty input, not a crash") {
        const VisibleSet visible = make_visible_set();
        const Broadphase broadphase = make_broadphase();
        const View view = default_view();
        crofton_tree* tree = nullptr;
        REQUIRE(crofton_tree_create(nullptr, nullptr, 0, nullptr, &tree) == CROFTON_OK);
        const Tree owner(tree);
        std::uint32_t item = 0;
        CHECK(cull_tree(tree, &view, nullptr, nullptr, visible.get()) == CROFTON_OK);
        CHECK(cull_boxes(nullptr, nullptr, 0, &view, nullptr, nullptr, visible.get()) == CROFTON_OK);
        CHECK(crofton_tree_move(tree, nullptr, nullptr, 0) == CROFTON_OK);
        CHECK(crofton_tree_remove(tree, 0) != CROFTON_OK);
        CHECK(crofton_tree_refit(tree, 0) == CROFTON_OK);
        CHECK(crofton_tree_refit(tree, SIZE_MAX) == CROFTON_OK);
        CHECK(crofton_broadphase_update(broadphase.get(), nullptr, nullptr, 0, nullptr) == CROFTON_OK);
        crofton_box box = box_at(1, 2, 3);
        CHECK(crofton_fit_points(nullptr, 0, 0, nullptr, &box) != CROFTON_OK);
        CHECK(crofton_fit_boxes(nullptr, 0, nullptr, &box) != CROFTON_OK);
        box = box_at(1, 2, 3);
        CHECK(crofton_tree_insert(tree, &box, ~0u, &item) == CROFTON_OK);
        CHECK(crofton_tree_refit(tree, SIZE_MAX) == CROFTON_OK);
    }
}
