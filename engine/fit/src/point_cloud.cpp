#include "point_cloud.hpp"

#include <algorithm>
#include <cmath>
#include <crofton/geometry/obb.hpp>
#include <glm/geometric.hpp>
#include <string>

namespace crofton::fit {
namespace {

template <class Point>
Result<Aabb> checked_bounds(std::span<const Point> points) {
    if (points.empty()) return fail(ErrorCode::empty, kNoItem, "fit: no points");
    Aabb bounds;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const glm::dvec3 p(points[i]);
        const double size = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
        if (!(size <= kMaxCoordinate) || std::isnan(p.x) || std::isnan(p.y) || std::isnan(p.z)) {
            const bool finite = std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
            return fail(finite ? ErrorCode::out_of_range : ErrorCode::non_finite, i,
                        "fit: point " + std::to_string(i) + (finite ? " exceeds 1e30" : " is NaN or infinite"));
        }
        bounds.include(p);
    }
    return bounds;
}

}  // namespace

void make_canonical(Vector<glm::dvec3>& points) {
    std::sort(points.begin(), points.end(), lexicographic);
    points.erase(std::unique(points.begin(), points.end()), points.end());
}

template <class Point>
Result<PointCloud> PointCloud::make(std::span<const Point> points) {
    Result<Aabb> bounds = checked_bounds(points);
    if (!bounds) return tl::unexpected(bounds.error());
    PointCloud cloud;
    cloud.bounds_ = *bounds;
    cloud.origin_ = bounds->center();
    const glm::dvec3 half = bounds->half_extents();
    const double largest = std::max({half.x, half.y, half.z});
    if (largest > 0.0) cloud.unit_ = std::exp2(std::ceil(std::log2(largest)));
    const double scale = 1.0 / cloud.unit_;
    cloud.points_.reserve(points.size());
    for (const Point& p : points) cloud.points_.push_back((glm::dvec3(p) - cloud.origin_) * scale);
    return cloud;
}

template Result<PointCloud> PointCloud::make(std::span<const glm::vec3>);
template Result<PointCloud> PointCloud::make(std::span<const glm::dvec3>);

std::array<glm::dvec3, 2> PointCloud::extreme_pair(const glm::dvec3& direction) const {
    std::array<glm::dvec3, 2> best = {points_[0], points_[0]};
    double high = glm::dot(points_[0], direction), low = high;
    for (const glm::dvec3& p : points_) {
        const double t = glm::dot(p, direction);
        if (t >= high && (t > high || lexicographic(p, best[0]))) {
            high = t;
            best[0] = p;
        }
        if (t <= low && (t < low || lexicographic(p, best[1]))) {
            low = t;
            best[1] = p;
        }
    }
    return best;
}

Supports PointCloud::supports(const glm::dmat3& axes) const {
    Supports result;
    for (int k = 0; k < 3; ++k) {
        const auto pair = extreme_pair(axes[k]);
        result[static_cast<std::size_t>(2 * k)] = pair[0];
        result[static_cast<std::size_t>(2 * k + 1)] = pair[1];
    }
    return result;
}

void PointCloud::extremes(std::span<const glm::dvec3> directions, Vector<glm::dvec3>& out) const {
    for (const glm::dvec3& direction : directions) {
        const auto pair = extreme_pair(direction);
        out.push_back(pair[0]);
        out.push_back(pair[1]);
    }
}

}  // namespace crofton::fit
