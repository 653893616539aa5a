// SPDX-License-Identifier: MIT
// What World costs beside the parts that it is made of, used by hand: the same frames in turns, the least time of each.
// By hand what moves is known beforehand, lies side by side, and nothing is checked, copied or found out.
//   bench_world           the table, and what ten million comings and goings leave behind
//   bench_world --quick   fewer frames, a hundred thousand
//   --target=AVX2         with this instruction set
#include <algorithm>
#include <chrono>
#include <crofton/collide/broadphase.hpp>
#include <crofton/collide/convex_query.hpp>
#include <crofton/collide/tree_query.hpp>
#include <crofton/crofton.hpp>
#include <crofton/cull/moving_boxes.hpp>
#include <crofton/scene/scene.hpp>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "cull_crowd.hpp"
#include "simd_target.hpp"

using namespace crofton;

namespace {

using Clock = std::chrono::steady_clock;

struct Times {
    double by_hand = std::numeric_limits<double>::infinity(), world = std::numeric_limits<double>::infinity();
};

template <class Work>
double microseconds(Work work) {
    const auto start = Clock::now();
    work();
    return std::chrono::duration<double, std::micro>(Clock::now() - start).count();
}

// In turns, so that both meet the same machine.
template <class ByHand, class InWorld>
Times compare(int frames, ByHand by_hand, InWorld in_world) {
    Times times;
    for (int frame = 0; frame < frames; ++frame) {
        times.by_hand = std::min(times.by_hand, microseconds([&] { by_hand(frame); }));
        times.world = std::min(times.world, microseconds([&] { in_world(frame); }));
    }
    return times;
}

void print(const char* what, const Times& times) {
    std::printf("%-58s %10.1f %10.1f %8.3f\n", what, times.by_hand, times.world, times.world / times.by_hand);
}

void must(bool good, const char* what) {
    if (good) return;
    std::fprintf(stderr, "bench_world: %s\n", what);
    std::exit(1);
}

// Boxes of which the first `moving` move in every frame. By hand they are known beforehand.
struct Crowd {
    Crowd(std::size_t count, std::size_t moving_count) : boxes(bench::crowd(count)), movers(moving_count) {
        for (boxtree::ItemId i = 0; i < moving_count; ++i) items.push_back(i);
    }
    // Where they are in a frame: every mover's own way there and back.
    void move(int frame) {
        for (std::size_t i = 0; i < movers; ++i)
            boxes[i].center[static_cast<int>(i % 3)] += frame % 2 == 0 ? 0.05 : -0.05;
    }
    [[nodiscard]] std::span<const Obb> moved() const { return std::span(boxes).first(movers); }

