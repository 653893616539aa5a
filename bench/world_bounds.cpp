// SPDX-License-Identifier: MIT
// Frames of bench_world in which bounds move. By hand what moves is known beforehand.
#include <cmath>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/collide/bound_contacts.hpp>
#include <crofton/collide/broadphase.hpp>
#include <crofton/collide/narrow_phase.hpp>
#include <crofton/crofton.hpp>
#include <crofton/cull/bound_set.hpp>
#include <cstring>
#include <random>
#include <vector>

#include "cull_crowd.hpp"
#include "world_frames.hpp"

namespace crofton::bench {
namespace {

// Boxes of which the first `movers` move in every frame. Either side has its own, in memory of its own.
struct Crowd {
    Crowd(const std::vector<Obb>& all, std::size_t moving_count) : boxes(all), movers(moving_count) {}
    // Every mover's own way there and back.
    void move(int frame) {
        for (std::size_t i = 0; i < movers; ++i)
            boxes[i].center[static_cast<int>(i % 3)] += frame % 2 == 0 ? 0.05 : -0.05;
    }
    [[nodiscard]] Strided<Obb> moved() const { return {boxes.data(), movers}; }

    std::vector<Obb> boxes;
    std::size_t movers;
};

// Likewise, where each box lies in a struct of the game's.
struct Game {
    struct Enemy {
        Obb box;
        glm::dvec3 velocity{0.0};
        std::uint32_t health = 100, weapon = 0;
    };
    Game(const std::vector<Obb>& all, std::size_t moving_count) : enemies(moving_count) {
        for (std::size_t i = 0; i < moving_count; ++i) {
            enemies[i].box = all[i];
            enemies[i].velocity[static_cast<int>(i % 3)] = 0.05;
        }
    }
    void move(int frame) {
        for (Enemy& enemy : enemies) enemy.box.center += frame % 2 == 0 ? enemy.velocity : -enemy.velocity;
    }
    [[nodiscard]] Strided<Obb> moved() const { return {&enemies[0].box, enemies.size(), sizeof(Enemy)}; }

    std::vector<Enemy> enemies;
};

// What the hand-written side does with the boxes that come.
enum class Keeping {
    none,          // the list reads them where they are
    with_changes,  // as World: copied, so that the caller's memory is free, and those that differ are listed
};

// The parts by hand: the tree of what rests and the list of what moves. The list takes boxes side by side: others are
// copied there.
template <Keeping keeping>
class Parts {
  public:
    Parts(const std::vector<Obb>& all, std::size_t moving_count) {
        for (boxtree::ItemId i = 0; i < moving_count; ++i) items_.push_back(i);
        auto built = boxtree::BoxTree::build(all, {.detached = items_});
        require_ok(built.has_value(), "the tree");
        tree_ = std::move(*built);
    }
    void update(const Crowd& crowd) { update(std::span(crowd.boxes).first(crowd.movers)); }
    void update(const Game& game) {
        copies_.resize(game.enemies.size());
        for (std::size_t i = 0; i < copies_.size(); ++i) copies_[i] = game.enemies[i].box;
        update(copies_);
    }
    void view(const cull::View& view, cull::ResultOrder order) {
        cull::find_visible(tree_, moving_, view, seen_, {.order = order});
    }
    [[nodiscard]] std::size_t seen() const { return seen_.size(); }

  private:
    void update(std::span<const Obb> moved) {
        if (keeping == Keeping::with_changes) moved = keep(moved);
        require_ok(moving_.update(tree_, items_, moved).has_value(), "by hand");
    }
    // Two sets of copies in turn: the last update's are compared with, and are what the list reads until it has new
    // ones.
    std::span<const Obb> keep(std::span<const Obb> moved) {
        kept_.resize(moved.size());
        next_.resize(moved.size());
        changed_.clear();
        for (std::size_t i = 0; i < moved.size(); ++i) {
            next_[i] = moved[i];
            if (std::memcmp(&kept_[i], &moved[i], sizeof(Obb)) != 0) changed_.push_back(items_[i]);
        }
        std::swap(kept_, next_);
        return kept_;
    }

    std::vector<boxtree::ItemId> items_, changed_;
    std::vector<Obb> copies_, kept_, next_;
    boxtree::BoxTree tree_ = boxtree::BoxTree::build({}).value();
    cull::MovingBoxes moving_;
    cull::VisibleSet seen_;
};

// A World of boxes.
struct Objects {
    Objects(const std::vector<Obb>& boxes, const WorldOptions& options) : world(options) {
        for (const Obb& box : boxes) all.push_back(world.add({.bound = box}).value());
        require_ok(world.update().has_value(), "loading");
    }
    void update(Strided<Obb> moved) {
        const std::span movers = std::span(all).first(moved.size());
        require_ok(world.set_bounds(movers, moved).has_value() && world.update().has_value(), "in a world");
    }
    // Moves on until the World has found out what moves. An even number of frames.
    template <class Boxes>
    void warm_up(Boxes& boxes) {
        for (int frame = 0; frame < 4; ++frame) {
            boxes.move(frame);
            update(boxes.moved());
        }
        require_ok(world.statistics().moving == boxes.moved().size(), "what moves was not found out");
    }

