// SPDX-License-Identifier: MIT
// The code that docs/integrate.md shows, compiled and run. documentation_test.cpp compares the two.
#include <doctest/doctest.h>

#include <algorithm>
#include <crofton/bake/baked_scene.hpp>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/collide/broadphase.hpp>
#include <crofton/core/error.hpp>
#include <crofton/core/executor.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/cull/bound_set.hpp>
#include <crofton/cull/cull.hpp>
#include <crofton/scene/scene.hpp>
#include <cstdio>
#include <cstdlib>
#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <random>
#include <vector>

#include "../../ranges.hpp"

namespace {

// A cube of edge 1, as a mesh.
crofton::TriangleMesh cube() {
    crofton::TriangleMesh mesh;
    for (int i = 0; i < 8; ++i)
        mesh.positions.push_back({static_cast<float>(i & 1) - 0.5f, static_cast<float>(i >> 1 & 1) - 0.5f,
                                  static_cast<float>(i >> 2) - 0.5f});
    mesh.indices = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                    2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
    return mesh;
}

int drawn = 0;
void draw(crofton::scene::MeshId, const crofton::Transform&) {
    ++drawn;
}
int touching = 0;
void on_touch(crofton::IdPair) {
    ++touching;
}
void on_part(crofton::IdPair) {}

crofton::Frustum vulkan_frustum(const glm::mat4& view, float aspect) {
    glm::mat4 projection = glm::perspectiveRH_ZO(1.0f, aspect, 0.1f, 500.0f);  // near → 0, far → 1
    projection[1][1] *= -1.0f;                                                 // Vulkan's y points down
    return *crofton::frustum_of(glm::dmat4(projection * view), crofton::DepthRange::zero_to_one);
}

crofton::Frustum opengl_frustum(const glm::mat4& view, float aspect) {
    const glm::mat4 projection = glm::perspectiveRH_NO(1.0f, aspect, 0.1f, 500.0f);  // near → −1, far → 1
    return *crofton::frustum_of(glm::dmat4(projection * view), crofton::DepthRange::minus_one_to_one);
}

crofton::Frustum direct3d_frustum(const float* view_projection) {
    // Row vectors in row-major order are, byte for byte, column vectors in column-major order.
    const glm::dmat4 world_to_clip(glm::make_mat4(view_projection));
    return *crofton::frustum_of(world_to_clip, crofton::DepthRange::zero_to_one);
}

crofton::Frustum far_from_the_origin(const glm::dvec3& eye, const glm::dmat4& projection, const glm::dmat3& turn) {
    // Positions relative to the eye keep their digits: the matrix has no translation, the origin has it all.
    return *crofton::frustum_of(projection * glm::dmat4(turn), crofton::DepthRange::reversed_zero_to_one, eye);
}

// −1 clearly outside, 1 clearly inside, 0 too near the boundary for rounding to tell; from the clip inequalities alone.
int side(const glm::dvec4& clip, double near_z) {
    const double w = clip.w, margin = 1e-9 * std::abs(w);
    double least = w;
    for (const double s : {w + clip.x, w - clip.x, w + clip.y, w - clip.y, clip.z - near_z * w, w - clip.z})
        least = std::min(least, s);
    return least > margin ? 1 : least < -margin ? -1 : 0;
}

bool inside(const crofton::Frustum& frustum, const glm::dvec3& point) {
    for (const crofton::Plane& plane : frustum.view())
        if (glm::dot(plane.normal, point - frustum.origin) + plane.offset < 0.0) return false;
    return true;
}

void check_against_clip_space(const crofton::Frustum& frustum, const glm::dmat4& world_to_clip, double near_z) {
    std::mt19937 random(1);
    int counts[3] = {};
    for (int i = 0; i < 20'000; ++i) {
        glm::dvec3 point;
        for (int k = 0; k < 3; ++k) point[k] = 1200.0 * static_cast<double>(random()) / 4294967296.0 - 600.0;
        const int expected = side(world_to_clip * glm::dvec4(point, 1.0), near_z);
        ++counts[expected + 1];
        if (expected != 0) CHECK(inside(frustum, point) == (expected > 0));
    }
    CHECK(counts[0] > 1000);
    CHECK(counts[2] > 200);
}

}  // namespace