    std::vector<Obb> boxes;
    std::vector<boxtree::ItemId> items;
    std::size_t movers;
};

// Views of boxes of which some move; nothing collides.
Times views(std::size_t count, std::size_t moving_count, int frames, cull::ResultOrder order) {
    Crowd crowd(count, moving_count);
    const cull::View view = bench::view_of_share(crowd.boxes, 0.2);
    auto tree = boxtree::BoxTree::build(crowd.boxes, {.detached = crowd.items});
    must(tree.has_value(), "the tree");
    cull::MovingBoxes moving;
    cull::VisibleSet seen_by_hand;

    World world({.pairs = false, .rebuild_budget = 0});
    std::vector<ObjectHandle> objects;
    for (const Obb& box : crowd.boxes) objects.push_back(world.add({.bound = box}).value());
    const std::span<const ObjectHandle> movers = std::span(objects).first(moving_count);
    VisibleObjects seen;
    for (int frame = 0; frame < 3; ++frame) {
        crowd.move(frame);
        must(world.set_bounds(movers, crowd.moved()).has_value() && world.update().has_value(), "warming up");
    }
    crowd.move(3);
    must(world.statistics().moving == moving_count, "what moves was not found out");
    return compare(
        frames,
        [&](int frame) {
            crowd.move(frame);
            must(moving.update(*tree, crowd.items, crowd.moved()).has_value(), "by hand");
            cull::find_visible(*tree, moving, view, seen_by_hand, {.order = order});
        },
        [&](int) {
            must(world.set_bounds(movers, crowd.moved()).has_value() && world.update().has_value(), "in a world");
            world.view(view, seen, {.order = order});
            must(seen.size() == seen_by_hand.size(), "the views differ");
        });
}

// All pairs of boxes and their manifolds; all move.
Times contacts(std::size_t count, int frames) {
    Crowd crowd(count, count);
    for (Obb& box : crowd.boxes) box.half_extents *= 1.5f;
    collide::Broadphase broadphase;
    std::vector<collide::Manifold> manifolds;
    World world({.rebuild_budget = 0});
    std::vector<ObjectHandle> objects;
    for (const Obb& box : crowd.boxes) objects.push_back(world.add({.bound = box}).value());
    for (int frame = 0; frame < 4; ++frame) {
        crowd.move(frame);
        must(world.set_bounds(objects, crowd.boxes).has_value() && world.update().has_value(), "warming up");
    }
    return compare(
        frames,
        [&](int frame) {
            crowd.move(frame);
            must(broadphase.update(crowd.boxes).has_value(), "by hand");
            manifolds.clear();
            for (const auto& pair : broadphase.pairs())
                manifolds.push_back(collide::contact_manifold(crowd.boxes[pair.first], crowd.boxes[pair.second]));
        },
        [&](int) {
            must(world.set_bounds(objects, crowd.boxes).has_value() && world.update().has_value(), "in a world");
            must(world.pairs().size() == manifolds.size(), "the pairs differ");
        });
}

TriangleMesh cube() {
    TriangleMesh mesh;
    for (int i = 0; i < 8; ++i)
        mesh.positions.push_back({i & 1 ? 0.5f : -0.5f, i & 2 ? 0.5f : -0.5f, i & 4 ? 0.5f : -0.5f});
    mesh.indices = {0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                    2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6};
    return mesh;
}

// A scene of cubes on nodes, of which the first `movers` move.
struct CubeScene {
    CubeScene(std::span<const Obb> boxes, std::size_t mover_count) : movers(mover_count) {
        for (const Obb& box : boxes) places.push_back({glm::dmat3(box.axes), box.center});
        const auto id = scene.add_mesh(cube()).value();
        for (const scene::Transform& place : places) {
            nodes.push_back(scene.add_node(scene::kNone, place).value());
            must(scene.add_instance(nodes.back(), id).has_value(), "an instance");
        }
        for (std::size_t i = 0; i < movers; ++i) items.push_back(static_cast<boxtree::ItemId>(i));
        scene.update();
    }
    void move(int frame) {
        for (std::size_t i = 0; i < movers; ++i)
            places[i].translation[static_cast<int>(i % 3)] += frame % 2 == 0 ? 0.05 : -0.05;
    }
    [[nodiscard]] std::span<const scene::Transform> moved() const { return std::span(places).first(movers); }
    void update() {
        must(scene.set_local(std::span(nodes).first(movers), moved()).has_value(), "the scene");
        scene.update();
    }
    [[nodiscard]] std::span<const Obb> moved_boxes() const { return scene.world_boxes().first(movers); }

    std::size_t movers;
    std::vector<scene::Transform> places;
    std::vector<boxtree::ItemId> items;
    scene::Scene scene;
    std::vector<scene::NodeId> nodes;
};

// The tree of what rests and the list of what moves, by hand.
struct TreeAndList {
    explicit TreeAndList(const CubeScene& scene)
        : tree(boxtree::BoxTree::build(scene.scene.world_boxes(), {.detached = scene.items}).value()) {}
    void view(const CubeScene& scene, const cull::View& view) {
        must(moving.update(tree, scene.items, scene.moved_boxes()).has_value(), "by hand");
        cull::find_visible(tree, moving, view, seen, {.order = cull::ResultOrder::tree});
    }

