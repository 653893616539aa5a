// SPDX-License-Identifier: MIT
// Divides the space of cameras into the cells of a visible set.
#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/core/memory.hpp>
#include <crofton/core/recovery.hpp>
#include <crofton/geometry/finite.hpp>
#include <crofton/geometry/shapes.hpp>
#include <crofton/pvs/pvs.hpp>
#include <glm/geometric.hpp>

#include "box_voxels.hpp"
#include "shaft.hpp"

namespace crofton::pvs {
namespace {

struct ConvexCellFaces {
    Vector<Plane> planes;  // unit normals, inward, relative to corner 0: the cell is where all are at least 0
    double surface = 0.0;  // area
};

constexpr double kOnPlane = 1e-12;  // of the size
constexpr std::size_t kCorners = 8;

// Corners around the first, and their size.
struct Around {
    std::array<glm::dvec3, kCorners> at;
    double size = 0.0;

    explicit Around(const ConvexCell& cell) {
        for (std::size_t i = 0; i < kCorners; ++i) {
            at[i] = cell.corners[i] - cell.corners[0];
            size = (std::max)(size, glm::length(at[i]));
        }
    }
};

// Returns twice the area of the hull of points in one plane, as the sum over its edges. An edge is a pair that has all
// other points on its left, and none on its line beyond its ends.
double doubled_area(std::span<const glm::dvec3> points, const glm::dvec3& normal, double tolerance) {
    double area = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i)
        for (std::size_t j = 0; j < points.size(); ++j) {
            const glm::dvec3 edge = points[j] - points[i];
            const double length = glm::length(edge);
            if (!(length > tolerance)) continue;
            bool is_edge = true;
            for (const glm::dvec3& p : points) {
                const double left = glm::dot(normal, glm::cross(edge, p - points[i])) / length;
                const double along = glm::dot(edge, p - points[i]) / length;
                if (left < -tolerance) is_edge = false;
                if (left <= tolerance && (along < -tolerance || along > length + tolerance)) is_edge = false;
            }
            if (is_edge) area += glm::dot(normal, glm::cross(points[i] - points[0], points[j] - points[0]));
        }
    return area;
}

// Equal points once.
std::size_t distinct(std::array<glm::dvec3, kCorners>& points, std::size_t count, double tolerance) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; ++i) {
        bool is_new = true;
        for (std::size_t j = 0; j < kept; ++j) is_new = is_new && glm::distance(points[i], points[j]) > tolerance;
        if (is_new) points[kept++] = points[i];
    }
    return kept;
}

// Returns the faces of the hull of the corners. Corners within 1e-12 of the size of a plane lie on it. The plane is
// then moved inward behind all of them, so that what lies within the planes lies within the hull, but for rounding.
// Returns none for a flat hull.
ConvexCellFaces faces_of(const ConvexCell& cell) {
    Around corners(cell);
    const double tolerance = kOnPlane * corners.size;
    const std::size_t count = distinct(corners.at, kCorners, tolerance);
    ConvexCellFaces faces;
    // By the corners that lie on a face: each face is found by several triples.
    Vector<std::uint32_t> found;
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t j = i + 1; j < count; ++j)
            for (std::size_t k = j + 1; k < count; ++k) {
                const glm::dvec3 across = glm::cross(corners.at[j] - corners.at[i], corners.at[k] - corners.at[i]);
                const double length = glm::length(across);
                if (!(length > tolerance * corners.size)) continue;
                for (const glm::dvec3& normal : {across / length, -across / length}) {
                    std::uint32_t on = 0;
                    double least = 0.0, most_on = 0.0;
                    bool beyond = false;
                    std::array<glm::dvec3, kCorners> points{};
                    std::size_t points_on = 0;
                    for (std::size_t p = 0; p < count; ++p) {
                        const double height = glm::dot(normal, corners.at[p] - corners.at[i]);
                        least = (std::min)(least, height);
                        beyond = beyond || height > tolerance;
                        if (std::abs(height) > tolerance) continue;
                        most_on = (std::max)(most_on, height);
                        on |= 1u << p;
                        points[points_on++] = corners.at[p];
                    }
                    if (least < -tolerance || std::find(found.begin(), found.end(), on) != found.end()) continue;
                    if (!beyond) return {};  // all in one plane
                    found.push_back(on);
                    faces.planes.push_back({normal, -glm::dot(normal, corners.at[i]) - most_on});
                    faces.surface +=
                        0.5 * std::abs(doubled_area(std::span(points).first(points_on), normal, tolerance));
                }
            }
    return faces;
}

constexpr std::uint64_t kMaxCells = std::uint64_t{1} << 24;

int positive_extents(const Aabb& box) {
    int count = 0;
    for (int k = 0; k < 3; ++k) count += box.max[k] > box.min[k];
    return count;
}

bool holds(const Aabb& box, const glm::dvec3& p) {
    return p.x >= box.min.x && p.x <= box.max.x && p.y >= box.min.y && p.y <= box.max.y && p.z >= box.min.z &&
           p.z <= box.max.z;
}

}  // namespace

Result<Cells> Cells::grid(const Aabb& bounds, const glm::uvec3& counts) {
    if (!is_in_range(bounds)) return fail(ErrorCode::non_finite, kNoItem, "cells: the bounds are not finite");
    if (positive_extents(bounds) < 3)
        return fail(ErrorCode::degenerate, kNoItem,
                    "cells: the bounds of a grid need a positive extent along each axis");
    if (counts.x == 0 || counts.y == 0 || counts.z == 0)
        return fail(ErrorCode::invalid_argument, kNoItem, "cells: a grid needs at least one cell along each axis");
    // Each factor is checked first, so that the product of three fits.
    const std::uint64_t all =
        counts.x > kMaxCells || counts.y > kMaxCells || counts.z > kMaxCells
            ? kMaxCells + 1
            : (std::uint64_t{counts.x} * counts.y > kMaxCells ? kMaxCells + 1
                                                              : std::uint64_t{counts.x} * counts.y * counts.z);
    if (all > kMaxCells) return fail(ErrorCode::out_of_range, kNoItem, "cells: a grid of more than 2^24 cells");
    Cells cells;
    cells.bounds_ = bounds;
    cells.counts_ = counts;
    return cells;
}

