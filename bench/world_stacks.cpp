// SPDX-License-Identifier: MIT
// Times updates of stacked crates, as shapes and as boxes: at rest, one that moves, and all.
#include <algorithm>
#include <crofton/convex/query.hpp>
#include <crofton/crofton.hpp>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <vector>

#include "world_frames.hpp"

namespace crofton::bench {
namespace {

void expect(bool good, const char* what) {
    if (good) return;
    std::fprintf(stderr, "bench_world: %s failed\n", what);
    std::exit(1);
}

enum class Motion { none, set_alike, one, all, all_jiggle };

struct MotionRow {
    const char* name;
    Motion motion;
};
constexpr MotionRow kMotions[] = {{"nothing is set", Motion::none},
                                  {"all are set where they are", Motion::set_alike},
                                  {"one moves", Motion::one},
                                  {"all move alike, touching", Motion::all},
                                  {"each moves 0.1 mm or less", Motion::all_jiggle}};

// A thousand cubes of side 1 on a slab: ten by ten towers of ten, which touch their neighbours where `apart` is 1.
class Crates {
  public:
    Crates(double apart, bool shapes) {
        Obb slab;
        slab.center = {0.0, -0.5, 0.0};
        slab.half_extents = {50.0f, 0.5f, 50.0f};
        add(slab, shapes ? &slab_ : nullptr);
        for (int i = 0; i < 1000; ++i) {
            Obb box;
            box.half_extents = glm::vec3(0.5f);
            box.center = {apart * (i / 100) - 5.0, 0.5 + i % 10, apart * (i / 10 % 10) - 5.0};
            add(box, shapes ? &crate_ : nullptr);
        }
        for (int update = 0; update < 5; ++update) expect(world_.update().has_value(), "loading");
    }
    double frame(Motion motion, int number) {
        std::uniform_real_distribution<double> off(-1e-4, 1e-4);
        const double step = number % 2 != 0 ? 1e-3 : 0.0;
        for (std::size_t i = 1; i < objects_.size(); ++i) {
            if (motion == Motion::none || (motion == Motion::one && i != 556)) continue;
            Obb box = boxes_[i];
            if (motion == Motion::one) box.center.y += step;
            if (motion == Motion::all) box.center.x += step;
            if (motion == Motion::all_jiggle)
                for (int k = 0; k < 3; ++k) box.center[k] += off(random_);
            expect(world_.set_bound(objects_[i], box).has_value(), "a move");
        }
        return microseconds([&] { expect(world_.update().has_value(), "an update"); });
    }
    [[nodiscard]] std::size_t pairs() const { return world_.pairs().size(); }

  private:
    void add(const Obb& box, const convex::Shape* shape) {
        boxes_.push_back(box);
        objects_.push_back(world_.add({.bound = box}).value());
        if (shape != nullptr) expect(world_.set_shape(objects_.back(), shape).has_value(), "a shape");
    }

    convex::Shape crate_ = convex::Shape::box(glm::vec3(0.5f)).value(),
                  slab_ = convex::Shape::box({50.0f, 0.5f, 50.0f}).value();
    World world_;
    std::vector<ObjectHandle> objects_;
    std::vector<Obb> boxes_;
    std::mt19937_64 random_{1};
};

}  // namespace

void stacks(int frames) {
    std::printf("%-28s %-28s %8s %10s %10s %10s\n", "1,000 crates", "µs of an update", "pairs", "least", "median",
                "worst");
    for (const bool touch : {false, true})
        for (const bool shapes : {false, true})
            for (const MotionRow& row : kMotions) {
                Crates crates(touch ? 1.0 : 1.5, shapes);
                std::vector<double> times;
                for (int number = 0; number < frames; ++number) times.push_back(crates.frame(row.motion, number));
                std::sort(times.begin(), times.end());
                const char* const name = touch ? (shapes ? "a wall, shapes" : "a wall, boxes")
                                               : (shapes ? "towers, shapes" : "towers, boxes");
                std::printf("%-28s %-28s %8zu %10.2f %10.2f %10.2f\n", name, row.name, crates.pairs(), times.front(),
                            times[times.size() / 2], times.back());
                std::fflush(stdout);
            }
}

}  // namespace crofton::bench
