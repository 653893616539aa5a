// SPDX-License-Identifier: MIT
#include "cell_walk.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace crofton::pvs {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

inline std::uint32_t voxel_of(double x, const Aabb& bounds, int k, std::uint32_t count) {
    const double extent = bounds.max[k] - bounds.min[k];
    if (!(extent > 0.0)) return 0;
    const double at = (x - bounds.min[k]) / extent * count;
    return at <= 0.0 ? 0 : (std::min)(static_cast<std::uint32_t>((std::min)(at, 4e9)), count - 1);
}

}  // namespace

bool clip(const Line& line, const Aabb& box, double& begin, double& end) {
    begin = -kInfinity, end = kInfinity;
    for (int k = 0; k < 3; ++k) {
        const double d = line.direction[k], p = line.point[k];
        if (d == 0.0) {
            if (p < box.min[k] || p > box.max[k]) return false;
            continue;
        }
        const double a = (box.min[k] - p) / d, b = (box.max[k] - p) / d;
        begin = (std::max)(begin, (std::min)(a, b));
        end = (std::min)(end, (std::max)(a, b));
    }
    return begin <= end;
}

CellWalk::CellWalk(const Cells& cells, const glm::dvec3& origin) {
    bounds_ = {cells.bounds().min - origin, cells.bounds().max - origin};
    if (cells.is_grid()) {
        for (int k = 0; k < 3; ++k) counts_[k] = cells.counts()[k];
        set_steps();
        return;
    }
    for (std::size_t i = 0; i < cells.size(); ++i)
        boxes_.push_back({cells.box(i).min - origin, cells.box(i).max - origin});
    // About a voxel for each box.
    const double side = std::sqrt(static_cast<double>(boxes_.size()));
    for (int k = 0; k < 3; ++k)
        counts_[k] = static_cast<std::uint32_t>(std::clamp(k == 1 ? side / 4.0 : side, 1.0, 64.0));
    set_steps();
    const auto each_voxel = [&](const Aabb& box, auto&& visit) {
        std::uint32_t low[3], high[3];
        for (int k = 0; k < 3; ++k) {
            low[k] = voxel_of(box.min[k], bounds_, k, counts_[k]);
            high[k] = voxel_of(box.max[k], bounds_, k, counts_[k]);
            low[k] -= low[k] > 0;  // rounding of a walk's steps
            high[k] += high[k] + 1 < counts_[k];
        }
        for (std::uint32_t z = low[2]; z <= high[2]; ++z)
            for (std::uint32_t y = low[1]; y <= high[1]; ++y)
                for (std::uint32_t x = low[0]; x <= high[0]; ++x) visit(x + counts_[0] * (y + counts_[1] * z));
    };
    first_.assign(std::size_t{counts_[0]} * counts_[1] * counts_[2] + 1, 0);
    for (const Aabb& box : boxes_) each_voxel(box, [&](std::uint32_t v) { ++first_[v + 1]; });
    for (std::size_t v = 1; v < first_.size(); ++v) first_[v] += first_[v - 1];
    listed_.resize(first_.back());
    Vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for (std::uint32_t i = 0; i < boxes_.size(); ++i)
        each_voxel(boxes_[i], [&](std::uint32_t v) { listed_[next[v]++] = i; });
}

void CellWalk::set_steps() {
    for (int k = 0; k < 3; ++k) {
        const double extent = bounds_.max[k] - bounds_.min[k];
        widths_[k] = extent / counts_[k];
        per_length_[k] = extent > 0.0 ? counts_[k] / extent : 0.0;
        last_[k] = std::int64_t{counts_[k]} - 1;
    }
}

// Amanatides and Woo, "A fast voxel traversal algorithm for ray tracing" (1987).
template <class Visit>
void CellWalk::walk(const Line& line, Visit&& visit) const {
    double begin = 0.0, end = 0.0;
    if (!clip(line, bounds_, begin, end)) return;
    std::int64_t at[3], step[3], stride[3] = {1, counts_[0], std::int64_t{counts_[0]} * counts_[1]};
    double next[3], pace[3];
    for (int k = 0; k < 3; ++k) {
        const double d = line.direction[k], inverse = 1.0 / d, width = widths_[k];
        const double from = (line.point[k] + begin * d - bounds_.min[k]) * per_length_[k];
        at[k] = from > 0.0 ? (std::min)(static_cast<std::int64_t>((std::min)(from, 4e9)), last_[k]) : 0;
        step[k] = d > 0.0 ? 1 : -1;
        const double border = bounds_.min[k] + static_cast<double>(at[k] + (d > 0.0)) * width;
        next[k] = d == 0.0 ? kInfinity : (border - line.point[k]) * inverse;
        pace[k] = d == 0.0 ? kInfinity : width * std::abs(inverse);
    }
    std::int64_t voxel = at[0] + stride[1] * at[1] + stride[2] * at[2];
    for (double t = begin;;) {
        const int k = next[0] <= next[1] ? (next[0] <= next[2] ? 0 : 2) : (next[1] <= next[2] ? 1 : 2);
        const double until = (std::min)(next[k], end);
        visit(static_cast<std::uint32_t>(voxel), t, (std::max)(t, until));
        if (next[k] >= end) return;
        t = (std::max)(t, until);
        at[k] += step[k];
        if (at[k] < 0 || at[k] >= counts_[k]) return;
        voxel += step[k] * stride[k];
        next[k] += pace[k];
    }
}

void CellWalk::find(const Line& line, Vector<CellSpan>& spans) const {
    spans.clear();
    if (boxes_.empty()) {
        walk(line, [&](std::uint32_t cell, double begin, double end) { spans.push_back({cell, begin, end}); });
        return;
    }
    walk(line, [&](std::uint32_t voxel, double, double) {
        for (std::uint32_t i = first_[voxel]; i < first_[voxel + 1]; ++i) {
            CellSpan span{listed_[i], 0.0, 0.0};
            if (clip(line, boxes_[span.cell], span.begin, span.end)) spans.push_back(span);
        }
    });
}

}  // namespace crofton::pvs