    World world;
    std::vector<ObjectHandle> all;
    ViewResult seen;
};

// From the middle, as far as some 230 boxes.
cull::View near_view(const std::vector<Obb>& boxes) {
    Camera camera;
    camera.position = glm::dvec3(0.5 * std::cbrt(static_cast<double>(boxes.size())));
    camera.forward = {0.05, -0.04, -1.0};
    camera.aspect = 1.0;
    camera.fov_y = 1.2;
    camera.near_distance = 0.1;
    camera.far_distance = 6.0;
    return {*frustum_of(camera)};
}

constexpr WorldOptions kViewsOnly{.pairs = false, .rebuild_budget = 0};

// Views of boxes of which some move; nothing collides.
template <class Boxes, Keeping keeping = Keeping::none>
FrameTimes views(std::size_t count, std::size_t moving_count, int frames, cull::ResultOrder order, bool near = false) {
    const std::vector<Obb> all = crowd(count);
    const cull::View view = near ? near_view(all) : view_of_share(all, 0.2);
    Boxes ours(all, moving_count), worlds(all, moving_count);
    Parts<keeping> parts(all, moving_count);
    Objects objects(all, kViewsOnly);
    objects.warm_up(worlds);
    return compare(
        frames,
        [&](int frame) {
            ours.move(frame);
            parts.update(ours);
            parts.view(view, order);
        },
        [&](int frame) {
            worlds.move(frame);
            objects.update(worlds.moved());
            (void)objects.world.view({.volume = view.frustum, .layers = view.layer_mask, .order = order}, objects.seen);
            require_ok(objects.seen.size() == parts.seen(), "the views differ");
        });
}

}  // namespace

FrameTimes views_ascending(std::size_t count, std::size_t moving, int frames) {
    return views<Crowd>(count, moving, frames, cull::ResultOrder::ascending);
}
FrameTimes views_in_tree_order(std::size_t count, std::size_t moving, int frames) {
    return views<Crowd>(count, moving, frames, cull::ResultOrder::tree);
}
// Some 230 boxes are seen.
FrameTimes near_views_ascending(std::size_t count, std::size_t moving, int frames) {
    return views<Crowd>(count, moving, frames, cull::ResultOrder::ascending, true);
}
FrameTimes near_views_in_tree_order(std::size_t count, std::size_t moving, int frames) {
    return views<Crowd>(count, moving, frames, cull::ResultOrder::tree, true);
}
FrameTimes views_of_kept(std::size_t count, std::size_t moving, int frames) {
    return views<Crowd, Keeping::with_changes>(count, moving, frames, cull::ResultOrder::tree);
}
FrameTimes views_of_structs(std::size_t count, std::size_t moving, int frames) {
    return views<Game>(count, moving, frames, cull::ResultOrder::tree);
}

// All pairs of boxes and their manifolds; all move.
FrameTimes contacts(std::size_t count, std::size_t moving, int frames) {
    std::vector<Obb> all = crowd(count);
    for (Obb& box : all) box.half_extents *= 1.5f;
    Crowd ours(all, moving), worlds(all, moving);
    collide::Broadphase broadphase;
    std::vector<collide::Manifold> manifolds;
    Objects objects(all, {.rebuild_budget = 0});
    objects.warm_up(worlds);
    return compare(
        frames,
        [&](int frame) {
            ours.move(frame);
            require_ok(broadphase.update(ours.boxes).has_value(), "by hand");
            manifolds.clear();
            for (const auto& pair : broadphase.pairs())
                manifolds.push_back(collide::contact_manifold(ours.boxes[pair.first], ours.boxes[pair.second]));
        },
        [&](int frame) {
            worlds.move(frame);
            objects.update(worlds.moved());
            require_ok(objects.world.pairs().size() == manifolds.size(), "the pairs differ");
        });
}

// A thousand rays at boxes that rest.
FrameTimes rays(std::size_t count, std::size_t, int frames) {
    const std::vector<Obb> all = crowd(count);
    const auto tree = boxtree::BoxTree::build(all);
    require_ok(tree.has_value(), "the tree");
    const Objects objects(all, kViewsOnly);
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
            for (const Ray& ray : asked) world_hits += objects.world.raycast(ray).has_value();
            require_ok(hits == world_hits, "the rays differ");
        });
}

}  // namespace crofton::bench
