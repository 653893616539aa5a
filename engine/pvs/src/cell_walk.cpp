// SPDX-License-Identifier: MIT
#include "cell_walk.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

namespace crofton::pvs {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

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

bool clip(const Line& line, std::span<const Plane> planes, double& begin, double& end) {
    for (const Plane& plane : planes) {
        const double height = glm::dot(plane.normal, line.point) + plane.offset,
                     slope = glm::dot(plane.normal, line.direction);
        if (slope == 0.0 && height < 0.0) return false;
        if (slope > 0.0) begin = (std::max)(begin, -height / slope);
        if (slope < 0.0) end = (std::min)(end, -height / slope);
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
    voxels_.emplace(boxes_, bounds_);
    std::copy(std::begin(voxels_->counts), std::end(voxels_->counts), counts_);
    set_steps();
    for (std::size_t i = 0; i < cells.size() && cells.is_convex(); ++i) {
        const glm::dvec3 corner = cells.corners(i).corners[0] - origin;
        for (const Plane& plane : cells.planes(i))
            planes_.push_back({plane.normal, plane.offset - glm::dot(plane.normal, corner)});
        plane_ends_.push_back(static_cast<std::uint32_t>(planes_.size()));
    }
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

void CellWalk::find(const Line& line, CellSpans& spans) const {
    spans.all.clear();
    if (boxes_.empty()) {
        walk(line, [&](std::uint32_t cell, double begin, double end) { spans.all.push_back({cell, begin, end}); });
        return;
    }
    spans.asked.resize(boxes_.size(), 0);
    ++spans.line;
    walk(line, [&](std::uint32_t voxel, double, double) {
        for (const std::uint32_t i : voxels_->boxes_in(voxel)) {
            if (spans.asked[i] == spans.line) continue;
            spans.asked[i] = spans.line;
            CellSpan span{i, 0.0, 0.0};
            if (!clip(line, boxes_[i], span.begin, span.end)) continue;
            if (!planes_.empty()) {
                const std::uint32_t first = i == 0 ? 0 : plane_ends_[i - 1];
                const auto planes = std::span(planes_).subspan(first, plane_ends_[i] - first);
                if (!clip(line, planes, span.begin, span.end)) continue;
            }
            spans.all.push_back(span);
        }
    });
}

}  // namespace crofton::pvs
