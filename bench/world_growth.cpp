// SPDX-License-Identifier: MIT
// How a World of regions grows: memory, attaching, views, rays and updates against the number of objects.
#include <algorithm>
#include <cmath>
#include <crofton/crofton.hpp>
#include <random>
#include <vector>

#include "counted_memory.hpp"
#include "cull_crowd.hpp"
#include "world_frames.hpp"

namespace crofton::bench {
namespace {

constexpr std::size_t kObjects = 1000, kDistinct = 1000;
constexpr double kSide = 10.0;  // of a region

// Median of `count` calls of work(i), in microseconds.
template <class Work>
double median(int count, Work work) {
    std::vector<double> times;
    for (int i = 0; i < count; ++i) times.push_back(microseconds([&] { work(i); }));
    std::nth_element(times.begin(), times.begin() + count / 2, times.end());
    return times[static_cast<std::size_t>(count / 2)];
}

std::vector<Region> distinct_regions(std::size_t count) {
    const std::vector<Obb> boxes = crowd(kObjects * count);
    const double side = std::cbrt(static_cast<double>(boxes.size()));
    std::vector<Region> regions;
    for (std::size_t r = 0; r < count; ++r) {
        std::vector<RegionObject> objects;
        for (std::size_t i = 0; i < kObjects; ++i) {
            objects.push_back({.bound = boxes[r * kObjects + i]});
            objects.back().bound.box.center *= kSide / side;
        }
        regions.push_back(Region::prepare(objects).value());
    }
    return regions;
}

// Columns of a row, after the number of objects.
struct Costs {
    double bytes = 0.0, attach = 0.0, view = 0.0, ray = 0.0, update = 0.0, mover = 0.0;
    std::size_t seen = 0;
};

// Regions side by side in a square.
Costs costs(std::size_t count, int frames) {
    const CountedMemory memory;
    Costs result;
    World world;
    const std::vector<Region> regions = distinct_regions(std::min(count, kDistinct));
    const std::size_t of_regions = memory.in_use;
    const auto columns = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(count))));
    const auto origin_of = [&](std::size_t r) {
        return kSide * glm::dvec3(static_cast<double>(r % columns), 0.0, static_cast<double>(r / columns));
    };
    std::vector<RegionHandle> handles;
    for (std::size_t r = 0; r < count; ++r)
        handles.push_back(world.attach(regions[r % regions.size()], origin_of(r)).value());
    const glm::dvec3 middle = 0.5 * kSide * glm::dvec3(static_cast<double>(columns), 1.0, static_cast<double>(columns));
    const auto mover = world.add({.bound = Sphere{middle, 1.0}}).value();
    for (std::size_t i = 0; i < 40 + count / 25; ++i) require_ok(world.update().has_value(), "loading");
    result.bytes = static_cast<double>(of_regions) / static_cast<double>(kObjects * regions.size()) +
                   static_cast<double>(memory.in_use - of_regions) / static_cast<double>(kObjects * count);
    result.update = median(frames, [&](int) { require_ok(world.update().has_value(), "an update"); });
    result.mover = median(frames, [&](int frame) {
        const double x = 0.01 * (frame % 7);
        require_ok(world.set_bound(mover, Sphere{middle + glm::dvec3(x, 0.0, 0.0), 1.0}).has_value(), "moving");
        require_ok(world.update().has_value(), "an update");
    });
    Camera camera;
    camera.position = middle;
    camera.forward = {1.0, 0.0, 0.3};
    camera.far_distance = 50.0;
    ViewResult seen;
    result.view = median(frames, [&](int) { require_ok(world.view({.camera = camera}, seen).has_value(), "a view"); });
    result.seen = seen.size();
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> number(-1.0, 1.0);
    std::vector<Ray> rays(100);
    for (Ray& ray : rays) {
        ray.origin = middle + 3.0 * glm::dvec3(number(random), number(random), number(random));
        ray.direction = {number(random), 0.05 * number(random), number(random)};
    }
    result.ray = median(frames,
                        [&](int) {
                            for (const Ray& ray : rays) (void)world.raycast(ray);
                        }) /
                 static_cast<double>(rays.size());
    result.attach = median(frames, [&](int frame) {
        const std::size_t r = static_cast<std::size_t>(frame) % count;
        require_ok(world.detach(handles[r]).has_value(), "detaching");
        handles[r] = world.attach(regions[r % regions.size()], origin_of(r)).value();
        require_ok(world.update().has_value(), "an update");
    });
    return result;
}

}  // namespace

void growth(int frames) {
    std::printf(
        "# regions of 1,000 objects, a thousand of them distinct: a view 50 m far, a ray, an update in which nothing "
        "changes, one in which a ball moves among boxes of a region, one in which a region goes and comes; µs\n");
    std::printf("objects,bytes an object,objects seen,view,ray,update,update with a mover,update with a region\n");
    const auto row = [](const Costs& c) {
        std::printf("%.2f,%.2f,%.2f,%.2f,%.2f\n", c.view, c.ray, c.update, c.mover, c.attach);
        std::fflush(stdout);
    };
    Costs first, last;
    for (std::size_t regions = 1; regions <= 100'000; regions *= 10) {
        last = costs(regions, frames);
        if (regions == 100) first = last;
        std::printf("%zu,%.0f,%zu,", regions * kObjects, last.bytes, last.seen);
        row(last);
    }
    const auto exponent = [&](double Costs::*cost) {  // to two digits, without -0
        return std::round(100.0 * std::log10(last.*cost / (first.*cost)) / 3.0) / 100.0 + 0.0;
    };
    std::printf("exponent from 10^5 to 10^8,%.2f,,", exponent(&Costs::bytes));
    row({.attach = exponent(&Costs::attach),
         .view = exponent(&Costs::view),
         .ray = exponent(&Costs::ray),
         .update = exponent(&Costs::update),
         .mover = exponent(&Costs::mover)});
}

}  // namespace crofton::bench