TEST_SUITE("engines/integrate") {
    TEST_CASE("a Vulkan matrix gives Vulkan's view volume") {
        const glm::mat4 view = glm::lookAtRH(glm::vec3(3, 2, 1), glm::vec3(0, 0, -9), glm::vec3(0, 1, 0));
        glm::mat4 projection = glm::perspectiveRH_ZO(1.0f, 1.5f, 0.1f, 500.0f);
        projection[1][1] *= -1.0f;
        check_against_clip_space(vulkan_frustum(view, 1.5f), glm::dmat4(projection * view), 0.0);
    }

    TEST_CASE("an OpenGL matrix gives OpenGL's view volume") {
        const glm::mat4 view = glm::lookAtRH(glm::vec3(3, 2, 1), glm::vec3(0, 0, -9), glm::vec3(0, 1, 0));
        const glm::mat4 projection = glm::perspectiveRH_NO(1.0f, 1.5f, 0.1f, 500.0f);
        check_against_clip_space(opengl_frustum(view, 1.5f), glm::dmat4(projection * view), -1.0);
    }

    TEST_CASE("a Direct3D matrix, row-major, row vectors, left-handed, gives Direct3D's view volume") {
        // XMMatrixPerspectiveFovLH(1, 1.5, 0.1, 500) as Direct3D lays it out, the view being the identity: looks along
        // +z.
        const float h = 1.0f / std::tan(0.5f), w = h / 1.5f, q = 500.0f / (500.0f - 0.1f);
        const float rows[16] = {w, 0, 0, 0, 0, h, 0, 0, 0, 0, q, 1, 0, 0, -q * 0.1f, 0};
        const crofton::Frustum frustum = direct3d_frustum(rows);
        CHECK(inside(frustum, {0, 0, 10}));
        CHECK_FALSE(inside(frustum, {0, 0, -10}));
        glm::dmat4 columns;
        for (int r = 0; r < 4; ++r)
            for (int c = 0; c < 4; ++c) columns[r][c] = rows[4 * r + c];
        check_against_clip_space(frustum, columns, 0.0);
    }

    TEST_CASE("a view ten million metres out is the view at home, moved") {
        const glm::dmat4 projection = crofton::view_to_clip(crofton::Camera{});
        const glm::dvec3 eye(1e7, -1e7, 1e7);
        const crofton::Frustum frustum = far_from_the_origin(eye, projection, glm::dmat3(1.0));
        CHECK(inside(frustum, eye + glm::dvec3(0, 0, -0.125)));
        CHECK_FALSE(inside(frustum, eye + glm::dvec3(0, 0, -0.0625)));
    }

    TEST_CASE("a frame: scene, tree, culled draws, touches, statistics") {
        using namespace crofton;

        scene::Scene scene;
        const scene::MeshId crate = scene.add_mesh(cube(), "crate").value();
        std::vector<scene::NodeId> nodes;
        for (int i = 0; i < 400; ++i) {
            const auto place =
                from_trs({2.0 * (i % 20), 0.0, -2.0 * (i / 20)}, glm::dquat(1, 0, 0, 0), glm::dvec3(1.0)).value();
            nodes.push_back(scene.add_node(scene::kNone, place).value());
            scene.add_instance(nodes.back(), crate).value();
        }
        scene.update();
        boxtree::BoxTree tree = boxtree::BoxTree::build(scene.world_boxes(), scene.layer_masks()).value();

        cull::VisibleSet visible;
        collide::Broadphase broadphase;
        std::vector<Obb> moved_boxes;
        Camera camera;
        camera.position = {19.0, 1.5, 10.0};
        for (int frame = 0; frame < 3; ++frame) {
            // 1. Move: the scene lists the changed boxes, and the tree takes all of them at once.
            const auto place = from_trs({0.6 * frame, 0.0, 0.0}, glm::dquat(1, 0, 0, 0), glm::dvec3(1.0)).value();
            if (!scene.set_local(nodes[0], place)) std::abort();
            scene.update();
            moved_boxes.clear();
            for (const scene::InstanceId id : scene.moved_instances()) moved_boxes.push_back(scene.world_boxes()[id]);
            if (!tree.move(scene.moved_instances(), moved_boxes)) std::abort();
            tree.refit();

            // 2. Draw the visible objects.
            cull::find_visible(tree, {.frustum = frustum_of(camera).value()}, visible);
            for (const boxtree::ItemId id : visible.ids()) draw(scene.mesh_of(id), scene.world(scene.node_of(id)));

            // 3. Handle pairs that began or ended to touch.
            if (!broadphase.update(scene.world_boxes())) std::abort();
            for (const IdPair pair : broadphase.began()) on_touch(pair);
            for (const IdPair pair : broadphase.ended()) on_part(pair);

            // 4. Print the cost.
            const cull::Statistics& cost = visible.statistics();
            std::printf("frame %d: %zu in view, %llu nodes and %llu boxes tested, %zu pairs\n", frame, visible.size(),
                        static_cast<unsigned long long>(cost.nodes_tested),
                        static_cast<unsigned long long>(cost.boxes_tested), broadphase.pairs().size());
        }
        CHECK(drawn > 300);
        CHECK(drawn < 1200);
        CHECK(touching == 1);
    }

    TEST_CASE("moving objects are culled outside the tree of static ones") {
        using namespace crofton;
        std::vector<Obb> boxes(300);
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            boxes[i].center = {static_cast<double>(i % 20) - 10.0, 0.0, -5.0 - static_cast<double>(i / 20)};
            boxes[i].half_extents = glm::vec3(0.3f);
        }
        boxtree::BoxTree tree = boxtree::BoxTree::build(boxes).value();
        std::vector<boxtree::ItemId> moving_ids{3, 77, 290};
        std::vector<Obb> moving_boxes{boxes[3], boxes[77], boxes[290]};
        cull::MovingBoxes movers;
        cull::VisibleSet visible, expected;
        const Camera camera;
        // Once: objects that begin to move leave the tree, and keep their ids and layers.
        for (const boxtree::ItemId id : moving_ids)
            if (!tree.detach(id)) std::abort();
        tree.refit();

        for (int frame = 0; frame < 30; ++frame) {
            // Every frame: the boxes are yours and are not copied.
            for (Obb& box : moving_boxes) box.center.y += 0.1;
            if (!movers.update(tree, moving_ids, moving_boxes)) std::abort();
            cull::find_visible(tree, movers, {.frustum = frustum_of(camera).value()}, visible);

            for (std::size_t k = 0; k < moving_ids.size(); ++k) boxes[moving_ids[k]] = moving_boxes[k];
            cull::find_visible(boxes, {}, {.frustum = frustum_of(camera).value()}, expected);
            CHECK(test::ranges::equal(visible.ids(), expected.ids()));
        }
        // Objects that have come to rest go back.
        if (!tree.attach(moving_ids.back(), moving_boxes.back())) std::abort();
        moving_ids.pop_back();
        moving_boxes.pop_back();

        CHECK(movers.update(tree, moving_ids, moving_boxes));
        cull::find_visible(tree, movers, {.frustum = frustum_of(camera).value()}, visible);
        CHECK(test::ranges::equal(visible.ids(), expected.ids()));
        CHECK(visible.size() > 100);
    }

    TEST_CASE("a baked scene is culled like the one it was baked from") {
        using namespace crofton;
        scene::Scene scene;
        const auto node = scene.add_node(scene::kNone, *from_trs({0, 0, -5}, glm::dquat(1, 0, 0, 0), glm::dvec3(1.0)));
        REQUIRE(scene.add_instance(*node, scene.add_mesh(cube()).value()));
        scene.update();
        const auto file = bake::bake(scene);
        REQUIRE(file);
        const auto baked = bake::BakedScene::from_memory(*file);  // or BakedScene::open("level.crofton")
        if (!baked) std::printf("%s\n", baked.error().message.c_str());
        cull::VisibleSet visible;
        cull::find_visible(baked->tree(), {.frustum = frustum_of(Camera{}).value()}, visible);
        for (const boxtree::ItemId id : visible.ids()) {
            const bake::InstanceRecord& instance = baked->instances()[id];
            draw(instance.mesh, baked->nodes()[instance.node].world);
        }
        CHECK(visible.size() == 1);
    }

    TEST_CASE("the host's allocator, log and threads") {
        const crofton::MemoryHooks hooks{
            [](void*, std::size_t bytes, std::size_t alignment) {
                return std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
            },
            [](void*, void* memory, std::size_t, std::size_t) { std::free(memory); }, nullptr};
        crofton::set_memory_hooks(hooks);  // before any other call
        crofton::set_log_handler([](void*, crofton::LogLevel,
                                    std::string_view message) { std::printf("%s\n", std::string(message).c_str()); },
                                 nullptr);
        crofton::ThreadPool pool(2);  // or an Executor over your own job system
        std::vector<crofton::Obb> boxes(1000);
        CHECK(crofton::boxtree::BoxTree::build(boxes, {}, pool));
        crofton::set_log_handler(nullptr, nullptr);
        crofton::reset_memory_hooks();
    }
}
