// SPDX-License-Identifier: MIT
// Bytes an object of a World: loaded and at rest, while all move, and after some have come and gone.
#include <cmath>
#include <crofton/crofton.hpp>
#include <random>
#include <vector>

#include "counted_memory.hpp"
#include "world_frames.hpp"

namespace crofton::bench {
namespace {

// Cubes of side 2, one in a cube of side 20: few touch.
class Cubes {
  public:
    Cubes(std::size_t count, const WorldOptions& options) : world(options), side_(20.0 * std::cbrt(double(count))) {
        for (std::size_t i = 0; i < count; ++i) {
            boxes_.push_back(any_box());
            objects_.push_back(world.add({.bound = boxes_.back()}).value());
        }
        update(4);
    }
    void move_all(int updates) {
        for (int n = 0; n < updates; ++n) {
            for (Obb& box : boxes_) box.center.x += n % 2 == 0 ? 0.25 : -0.25;
            require_ok(world.set_bounds(objects_, boxes_).has_value(), "moving");
            update(1);
        }
    }
    void replace_some(std::size_t part, int updates) {
        for (int n = 0; n < updates; ++n) {
            for (std::size_t i = 0; i < std::max<std::size_t>(objects_.size() / part, 1); ++i) {
                ObjectHandle& object = objects_[random_() % objects_.size()];
                require_ok(world.remove(object).has_value(), "removing");
                object = world.add({.bound = any_box()}).value();
            }
            update(1);
        }
    }
    void update(int updates) {
        for (int n = 0; n < updates; ++n) require_ok(world.update().has_value(), "an update");
    }

    World world;

  private:
    Obb any_box() {
        return {side_ * glm::dvec3(number_(random_), number_(random_), number_(random_)), glm::mat3(1.0f),
                glm::vec3(1.0f)};
    }

    double side_;
    std::vector<Obb> boxes_;
    std::vector<ObjectHandle> objects_;
    std::mt19937_64 random_{1};
    std::uniform_real_distribution<double> number_{0.0, 1.0};
};

template <class Work>
double bytes_after(std::size_t count, const WorldOptions& options, Work work) {
    const CountedMemory memory;
    Cubes cubes(count, options);
    work(cubes);
    return static_cast<double>(memory.in_use) / static_cast<double>(count);
}

}  // namespace

void bytes() {
    std::printf(
        "# bytes an object: cubes that rest; that all move; of which a hundredth is replaced in each of 100 updates\n");
    std::printf("objects,finds,at rest,all move,churning\n");
    for (const std::size_t count : {std::size_t{1000}, std::size_t{10000}, std::size_t{100000}, std::size_t{1000000}})
        for (const bool pairs : {false, true}) {
            const WorldOptions options{.pairs = pairs};
            std::printf("%zu,%s,%.0f,%.0f,%.0f\n", count, pairs ? "pairs and contacts" : "neither",
                        bytes_after(count, options, [](Cubes& cubes) { cubes.update(30); }),
                        bytes_after(count, options, [](Cubes& cubes) { cubes.move_all(6); }),
                        bytes_after(count, options, [](Cubes& cubes) { cubes.replace_some(100, 100); }));
            std::fflush(stdout);
        }
}

}  // namespace crofton::bench
