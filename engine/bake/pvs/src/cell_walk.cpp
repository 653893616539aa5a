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
    const Aabb bounds{cells.bounds().min - origin, cells.bounds().max - origin};
    if (cells.is_grid()) {
        const auto counts = cells.counts();
        set_grid(bounds, {counts.x, counts.y, counts.z});
        return;
    }
    for (std::size_t i = 0; i < cells.size(); ++i)
        boxes_.push_back({cells.box(i).min - origin, cells.box(i).max - origin});
    voxels_.emplace(boxes_, bounds);
    set_grid(bounds, voxels_->counts);
    for (std::size_t i = 0; i < cells.size() && cells.is_convex(); ++i) {
        const glm::dvec3 corner = cells.corners(i).corners[0] - origin;
        for (const Plane& plane : cells.planes(i))
            planes_.push_back({plane.normal, plane.offset - glm::dot(plane.normal, corner)});
        plane_ends_.push_back(static_cast<std::uint32_t>(planes_.size()));
    }
}

void CellWalk::set_grid(const Aabb& bounds, const std::uint32_t (&counts)[3]) {
    double stride = 1.0;
    for (int k = 0; k < 3; ++k) {
        const double extent = bounds.max[k] - bounds.min[k];
        grid_.min[k] = bounds.min[k], grid_.max[k] = bounds.max[k];
        grid_.width[k] = extent / counts[k];
        grid_.per_length[k] = extent > 0.0 ? counts[k] / extent : 0.0;
        grid_.counts[k] = counts[k];
        grid_.strides[k] = stride;
        stride *= counts[k];
    }
}

void CellWalk::pass(std::span<const Line> lines, VoxelPaths& paths) const {
    static_assert(sizeof(Line) == 6 * sizeof(double));
    CROFTON_ASSERT(lines.size() == VoxelPaths::kLines, "so many lines pass at once");
    while (!kernels::walk(grid_, &lines[0].point.x, paths.start, paths.steps.data(), paths.steps.size()))
        paths.steps.resize(2 * paths.steps.size());
}

void CellWalk::find(const Line& line, const VoxelPaths& paths, std::size_t number, CellSpans& spans) const {
    spans.all.clear();
    spans.asked.resize(boxes_.size(), 0);
    ++spans.line;
    for (std::size_t n = 0; n < paths.count(number); ++n)
        for (const std::uint32_t i : voxels_->boxes_in(paths.steps[n].voxel[number])) {
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
}

}  // namespace crofton::pvs
