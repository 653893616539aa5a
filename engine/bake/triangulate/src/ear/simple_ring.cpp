// SPDX-License-Identifier: MIT
#include "ear/simple_ring.hpp"

#include <algorithm>
#include <crofton/geometry/predicates.hpp>
#include <limits>

namespace crofton::triangulate {
namespace {

bool comes_before(const glm::dvec2& a, const glm::dvec2& b) {
    return a.x != b.x ? a.x < b.x : a.y < b.y;
}

// Edges whose boxes meet: each has a point that the other's line does not separate from its own. On one line they
// overlap, as their boxes do.
bool edges_meet(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c, const glm::dvec2& d) {
    if (orientation(a, b, c) * orientation(a, b, d) > 0) return false;
    return orientation(c, d, a) * orientation(c, d, b) <= 0;
}

}  // namespace

void SimpleRing::build(std::span<const glm::dvec2> points) {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    const std::size_t count = (points.size() + kWidth - 1) / kWidth;
    blocks_.resize(count);
    bounds_.resize(count);
    for (std::size_t b = 0; b < count; ++b) {
        Block& block = blocks_[b];
        Box& all = bounds_[b] = {kInfinity, -kInfinity, kInfinity, -kInfinity};
        for (std::size_t k = 0; k < kWidth; ++k) {
            const std::size_t i = b * kWidth + k;
            Box box = {kInfinity, -kInfinity, kInfinity, -kInfinity};
            if (i < points.size()) {
                const glm::dvec2 &p = points[i], &q = points[i + 1 == points.size() ? 0 : i + 1];
                const auto px = static_cast<float>(p.x), py = static_cast<float>(p.y);
                const auto qx = static_cast<float>(q.x), qy = static_cast<float>(q.y);
                box = {(std::min)(px, qx), (std::max)(px, qx), (std::min)(py, qy), (std::max)(py, qy)};
            }
            block.low_x[k] = box.low_x, block.high_x[k] = box.high_x;
            block.low_y[k] = box.low_y, block.high_y[k] = box.high_y;
            all.low_x = (std::min)(all.low_x, box.low_x), all.high_x = (std::max)(all.high_x, box.high_x);
            all.low_y = (std::min)(all.low_y, box.low_y), all.high_y = (std::max)(all.high_y, box.high_y);
        }
    }
}

// Tests whether no edge of the second block meets an edge of the first that precedes it, its neighbours left out. The
// blocks may be equal.
bool SimpleRing::are_apart(std::span<const glm::dvec2> points, std::size_t a, std::size_t b) const {
    const Block &first = blocks_[a], &second = blocks_[b];
    const Box& bound = bounds_[b];
    const std::size_t count = points.size();
    const auto point = [&](std::size_t i) -> const glm::dvec2& { return points[i == count ? 0 : i]; };
    // Boxes of numbers beyond floats are infinite, and meet those of unused edges.
    for (std::size_t k = 0; k < kWidth && a * kWidth + k < count; ++k) {
        const float low_x = first.low_x[k], high_x = first.high_x[k];
        const float low_y = first.low_y[k], high_y = first.high_y[k];
        if (low_x > bound.high_x || high_x < bound.low_x || low_y > bound.high_y || high_y < bound.low_y) continue;
        int meet[kWidth];
        for (std::size_t m = 0; m < kWidth; ++m)
            meet[m] = (second.low_x[m] <= high_x) & (second.high_x[m] >= low_x) & (second.low_y[m] <= high_y) &
                      (second.high_y[m] >= low_y);
        const std::size_t i = a * kWidth + k;
        for (std::size_t m = 0; m < kWidth; ++m) {
            if (meet[m] == 0) continue;
            const std::size_t j = b * kWidth + m;
            if (j <= i + 1 || j >= count || (i == 0 && j + 1 == count)) continue;
            if (edges_meet(point(i), point(i + 1), point(j), point(j + 1))) return false;
        }
    }
    return true;
}

int SimpleRing::turn_of(std::span<const glm::dvec2> points) {
    const std::size_t count = points.size();
    std::size_t lowest = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const glm::dvec2 &before = points[i == 0 ? count - 1 : i - 1], &at = points[i],
                         &after = points[i + 1 == count ? 0 : i + 1];
        if (at == after) return 0;
        // Flat corners continue straight, others may turn anywhere.
        if (orientation(before, at, after) == 0 && comes_before(before, at) != comes_before(at, after)) return 0;
        if (comes_before(at, points[lowest])) lowest = i;
    }
    build(points);
    for (std::size_t a = 0; a < blocks_.size(); ++a)
        for (std::size_t b = a; b < blocks_.size(); ++b) {
            const Box &p = bounds_[a], &q = bounds_[b];
            const bool meet =
                (p.low_x <= q.high_x) & (p.high_x >= q.low_x) & (p.low_y <= q.high_y) & (p.high_y >= q.low_y);
            if (meet && !are_apart(points, a, b)) return 0;
        }
    // Both sides of the first corner lead onwards, on different lines.
    return orientation(points[lowest == 0 ? count - 1 : lowest - 1], points[lowest],
                       points[lowest + 1 == count ? 0 : lowest + 1]);
}

}  // namespace crofton::triangulate