    boxtree::BoxTree tree;
    cull::MovingBoxes moving;
    cull::VisibleSet seen;
};

// Meshes on nodes, some of which move; views.
Times meshes(std::size_t count, std::size_t moving_count, int frames) {
    const std::vector<Obb> boxes = bench::crowd(count);
    const cull::View view = bench::view_of_share(boxes, 0.2);
    CubeScene scene(boxes, moving_count);
    TreeAndList by_hand(scene);

    World world({.pairs = false, .rebuild_budget = 0});
    const TriangleMesh mesh = cube();
    const auto handle = world.add_mesh({.positions = mesh.positions, .indices = mesh.indices}).value();
    std::vector<NodeHandle> nodes;
    for (const scene::Transform& place : scene.places) {
        nodes.push_back(world.add_node({.transform = place}).value());
        must(world.add({.mesh = handle, .node = nodes.back()}).has_value(), "an object");
    }
    const std::span<const NodeHandle> movers = std::span(nodes).first(moving_count);
    VisibleObjects seen;
    for (int frame = 0; frame < 4; ++frame) {
        scene.move(frame);
        must(world.set_transforms(movers, scene.moved()).has_value() && world.update().has_value(), "warming up");
    }
    must(world.statistics().moving == moving_count, "what moves was not found out");
    return compare(
        frames,
        [&](int frame) {
            scene.move(frame);
            scene.update();
            by_hand.view(scene, view);
        },
        [&](int) {
            must(world.set_transforms(movers, scene.moved()).has_value() && world.update().has_value(), "in a world");
            world.view(view, seen, {.order = cull::ResultOrder::tree});
            must(seen.size() == by_hand.seen.size(), "the views differ");
        });
}

// An engine's whole frame with a scene graph of its own, which gives the boxes: nodes move, boxes follow, a view.
Times bounds_of_own_scene(std::size_t count, std::size_t moving_count, int frames) {
    const std::vector<Obb> boxes = bench::crowd(count);
    const cull::View view = bench::view_of_share(boxes, 0.2);
    CubeScene scene(boxes, moving_count);
    TreeAndList by_hand(scene);

    World world({.pairs = false, .rebuild_budget = 0});
    std::vector<ObjectHandle> objects;
    for (const Obb& box : scene.scene.world_boxes()) objects.push_back(world.add({.bound = box}).value());
    const std::span<const ObjectHandle> movers = std::span(objects).first(moving_count);
    VisibleObjects seen;
    const auto update = [&] {
        scene.update();
        must(world.set_bounds(movers, scene.moved_boxes()).has_value() && world.update().has_value(), "in a world");
    };
    for (int frame = 0; frame < 4; ++frame) {
        scene.move(frame);
        update();
    }
    must(world.statistics().moving == moving_count, "what moves was not found out");
    return compare(
        frames,
        [&](int frame) {
            scene.move(frame);
            scene.update();
            by_hand.view(scene, view);
        },
        [&](int frame) {
            scene.move(frame + 1);
            update();
            world.view(view, seen, {.order = cull::ResultOrder::tree});
        });
}

// A thousand rays at boxes that rest.
Times rays(std::size_t count, int frames) {
    Crowd crowd(count, 0);
    auto tree = boxtree::BoxTree::build(crowd.boxes);
    must(tree.has_value(), "the tree");
    World world({.pairs = false, .rebuild_budget = 0});
    for (const Obb& box : crowd.boxes) must(world.add({.bound = box}).has_value(), "an object");
    must(world.update().has_value(), "in a world");
    std::mt19937_64 random(7);
    std::normal_distribution<double> normal;
    const double side = std::cbrt(static_cast<double>(count));
    std::vector<Ray> asked(1000);
    for (Ray& ray : asked) {
        ray.origin = glm::dvec3(0.5 * side) + side * glm::dvec3(normal(random), normal(random), normal(random));
        ray.direction = glm::dvec3(0.5 * side) - ray.origin +
                        0.2 * side * glm::dvec3(normal(random), normal(random), normal(random));
    }
    std::size_t hits = 0, world_hits = 0;
    return compare(
        frames,
        [&](int) {
            hits = 0;
            for (const Ray& ray : asked) hits += collide::raycast(ray, *tree).has_value();
        },
        [&](int) {
            world_hits = 0;
            for (const Ray& ray : asked) world_hits += world.raycast(ray).has_value();
            must(hits == world_hits, "the rays differ");
        });
}

std::size_t bytes_in_use = 0;

void count_memory() {
    set_memory_hooks({[](void*, std::size_t bytes, std::size_t alignment) {
                          bytes_in_use += bytes;
                          return std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
                      },
                      [](void*, void* memory, std::size_t bytes, std::size_t) {
                          bytes_in_use -= bytes;
                          std::free(memory);
                      },
                      nullptr});
}

// Objects of which some are removed and others added in each update; as many live at any time.
struct Churn {
    explicit Churn(std::size_t live_count) : boxes(bench::crowd(live_count)), a_frame(live_count / 100) {
        for (const Obb& box : boxes) live.push_back(world.add({.bound = box}).value());
        must(world.update().has_value(), "loading");
    }
    void update() {
        for (std::size_t i = 0; i < a_frame; ++i) {
            ObjectHandle& object = live[random() % live.size()];
            const Obb box = boxes[random() % live.size()];
            must(world.remove(object).has_value(), "removing");
            object = world.add({.bound = box}).value();
        }
        must(world.update().has_value(), "an update");
    }

