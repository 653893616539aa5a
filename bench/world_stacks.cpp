// SPDX-License-Identifier: MIT
// Times updates of stacked crates, as shapes and as boxes: at rest, one that moves, and all. Then of hulls that are
// deep in each other.
#include <algorithm>
#include <cmath>
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

// 300 hulls of 16 points, at random in a cube: about 6,000 pairs of boxes, most of them deep in each other.
class DenseHulls {
  public:
    DenseHulls() {
        for (int i = 0; i < kCount; ++i) {
            std::vector<glm::vec3> points;
            while (points.size() < 16) {
                const double x = number(1.0), y = number(1.0), z = number(1.0),
                             length = std::sqrt(x * x + y * y + z * z);
                if (length > 0.1 && length < 1.0) points.emplace_back(x / length, y / length, z / length);
            }
            hulls_.push_back(convex::Hull::build(points).value());
        }
        for (const convex::Hull& hull : hulls_) shapes_.push_back(convex::Shape::hull(hull));
        for (const convex::Shape& shape : shapes_) {
            Obb box;
            box.half_extents = glm::vec3(1.0f);
            for (int k = 0; k < 3; ++k) box.center[k] = number(3.3);
            boxes_.push_back(box);
            objects_.push_back(world_.add({.bound = box}).value());
            expect(world_.set_shape(objects_.back(), &shape).has_value(), "a shape");
        }
        expect(world_.update().has_value(), "loading");
    }
    double frame() {
        for (std::size_t i = 0; i < objects_.size(); ++i) {
            Obb box = boxes_[i];
            for (int k = 0; k < 3; ++k) box.center[k] += number(1e-3);
            expect(world_.set_bound(objects_[i], box).has_value(), "a move");
        }
        return microseconds([&] { expect(world_.update().has_value(), "an update"); });
    }
    [[nodiscard]] std::size_t pairs() const { return world_.pairs().size(); }

  private:
    static constexpr int kCount = 300;
    double number(double most) { return most * (static_cast<double>(random_() >> 11) * 0x1p-52 - 1.0); }

    std::mt19937_64 random_{5};
    std::vector<convex::Hull> hulls_;
    std::vector<convex::Shape> shapes_;
    World world_;
    std::vector<ObjectHandle> objects_;
    std::vector<Obb> boxes_;
};

void print_row(const char* name, const char* motion, std::size_t pairs, std::vector<double>& times) {
    std::sort(times.begin(), times.end());
    std::printf("%-28s %-28s %8zu %10.2f %10.2f %10.2f\n", name, motion, pairs, times.front(), times[times.size() / 2],
                times.back());
    std::fflush(stdout);
}

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
                print_row(touch ? (shapes ? "a wall, shapes" : "a wall, boxes")
                                : (shapes ? "towers, shapes" : "towers, boxes"),
                          row.name, crates.pairs(), times);
            }
    DenseHulls dense;
    std::vector<double> times;
    for (int number = 0; number < frames; ++number) times.push_back(dense.frame());
    print_row("300 hulls in each other", "each moves 1 mm or less", dense.pairs(), times);
}

}  // namespace crofton::bench
