// SPDX-License-Identifier: MIT
// Hull::build: the convex hull of points as a shape, with its planes, and checks of the input.
#include <algorithm>
#include <cmath>
#include <crofton/convex/shape.hpp>
#include <crofton/core/recovery.hpp>
#include <glm/geometric.hpp>
#include <string>

#include "mass_integrals.hpp"
#include "quickhull.hpp"

namespace crofton::convex {
namespace {

using Points = Vector<glm::dvec3>;

Result<void> check(std::span<const glm::vec3> points, const HullOptions& options) {
    if (options.max_vertices < 4 || options.max_vertices > kMaxHullVertices)
        return fail(ErrorCode::invalid_argument, kNoItem, "hull: max_vertices must be in [4, 256]");
    if (!(options.face_tolerance >= 0.0f && options.face_tolerance <= 1e-2f))
        return fail(ErrorCode::invalid_argument, kNoItem, "hull: face_tolerance must be in [0, 1e-2]");
    if (points.size() < 4) return fail(ErrorCode::empty, kNoItem, "hull: fewer than four points");
    if (points.size() > (std::size_t{1} << 31))
        return fail(ErrorCode::out_of_range, kNoItem, "hull: more than 2^31 points");
    for (std::size_t i = 0; i < points.size(); ++i)
        for (int k = 0; k < 3; ++k) {
            if (!std::isfinite(points[i][k]))
                return fail(ErrorCode::non_finite, i, {"hull: point ", i, " is NaN or infinite"});
            if (std::abs(points[i][k]) > kMaxExtent)
                return fail(ErrorCode::out_of_range, i, {"hull: point ", i, " exceeds 1e15"});
        }
    return {};
}

// The corners of the hull of `points`, and its triangles over them.
struct CornerHull {
    Points corners;
    ExactHull hull;
};

Result<CornerHull> hull_of_corners(const Points& points, std::size_t max_vertices) {
    CornerHull result{points, {}};
    for (;;) {
        Result<ExactHull> hull = quickhull(result.corners, max_vertices);
        if (!hull) return hull.error();
        result.hull = std::move(*hull);
        if (result.hull.missing > 0.0) return result;
        const Vector<std::uint32_t> kept = corners_of(result.hull, result.corners);
        if (kept.size() == result.corners.size()) return result;
        // Once more from the corners alone: then each point is a corner of the next hull.
        Points next;
        for (const std::uint32_t i : kept) next.push_back(result.corners[i]);
        result.corners = std::move(next);
    }
}

// The chosen corners moved away from the center until their hull holds all points. Rounding to float may push one out:
// then a little farther.
Result<CornerHull> grown(const CornerHull& small, const Points& points, double& max_overshoot) {
    Points chosen;
    Vector<char> used(small.corners.size(), 0);
    for (const auto& t : small.hull.triangles)
        for (const std::uint32_t v : t) used[v] = 1;
    for (std::size_t i = 0; i < used.size(); ++i) {
        if (used[i] != 0) chosen.push_back(small.corners[i]);
    }
    for (double more = small.hull.missing + 1e-7; more < 64.0; more = 1.25 * more + 1e-6) {
        Points moved;
        double farthest = 0.0;
        for (const glm::dvec3& p : chosen) {
            moved.emplace_back(glm::vec3(small.hull.center + (1.0 + more) * (p - small.hull.center)));
            farthest = std::max(farthest, glm::distance(moved.back(), p));
        }
        Result<CornerHull> result = hull_of_corners(moved, static_cast<std::size_t>(kMaxHullVertices));
        if (!result) return result;
        if (!contains_all(result->hull, result->corners, points)) continue;
        max_overshoot = farthest * (1.0 + 1e-6);
        return result;
    }
    return fail(ErrorCode::degenerate, kNoItem,
                "hull: the points are too flat for a hull of max_vertices; allow more or thicken them");
}

template <class List>
Vector<double> side_by_side(const List& points) {
    const std::size_t count = points.size(), padded = (count + 3) / 4 * 4;
    Vector<double> columns(3 * padded);
    for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t i = 0; i < padded; ++i)
            columns[k * padded + i] = points[std::min(i, count - 1)][static_cast<int>(k)];
    return columns;
}

// The least distance of the planes from the center, less what rounding may add.
double inner_radius_of(const CornerHull& shape, const glm::dvec3& center, double outer_radius) {
    double least = outer_radius;
    for (const auto& t : shape.hull.triangles) {
        const glm::dvec3 a = shape.corners[t[0]];
        const glm::dvec3 n = glm::cross(shape.corners[t[1]] - a, shape.corners[t[2]] - a);
        const double length = glm::length(n);
        least = std::min(least, length > 0.0 ? glm::dot(n, a - center) / length : 0.0);
    }
    return std::max(0.0, 0.999 * least - 1e-9 * outer_radius);
}

}  // namespace

// Edges are differences of floats, off by 2^-53 of themselves; their product by 2^-50 of both lengths.
void Hull::find_planes() {
    const std::size_t count = triangles_.size() / 3;
    planes_.resize(4 * count);
    for (std::size_t i = 0; i < count; ++i) {
        const auto corner = [&](std::size_t k) { return glm::dvec3(vertices_[triangles_[3 * i + k]]); };
        const glm::dvec3 e = corner(1) - corner(0), f = corner(2) - corner(0), n = glm::cross(e, f);
        const double length = glm::length(n);
        plane_error_ =
            length > 0.0 ? std::max(plane_error_, 0x1p-50 * glm::length(e) * glm::length(f) / length) : HUGE_VAL;
        for (std::size_t k = 0; k < 3; ++k) planes_[k * count + i] = n[static_cast<int>(k)] / length;
        planes_[3 * count + i] = glm::dot(n, corner(0)) / length;
    }
}

Result<Hull> Hull::build(std::span<const glm::vec3> points, const HullOptions& options) {
    if (Result<void> good = check(points, options); !good) return good.error();
    return detail::recover([&]() -> Result<Hull> {
        Points all(points.begin(), points.end());
        Result<CornerHull> result = hull_of_corners(all, static_cast<std::size_t>(options.max_vertices));
        if (!result) return result.error();
        Hull hull;
        if (result->hull.missing > 0.0) {
            result = grown(*result, all, hull.max_overshoot_);
            if (!result) return result.error();
        }
        for (const glm::dvec3& p : result->corners) {
            hull.vertices_.emplace_back(p);
            hull.radius_ = std::max(hull.radius_, glm::length(p));
        }
        for (const auto& t : result->hull.triangles)
            for (const std::uint32_t v : t) hull.triangles_.push_back(static_cast<std::uint16_t>(v));
        hull.columns_ = side_by_side(result->corners);
        hull.padded_count_ = static_cast<int>(hull.columns_.size() / 3);
        hull.find_faces(static_cast<double>(options.face_tolerance));
        hull.index_edges();
        hull.find_planes();
        hull.mass_ = mass_of_triangles(result->corners, result->hull.triangles);
        hull.normal_columns_ = side_by_side(hull.normals_);
        hull.padded_face_count_ = static_cast<int>(hull.normal_columns_.size() / 3);
        hull.describe_faces();
        hull.find_spokes();
        hull.inner_radius_ = inner_radius_of(*result, hull.mass_.center, hull.radius_);
        return hull;
    });
}

}  // namespace crofton::convex