    std::vector<Obb> boxes;
    std::size_t a_frame;
    std::mt19937_64 random{3};
    World world{{.pairs = false}};
    std::vector<ObjectHandle> live;
};

// A view of a world against one that has just been loaded with the same objects.
Times against_fresh(const Churn& churn, const cull::View& view, std::size_t& fresh_bytes) {
    const std::size_t before = bytes_in_use;
    World fresh({.pairs = false});
    for (const ObjectHandle object : churn.live)
        must(fresh.add({.bound = churn.world.box_of(object).value()}).has_value(), "a copy");
    must(fresh.update().has_value(), "loading");
    fresh_bytes = bytes_in_use - before;
    VisibleObjects seen, seen_fresh;
    const Times times = compare(
        50, [&](int) { fresh.view(view, seen_fresh, {.order = cull::ResultOrder::tree}); },
        [&](int) { churn.world.view(view, seen, {.order = cull::ResultOrder::tree}); });
    must(seen.size() == seen_fresh.size(), "the views differ");
    return times;
}

// Spawns and despawns among as many that live; memory and views against a world that has just been loaded.
void churn(std::size_t live_count, std::size_t spawns) {
    Churn churn(live_count);
    const cull::View view = bench::view_of_share(churn.boxes, 0.2);
    const std::size_t loaded = bytes_in_use;
    std::size_t most = 0, sum = 0, updates = 0, fresh_bytes = 0;
    for (std::size_t done = 0; done < spawns; done += churn.a_frame, ++updates) {
        churn.update();
        most = std::max(most, bytes_in_use);
        sum += bytes_in_use;
    }
    // Rebuilds in the background come and go: the mean of many moments.
    constexpr int kMoments = 24;
    Times mean{0.0, 0.0};
    for (int moment = 0; moment < kMoments; ++moment) {
        churn.update();
        const Times times = against_fresh(churn, view, fresh_bytes);
        mean.by_hand += times.by_hand / kMoments;
        mean.world += times.world / kMoments;
    }
    for (int rest = 0; rest < 600; ++rest) must(churn.world.update().has_value(), "an update");
    const std::size_t at_rest = bytes_in_use;
    const Times times = against_fresh(churn, view, fresh_bytes);
    const double objects = static_cast<double>(live_count);
    std::printf("\n%zu comings and goings among %zu objects, %zu in an update\n", spawns, live_count, churn.a_frame);
    std::printf("  bytes an object: loaded %.0f, on the way %.0f, at most %.0f, at rest afterwards %.0f, fresh %.0f\n",
                double(loaded) / objects, double(sum) / double(updates) / objects, double(most) / objects,
                double(at_rest) / objects, double(fresh_bytes) / objects);
    std::printf(
        "  a view, microseconds: on the way %.1f, fresh %.1f, ratio %.3f; 600 updates later %.1f, fresh %.1f, "
        "ratio %.3f\n",
        mean.world, mean.by_hand, mean.world / mean.by_hand, times.world, times.by_hand, times.world / times.by_hand);
}

}  // namespace

int main(int argc, char** argv) {
    if (!bench::take_target_option(argc, argv)) return 1;
    const bool quick = argc > 1 && std::strcmp(argv[1], "--quick") == 0;
    const int frames = quick ? 30 : 200;
    std::printf("instruction set: %s\n%-58s %10s %10s %8s\n", bench::target_in_use(), "microseconds a frame", "by hand",
                "World", "ratio");
    print("100,000 boxes rest, a view, ids ascending", views(100000, 0, frames, cull::ResultOrder::ascending));
    print("100,000 boxes rest, a view, tree order", views(100000, 0, frames, cull::ResultOrder::tree));
    print("100,000 boxes, 5,000 move, a view, tree order", views(100000, 5000, frames, cull::ResultOrder::tree));
    print("100,000 meshes, 5,000 nodes move, a view, tree order", meshes(100000, 5000, frames));
    print("the same; bounds, nodes in the engine's own scene", bounds_of_own_scene(100000, 5000, frames));
    print("10,000 boxes all move, pairs and manifolds", contacts(10000, frames));
    print("100,000 boxes rest, 1,000 rays, nearest box", rays(100000, frames));
    count_memory();
    churn(20000, quick ? 100000 : 10000000);
    reset_memory_hooks();
}
