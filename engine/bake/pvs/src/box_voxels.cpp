// SPDX-License-Identifier: MIT
#include "box_voxels.hpp"

#include <algorithm>
#include <cmath>

namespace crofton::pvs {
namespace {

// Relative to the extent: far above the rounding of a walk's steps.
constexpr double kRoom = 1e-9;
// The average number of lists that a box is in, at most. With at most 2^24 boxes, 32 bits count them all.
constexpr std::uint64_t kMostPlaces = 64;

inline std::uint32_t voxel_of(double x, const Aabb& bounds, int k, std::uint32_t count) {
    const double extent = bounds.max[k] - bounds.min[k];
    if (!(extent > 0.0)) return 0;
    const double at = (x - bounds.min[k]) / extent * count;
    return at <= 0.0 ? 0 : (std::min)(static_cast<std::uint32_t>((std::min)(at, 4e9)), count - 1);
}

}  // namespace

BoxVoxels::BoxVoxels(std::span<const Aabb> boxes, const Aabb& all) : bounds(all) {
    struct Block {
        std::uint32_t low[3], high[3];
    };
    const auto voxels_of = [&](const Aabb& box) {
        Block block;
        for (int k = 0; k < 3; ++k) {
            const double room = kRoom * (bounds.max[k] - bounds.min[k]);
            block.low[k] = voxel_of(box.min[k] - room, bounds, k, counts[k]);
            block.high[k] = voxel_of(box.max[k] + room, bounds, k, counts[k]);
        }
        return block;
    };
    const auto length_of_lists = [&] {
        std::uint64_t sum = 0;
        for (const Aabb& box : boxes) {
            const auto [low, high] = voxels_of(box);
            std::uint64_t count = 1;
            for (int k = 0; k < 3; ++k) count *= high[k] - low[k] + 1;
            sum += count;
        }
        return sum;
    };
    // About a voxel for each box; fewer where many boxes overlap.
    const double side = std::sqrt(static_cast<double>(boxes.size()));
    for (int k = 0; k < 3; ++k)
        counts[k] = static_cast<std::uint32_t>(std::clamp(k == 1 ? side / 4.0 : side, 1.0, 64.0));
    while (counts[0] > 1 && length_of_lists() > kMostPlaces * boxes.size())
        for (std::uint32_t& count : counts) count = (std::max)(1u, count / 2);
    const auto each_voxel = [&](const Aabb& box, auto&& visit) {
        const auto [low, high] = voxels_of(box);
        for (std::uint32_t z = low[2]; z <= high[2]; ++z)
            for (std::uint32_t y = low[1]; y <= high[1]; ++y)
                for (std::uint32_t x = low[0]; x <= high[0]; ++x) visit(x + counts[0] * (y + counts[1] * z));
    };
    first.assign(std::size_t{counts[0]} * counts[1] * counts[2] + 1, 0);
    for (const Aabb& box : boxes) each_voxel(box, [&](std::uint32_t v) { ++first[v + 1]; });
    for (std::size_t v = 1; v < first.size(); ++v) first[v] += first[v - 1];
    listed.resize(first.back());
    Vector<std::uint32_t> next(first.begin(), first.end() - 1);
    for (std::uint32_t i = 0; i < boxes.size(); ++i)
        each_voxel(boxes[i], [&](std::uint32_t v) { listed[next[v]++] = i; });
}

std::span<const std::uint32_t> BoxVoxels::boxes_near(const glm::dvec3& point) const {
    std::size_t at[3];
    for (int k = 0; k < 3; ++k) at[k] = voxel_of(point[k], bounds, k, counts[k]);
    return boxes_in(at[0] + counts[0] * (at[1] + counts[1] * at[2]));
}

}  // namespace crofton::pvs
