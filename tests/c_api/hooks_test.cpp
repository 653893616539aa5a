// SPDX-License-Identifier: MIT
#include <crofton/capi/crofton.h>

#include <atomic>
#include <crofton/core/error.hpp>
#include <crofton/core/executor.hpp>
#include <map>
#include <mutex>
#include <thread>

#include "aligned_memory.hpp"
#include "handles.hpp"

using namespace crofton::capi_test;

namespace {

struct Counter {
    std::atomic<std::size_t> allocations = 0, bytes_live = 0, calls = 0;
};

void* count_allocate(void* user, std::size_t bytes, std::size_t alignment) {
    auto& counter = *static_cast<Counter*>(user);
    ++counter.allocations;
    counter.bytes_live += bytes;
    return crofton::testing::aligned_block(bytes, alignment);
}

void count_release(void* user, void* memory, std::size_t bytes, std::size_t) {
    static_cast<Counter*>(user)->bytes_live -= bytes;
    crofton::testing::free_block(memory);
}

// A job system of the host's, here the library's own pool.
void pool_for(void* user, std::size_t count, std::size_t grain, crofton_range_task task, void* data) {
    static_cast<crofton::ThreadPool*>(user)->parallel_for(
        count, grain, [&](std::size_t begin, std::size_t end, unsigned worker) { task(data, begin, end, worker); });
}

std::string logged;
uint32_t logged_level = 99;
std::string asserted;

std::vector<crofton_box> row_of_boxes(std::size_t count) {
    std::vector<crofton_box> boxes;
    for (std::size_t i = 0; i < count; ++i)
        boxes.push_back(box_at(static_cast<double>(i % 97) - 48.0, static_cast<double>(i % 31) - 15.0,
                               -static_cast<double>(i) * 0.05));
    return boxes;
}

std::vector<std::uint32_t> seen(const std::vector<crofton_box>& boxes, const crofton_jobs* jobs) {
    crofton_tree* tree = nullptr;
    REQUIRE(crofton_tree_create(boxes.data(), nullptr, boxes.size(), jobs, &tree) == CROFTON_OK);
    const Tree owner(tree);
    const VisibleSet visible = make_visible_set();
    const View view = default_view();
    REQUIRE(cull_tree(tree, &view, nullptr, jobs, visible.get()) == CROFTON_OK);
    const std::uint32_t* ids = nullptr;
    std::size_t count = 0;
    REQUIRE(visible_set_items(visible.get(), &ids, nullptr, &count) == CROFTON_OK);
    return {ids, ids + count};
}

}  // namespace

