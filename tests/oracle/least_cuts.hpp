// SPDX-License-Identifier: MIT
// Where a small crowd should be cut: all cuts tried, each part sorted anew.
#pragma once
#include <algorithm>
#include <crofton/geometry/box.hpp>
#include <crofton/measure/measure.hpp>
#include <cstdint>
#include <limits>
#include <vector>

namespace crofton::oracle {

using Part = std::vector<std::uint32_t>;

// Two parts, the first of a multiple of `unit` items.
inline std::pair<Part, Part> least_cut(const Part& whole, std::span<const Obb> boxes, std::size_t unit,
                                       const measure::Criterion& criterion) {
    const auto value = [&](auto first, auto last) {
        Aabb bounds;
        for (auto i = first; i != last; ++i) bounds.include(aabb_of(boxes[*i]));
        const glm::dvec3 size = bounds.max - bounds.min;
        return criterion(size.x, size.y, size.z) * static_cast<double>(last - first);
    };
    Part best, sorted = whole;
    double least = std::numeric_limits<double>::infinity();
    std::size_t best_left = unit;
    for (int axis = 0; axis < 3; ++axis) {
        const auto center = [&](std::uint32_t i) { return boxes[i].center[axis]; };
        std::sort(sorted.begin(), sorted.end(), [&](auto a, auto b) { return center(a) < center(b); });
        for (std::size_t left = unit; left < whole.size(); left += unit) {
            const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(left);
            // With two units there is one place for each axis: then the centres' spread chooses the axis.
            const double cost = whole.size() <= 2 * unit ? center(sorted.front()) - center(sorted.back())
                                                         : value(sorted.begin(), middle) + value(middle, sorted.end());
            if (cost < least) least = cost, best = sorted, best_left = left;
        }
    }
    const auto middle = best.begin() + static_cast<std::ptrdiff_t>(best_left);
    return {Part(best.begin(), middle), Part(middle, best.end())};
}

// Parts of `unit` items, the last of which may be smaller; always the largest is cut, the first among equals.
inline std::vector<Part> least_cuts(std::span<const Obb> boxes, std::size_t unit, const measure::Criterion& criterion) {
    std::vector<Part> parts(1);
    for (std::uint32_t i = 0; i < boxes.size(); ++i) parts[0].push_back(i);
    for (;;) {
        const auto largest = std::max_element(parts.begin(), parts.end(),
                                              [](const Part& a, const Part& b) { return a.size() < b.size(); });
        if (largest->size() <= unit) return parts;
        auto [left, right] = least_cut(*largest, boxes, unit, criterion);
        *largest = std::move(left);
        parts.insert(largest + 1, std::move(right));
    }
}

}  // namespace crofton::oracle