Result<Cells> Cells::boxes(std::span<const Aabb> boxes) {
    return crofton::detail::recover([&]() -> Result<Cells> {
        if (boxes.empty()) return fail(ErrorCode::empty, kNoItem, "cells: there are none");
        if (boxes.size() > kMaxCells) return fail(ErrorCode::out_of_range, boxes.size(), "cells: more than 2^24");
        Cells cells;
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            if (!is_in_range(boxes[i])) return fail(ErrorCode::non_finite, i, "cells: a box is not finite");
            if (boxes[i].is_empty()) return fail(ErrorCode::empty, i, "cells: a box is empty: min is above max");
            if (positive_extents(boxes[i]) < 2)
                return fail(ErrorCode::degenerate, i,
                            "cells: a box needs two positive extents, as lines miss a segment");
            cells.bounds_.include(boxes[i]);
        }
        cells.boxes_.assign(boxes.begin(), boxes.end());
        cells.voxels_ = std::make_shared<const BoxVoxels>(boxes, cells.bounds_);
        return cells;
    });
}

Result<Cells> Cells::convex(std::span<const ConvexCell> convex) {
    return crofton::detail::recover([&]() -> Result<Cells> {
        if (convex.empty()) return fail(ErrorCode::empty, kNoItem, "cells: there are none");
        if (convex.size() > kMaxCells) return fail(ErrorCode::out_of_range, convex.size(), "cells: more than 2^24");
        Cells cells;
        for (std::size_t i = 0; i < convex.size(); ++i) {
            Aabb box;
            for (const glm::dvec3& p : convex[i].corners) {
                if (!is_in_range(p))
                    return fail(ErrorCode::non_finite, i, "cells: a corner of a convex cell is not finite");
                box.include(p);
            }
            const ConvexCellFaces faces = faces_of(convex[i]);
            if (faces.planes.empty())
                return fail(ErrorCode::degenerate, i,
                            "cells: a convex cell needs a volume: its corners are in a plane");
            cells.boxes_.push_back(box);
            cells.bounds_.include(box);
            cells.surfaces_.push_back(faces.surface);
            cells.planes_.insert(cells.planes_.end(), faces.planes.begin(), faces.planes.end());
            cells.plane_ends_.push_back(static_cast<std::uint32_t>(cells.planes_.size()));
        }
        cells.corners_.assign(convex.begin(), convex.end());
        cells.voxels_ = std::make_shared<const BoxVoxels>(cells.boxes_, cells.bounds_);
        return cells;
    });
}

std::size_t Cells::size() const {
    return is_grid() ? std::size_t{counts_.x} * counts_.y * counts_.z : boxes_.size();
}

Aabb Cells::box(std::size_t cell) const {
    if (!is_grid()) return boxes_[cell];
    const std::size_t at[3] = {cell % counts_.x, cell / counts_.x % counts_.y,
                               cell / (std::size_t{counts_.x} * counts_.y)};
    Aabb box;
    for (int k = 0; k < 3; ++k) {
        const double step = (bounds_.max[k] - bounds_.min[k]) / counts_[k];
        box.min[k] = bounds_.min[k] + static_cast<double>(at[k]) * step;
        box.max[k] = at[k] + 1 == counts_[k] ? bounds_.max[k] : bounds_.min[k] + static_cast<double>(at[k] + 1) * step;
    }
    return box;
}

ConvexCell Cells::corners(std::size_t cell) const {
    return is_convex() ? corners_[cell] : ConvexCell{corners_of(box(cell))};
}

double Cells::surface(std::size_t cell) const {
    if (is_convex()) return surfaces_[cell];
    const Aabb own = box(cell);
    const glm::dvec3 e = own.max - own.min;
    return 2.0 * (e.x * e.y + e.y * e.z + e.z * e.x);
}

std::span<const Plane> Cells::planes(std::size_t cell) const {
    if (!is_convex()) return {};
    const std::uint32_t begin = cell == 0 ? 0 : plane_ends_[cell - 1];
    return std::span(planes_).subspan(begin, plane_ends_[cell] - begin);
}

std::uint32_t Cells::find(const glm::dvec3& point) const {
    if (!holds(bounds_, point) || size() == 0) return kNoCell;  // 0: moved from
    if (!is_grid()) {
        for (const std::uint32_t i : voxels_->boxes_near(point)) {
            if (!holds(boxes_[i], point)) continue;
            const auto within = planes(i);
            const auto is_inside = [&](const Plane& plane) {
                return glm::dot(plane.normal, point - corners_[i].corners[0]) + plane.offset >= 0.0;
            };
            if (std::all_of(within.begin(), within.end(), is_inside)) return i;
        }
        return kNoCell;
    }
    std::uint32_t at[3];
    for (int k = 0; k < 3; ++k) {
        const double share = (point[k] - bounds_.min[k]) / (bounds_.max[k] - bounds_.min[k]);
        at[k] = (std::min)(static_cast<std::uint32_t>(share * counts_[k]), counts_[k] - 1);
    }
    return at[0] + counts_.x * (at[1] + counts_.y * at[2]);
}

}  // namespace crofton::pvs