TEST_SUITE("capi/hooks") {
    TEST_CASE("hooks of a wrong size or without functions are refused") {
        crofton_memory_hooks memory{sizeof memory - 1, nullptr, count_allocate, count_release};
        CHECK(crofton_set_memory_hooks(&memory) == CROFTON_WRONG_SIZE);
        memory = {sizeof memory, nullptr, count_allocate, nullptr};
        CHECK(crofton_set_memory_hooks(&memory) == CROFTON_INVALID_ARGUMENT);
        const Scene scene = make_scene();
        crofton_jobs jobs{0, nullptr, 1, pool_for};
        CHECK(crofton_scene_update(scene.get(), &jobs, nullptr) == CROFTON_WRONG_SIZE);
        jobs = {sizeof jobs, nullptr, 0, pool_for};
        CHECK(crofton_scene_update(scene.get(), &jobs, nullptr) == CROFTON_INVALID_ARGUMENT);
        jobs = {sizeof jobs, nullptr, 1, nullptr};
        CHECK(crofton_scene_update(scene.get(), &jobs, nullptr) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_log(CROFTON_LOG_INFO, nullptr) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_log(9, "text") == CROFTON_INVALID_ARGUMENT);
    }

    TEST_CASE("all memory comes from the host's allocator and goes back to it") {
        Counter counter;
        const crofton_memory_hooks hooks{sizeof hooks, &counter, count_allocate, count_release};
        REQUIRE(crofton_set_memory_hooks(&hooks) == CROFTON_OK);
        CHECK(seen(row_of_boxes(5000), nullptr).size() > 100);
        CHECK(counter.allocations > 2);
        CHECK(counter.bytes_live == 0);
        REQUIRE(crofton_set_memory_hooks(nullptr) == CROFTON_OK);
    }

    TEST_CASE("a warm query allocates nothing") {
        const auto boxes = row_of_boxes(5000);
        Counter counter;
        const crofton_memory_hooks hooks{sizeof hooks, &counter, count_allocate, count_release};
        REQUIRE(crofton_set_memory_hooks(&hooks) == CROFTON_OK);
        {
            crofton_tree* tree = nullptr;
            REQUIRE(crofton_tree_create(boxes.data(), nullptr, boxes.size(), nullptr, &tree) == CROFTON_OK);
            const Tree owner(tree);
            const VisibleSet visible = make_visible_set();
            const View view = default_view();
            REQUIRE(cull_tree(tree, &view, nullptr, nullptr, visible.get()) == CROFTON_OK);
            const std::size_t before = counter.allocations;
            for (int i = 0; i < 10; ++i) REQUIRE(cull_tree(tree, &view, nullptr, nullptr, visible.get()) == CROFTON_OK);
            CHECK(counter.allocations == before);
        }
        REQUIRE(crofton_set_memory_hooks(nullptr) == CROFTON_OK);
    }

    TEST_CASE("a warm search for the triangles of a picture allocates nothing, and its memory is the host's") {
        Counter counter;
        const crofton_memory_hooks hooks{sizeof hooks, &counter, count_allocate, count_release};
        REQUIRE(crofton_set_memory_hooks(&hooks) == CROFTON_OK);
        {
            const Tetrahedron tetrahedron;
            const crofton_mesh mesh = tetrahedron.mesh();
            crofton_clustered_mesh* made = nullptr;
            REQUIRE(crofton_clustered_mesh_create(&mesh, 1, &made) == CROFTON_OK);
            const ClusteredMesh clustered(made);
            const DepthCuller culler = make_depth_culler();
            std::vector<crofton_depth_object> objects(200, crofton_default_depth_object());
            for (std::size_t i = 0; i < objects.size(); ++i) {
                objects[i].mesh = made;
                objects[i].to_clip[12] = static_cast<float>(i % 20) * 0.1f - 1.0f;
                objects[i].to_clip[13] = static_cast<float>(i / 20) * 0.2f - 1.0f;
            }
            const crofton_picture_view picture = crofton_default_picture_view();
            const crofton_visible_cluster* clusters = nullptr;
            std::size_t count = 0, warm = 0;
            for (int i = 0; i < 10; ++i) {
                REQUIRE(crofton_depth_culler_find_visible(culler.get(), objects.data(), objects.size(), &picture,
                                                          nullptr, &clusters, &count, nullptr) == CROFTON_OK);
                CHECK(count > 20);
                if (i == 0) warm = counter.allocations;
                CHECK(counter.allocations == warm);
            }
            CHECK(warm > 4);
        }
        CHECK(counter.bytes_live == 0);
        REQUIRE(crofton_set_memory_hooks(nullptr) == CROFTON_OK);
    }

    TEST_CASE("a World lives in the host's memory, and its warm queries allocate nothing") {
        Counter counter;
        const crofton_memory_hooks hooks{sizeof hooks, &counter, count_allocate, count_release};
        REQUIRE(crofton_set_memory_hooks(&hooks) == CROFTON_OK);
        {
            const WorldHandle world = make_world();
            for (const crofton_box& box : row_of_boxes(2000)) {
                const crofton_bound bound = box_bound(box);
                auto description = sized<crofton_object_description>();
                description.bound = &bound;
                crofton_object object{};
                REQUIRE(crofton_world_add(world.get(), &description, &object) == CROFTON_OK);
            }
            REQUIRE(crofton_world_update(world.get(), nullptr) == CROFTON_OK);
            const ViewResultHandle visible = make_view_result();
            const ViewResultHandle in_views = make_view_result();
            const Found found = make_found();
            const View view = default_view();
            const crofton_ray ray{{0, 0, 0}, {0, 0, -1}, 1e3};
            const double center[3] = {0, 0, -20};
            crofton_object_hit hit{};
            auto closest = sized<crofton_closest_object>();
            std::size_t before = 0;
            for (int i = 0; i < 5; ++i) {
                if (i == 1) before = counter.allocations;
                REQUIRE(look(world.get(), view, visible.get()) == CROFTON_OK);
                REQUIRE(look_at_many(world.get(), std::span(&view, 1), in_views.get()) == CROFTON_OK);
                REQUIRE(crofton_world_raycast(world.get(), &ray, 1, nullptr, &hit) == CROFTON_OK);
                REQUIRE(crofton_world_raycast_all(world.get(), &ray, nullptr, found.get()) == CROFTON_OK);
                REQUIRE(world_overlap_sphere(world.get(), center, 9, nullptr, found.get()) == CROFTON_OK);
                REQUIRE(world_closest_to_sphere(world.get(), center, 9, 1e3, nullptr, &closest) == CROFTON_OK);
            }
            CHECK(before > 0);
            CHECK(counter.allocations == before);
        }
        CHECK(counter.bytes_live == 0);
        REQUIRE(crofton_set_memory_hooks(nullptr) == CROFTON_OK);
    }

    TEST_CASE("the host's jobs give the same answer as the calling thread alone") {
        const auto boxes = row_of_boxes(20000);
        crofton::ThreadPool pool(3);
        const crofton_jobs jobs{sizeof jobs, &pool, pool.concurrency(), pool_for};
        CHECK(seen(boxes, &jobs) == seen(boxes, nullptr));
    }

    TEST_CASE("a concurrency that no machine has is refused before memory is allocated") {
        const auto boxes = row_of_boxes(2000);
        const Broadphase broadphase = make_broadphase();
        crofton::ThreadPool pool(2);
        const auto update = [&](uint32_t concurrency) {
            const crofton_jobs jobs{sizeof jobs, &pool, concurrency, pool_for};
            return crofton_broadphase_update(broadphase.get(), boxes.data(), nullptr, boxes.size(), &jobs);
        };
        CHECK(update(65536) == CROFTON_OK);
        CHECK(update(65537) == CROFTON_OUT_OF_RANGE);
        CHECK(update(~0u) == CROFTON_OUT_OF_RANGE);
    }

    TEST_CASE("messages of the library reach the host's log, and NULL gives it back") {
        REQUIRE(crofton_set_log_hook(
                    [](void* user, uint32_t level, const char* message) {
                        *static_cast<std::string*>(user) = message;
                        logged_level = level;
                    },
                    &logged) == CROFTON_OK);
        crofton::log(crofton::LogLevel::warning, "from C++");
        CHECK(logged == "from C++");
        CHECK(logged_level == CROFTON_LOG_WARNING);
        CHECK(crofton_log(CROFTON_LOG_ERROR, "from C") == CROFTON_OK);
        CHECK(logged == "from C");
        REQUIRE(crofton_set_log_hook(nullptr, nullptr) == CROFTON_OK);
        CHECK(crofton_log(CROFTON_LOG_DEBUG, "unheard") == CROFTON_OK);
        CHECK(logged == "from C");
    }

    TEST_CASE("a failed assertion reaches the host's hook") {
        REQUIRE(crofton_set_assert_hook(
                    [](const char*, const char* message, const char*, int) { asserted = message; }) == CROFTON_OK);
        crofton::detail::assert_failed("false", "a caller's mistake", "file", 1);
        CHECK(asserted == "a caller's mistake");
        REQUIRE(crofton_set_assert_hook(nullptr) == CROFTON_OK);
    }

    TEST_CASE("with thread checks a handle in use by another thread is busy") {
        REQUIRE(crofton_set_thread_checks(1) == CROFTON_OK);
        const Scene scene = make_scene();
        uint32_t node = 0, mesh = 0, instance = 0;
        const Tetrahedron tetrahedron;
        const crofton_mesh shape = tetrahedron.mesh();
        REQUIRE(crofton_scene_add_mesh(scene.get(), &shape, &mesh) == CROFTON_OK);
        for (int i = 0; i < 100; ++i) {
            REQUIRE(crofton_scene_add_node(scene.get(), CROFTON_NONE, nullptr, ~0u, &node) == CROFTON_OK);
            REQUIRE(crofton_scene_add_instance(scene.get(), node, mesh, &instance) == CROFTON_OK);
        }
        // The scene's own update runs the host's job: what that job does to the scene comes from the middle of a call.
        struct Attempt {
            crofton_scene* scene;
            crofton_status write = CROFTON_OK, read = CROFTON_OK;
        } attempt{scene.get()};
        const crofton_jobs jobs{sizeof jobs, &attempt, 1,
                                [](void* user, size_t count, size_t grain, crofton_range_task task, void* data) {
                                    std::thread([user] {
                                        auto& a = *static_cast<Attempt*>(user);
                                        uint32_t id = 0;
                                        a.write = crofton_scene_add_node(a.scene, CROFTON_NONE, nullptr, 1, &id);
                                        const uint32_t* moved = nullptr;
                                        size_t n = 0;
                                        a.read = crofton_scene_moved(a.scene, &moved, &n);
                                    }).join();
                                    for (size_t i = 0; i < count; i += grain)
                                        task(data, i, i + grain < count ? i + grain : count, 0);
                                }};
        CHECK(crofton_scene_update(scene.get(), &jobs, nullptr) == CROFTON_OK);
        CHECK(attempt.write == CROFTON_BUSY);
        CHECK(attempt.read == CROFTON_BUSY);
        CHECK(crofton_scene_update(scene.get(), nullptr, nullptr) == CROFTON_OK);
#if !defined(CROFTON_ASSERTS)
        REQUIRE(crofton_set_thread_checks(0) == CROFTON_OK);
#endif
    }

    TEST_CASE("with thread checks a World that is being updated is busy") {
        REQUIRE(crofton_set_thread_checks(1) == CROFTON_OK);
        const WorldHandle world = make_world();
        for (const crofton_box& box : row_of_boxes(500)) {
            const crofton_bound bound = box_bound(box);
            auto description = sized<crofton_object_description>();
            description.bound = &bound;
            crofton_object object{};
            REQUIRE(crofton_world_add(world.get(), &description, &object) == CROFTON_OK);
        }
        const ViewResultHandle visible = make_view_result();
        struct Attempt {
            crofton_world* world;
            crofton_view_result* visible;
            View view = default_view();
            crofton_status write = CROFTON_OK, read = CROFTON_OK;
        } attempt{world.get(), visible.get()};
        const crofton_jobs jobs{sizeof jobs, &attempt, 1,
                                [](void* user, size_t count, size_t grain, crofton_range_task task, void* data) {
                                    auto& a = *static_cast<Attempt*>(user);
                                    a.write = world_set_hidden(a.world, {0, 0}, 1);
                                    a.read = look(a.world, a.view, a.visible);
                                    for (size_t i = 0; i < count; i += grain)
                                        task(data, i, i + grain < count ? i + grain : count, 0);
                                }};
        CHECK(crofton_world_update(world.get(), &jobs) == CROFTON_OK);
        CHECK(attempt.write == CROFTON_BUSY);
        CHECK(attempt.read == CROFTON_BUSY);
        CHECK(crofton_world_update(world.get(), nullptr) == CROFTON_OK);
#if !defined(CROFTON_ASSERTS)
        REQUIRE(crofton_set_thread_checks(0) == CROFTON_OK);
#endif
    }
}
