// SPDX-License-Identifier: MIT
// Frames of bench_world in which nodes move, with a cube on each.
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/crofton.hpp>
#include <crofton/cull/bound_set.hpp>
#include <crofton/scene/scene.hpp>
#include <vector>

#include "cull_crowd.hpp"
#include "world_frames.hpp"

namespace crofton::bench {
namespace {

TriangleMesh cube() {
    TriangleMesh mesh;
    for (int i = 0; i < 8; ++i)
        mesh.positions.push_back({i & 1 ? 0.5f : -0.5f, i & 2 ? 0.5f : -0.5f, i & 4 ? 0.5f : -0.5f});
    mesh.indices = {0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                    2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6};
    return mesh;
}

// Where the game has its cubes, of which the first `movers` move. Either side has its own.
struct Places {
    Places(const std::vector<Obb>& boxes, std::size_t moving_count) : movers(moving_count) {
        for (const Obb& box : boxes) all.push_back({glm::dmat3(box.axes), box.center});
    }
    void move(int frame) {
        for (std::size_t i = 0; i < movers; ++i)
            all[i].translation[static_cast<int>(i % 3)] += frame % 2 == 0 ? 0.05 : -0.05;
    }
    [[nodiscard]] std::span<const Transform> moved() const { return std::span(all).first(movers); }

    std::vector<Transform> all;
    std::size_t movers;
};

// The engine's scene graph: a Scene of cubes.
struct Graph {
    explicit Graph(const Places& places) {
        const auto id = scene.add_mesh(cube()).value();
        for (const Transform& place : places.all) {
            nodes.push_back(scene.add_node(scene::kNone, place).value());
            require_ok(scene.add_instance(nodes.back(), id).has_value(), "an instance");
        }
        scene.update();
    }
    void update(const Places& places) {
        require_ok(scene.set_local(std::span(nodes).first(places.movers), places.moved()).has_value(), "the scene");
        scene.update();
    }

    scene::Scene scene;
    std::vector<scene::NodeId> nodes;
};

// The parts by hand: a scene, the tree of what rests, the list of what moves, over the scene's own boxes.
class Parts {
  public:
    explicit Parts(const Places& places) : graph_(places) {
        for (std::size_t i = 0; i < places.movers; ++i) items_.push_back(static_cast<boxtree::ItemId>(i));
        auto built = boxtree::BoxTree::build(graph_.scene.world_boxes(), {.detached = items_});
        require_ok(built.has_value(), "the tree");
        tree_ = std::move(*built);
    }
    void update(const Places& places) {
        graph_.update(places);
        require_ok(moving_.update(tree_, items_, graph_.scene.world_boxes().first(places.movers)).has_value(),
                   "by hand");
    }
    void view(const cull::View& view) {
        cull::find_visible(tree_, moving_, view, seen_, {.order = cull::ResultOrder::tree});
    }
    [[nodiscard]] std::size_t seen() const { return seen_.size(); }

  private:
    Graph graph_;
    std::vector<boxtree::ItemId> items_;
    boxtree::BoxTree tree_ = boxtree::BoxTree::build({}).value();
    cull::MovingBoxes moving_;
    cull::VisibleSet seen_;
};

constexpr WorldOptions kViewsOnly{.pairs = false, .rebuild_budget = 0};

// A World of meshes on its own nodes.
struct Meshes {
    explicit Meshes(const Places& places) : world(kViewsOnly) {
        const TriangleMesh mesh = cube();
        const auto handle = world.add_mesh({.positions = mesh.positions, .indices = mesh.indices}).value();
        for (const Transform& place : places.all) {
            nodes.push_back(world.add_node({.transform = place}).value());
            require_ok(world.add({.mesh = handle, .node = nodes.back()}).has_value(), "an object");
        }
        require_ok(world.update().has_value(), "loading");
    }
    void update(const Places& places) {
        require_ok(world.set_transforms(std::span(nodes).first(places.movers), places.moved()).has_value() &&
                       world.update().has_value(),
                   "in a world");
    }

    World world;
    std::vector<NodeHandle> nodes;
};

// A World of bounds, which the engine's scene graph gives.
struct Bounds {
    explicit Bounds(const Places& places) : graph(places), world(kViewsOnly) {
        for (const Obb& box : graph.scene.world_boxes()) objects.push_back(world.add({.bound = box}).value());
        require_ok(world.update().has_value(), "loading");
    }
    void update(const Places& places) {
        graph.update(places);
        require_ok(
            world.set_bounds(std::span(objects).first(places.movers), graph.scene.world_boxes().first(places.movers))
                    .has_value() &&
                world.update().has_value(),
            "in a world");
    }

    Graph graph;
    World world;
    std::vector<ObjectHandle> objects;
};

template <class Objects>
FrameTimes views(std::size_t count, std::size_t moving_count, int frames) {
    const std::vector<Obb> boxes = crowd(count);
    const cull::View view = view_of_share(boxes, 0.2);
    Places ours(boxes, moving_count), worlds(boxes, moving_count);
    Parts parts(ours);
    Objects objects(worlds);
    for (int frame = 0; frame < 4; ++frame) {
        worlds.move(frame);
        objects.update(worlds);
    }
    require_ok(objects.world.statistics().moving == moving_count, "what moves was not found out");
    ViewResult seen;
    return compare(
        frames,
        [&](int frame) {
            ours.move(frame);
            parts.update(ours);
            parts.view(view);
        },
        [&](int frame) {
            worlds.move(frame);
            objects.update(worlds);
            (void)objects.world.view({.volume = view.frustum, .order = cull::ResultOrder::tree}, seen);
            require_ok(seen.size() == parts.seen(), "the views differ");
        });
}

}  // namespace

FrameTimes views_of_meshes(std::size_t count, std::size_t moving, int frames) {
    return views<Meshes>(count, moving, frames);
}
FrameTimes views_of_own_scene(std::size_t count, std::size_t moving, int frames) {
    return views<Bounds>(count, moving, frames);
}

}  // namespace crofton::bench
