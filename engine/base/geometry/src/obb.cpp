// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/expansion.hpp>
#include <crofton/geometry/finite.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>
#include <string>

namespace crofton {
namespace {

// half_extents[k] · axes[k]: exact, a product of two floats fits a double.
glm::dvec3 half_edge(const Obb& box, int k) {
    return glm::dvec3(box.axes[k]) * static_cast<double>(box.half_extents[k]);
}

double half_extent(const Obb& box, int k) {
    return static_cast<double>(box.half_extents[k]);
}

float float_at_least(double value) {
    const float rounded = static_cast<float>(value);
    return static_cast<double>(rounded) < value ? std::nextafter(rounded, std::numeric_limits<float>::infinity())
                                                : rounded;
}

using Cross = std::array<Expansion<2>, 3>;

Cross exact_cross(const glm::dvec3& a, const glm::dvec3& b) {
    const auto component = [&](int i, int j) { return exact(a[i] * b[j]) - exact(a[j] * b[i]); };
    return {component(1, 2), component(2, 0), component(0, 1)};
}

// As contains_along below, in double; nothing if rounding could change the answer. Each product of axes is exact. A
// term of a sum is rounded at most six times, by 2^-53 of the sum of magnitudes each: 2^-49 is more than twice as much.
// The least normal number covers terms that underflow.
std::optional<bool> filtered_contains_along(const Obb& box, const glm::dvec3& point, int k) {
    const glm::dvec3 u(box.axes[(k + 1) % 3]), v(box.axes[(k + 2) % 3]), axis(box.axes[k]), d = point - box.center;
    double distance = 0.0, radius = 0.0, distance_size = 0.0, radius_size = 0.0;
    for (int i = 0; i < 3; ++i) {
        const double a = u[(i + 1) % 3] * v[(i + 2) % 3], b = u[(i + 2) % 3] * v[(i + 1) % 3];
        const double size = std::abs(a) + std::abs(b);
        distance += d[i] * (a - b);
        radius += axis[i] * (a - b);
        distance_size += std::abs(d[i]) * size;
        radius_size += std::abs(axis[i]) * size;
    }
    const double h = half_extent(box, k), beyond = std::abs(distance) - std::abs(radius * h);
    const double rounding = 0x1p-49 * (distance_size + radius_size * h) + std::numeric_limits<double>::min();
    if (beyond < -rounding) return true;
    if (beyond > rounding) return false;
    return std::nullopt;
}

}  // namespace

Result<void> validate(const Obb& box, std::uint64_t item) {
    const auto bad = [&](ErrorCode code, const char* why) { return fail(code, item, why); };
    for (int k = 0; k < 3; ++k) {
        if (!is_finite(glm::dvec3(box.axes[k]))) return bad(ErrorCode::non_finite, "box: an axis is NaN or infinite");
        if (!std::isfinite(box.half_extents[k]))
            return bad(ErrorCode::non_finite, "box: a half extent is NaN or infinite");
        if (!(box.half_extents[k] >= 0.0f)) return bad(ErrorCode::invalid_argument, "box: a half extent is negative");
        if (half_extent(box, k) > kMaxCoordinate)
            return bad(ErrorCode::out_of_range, "box: a half extent exceeds 1e30");
    }
    if (!is_finite(box.center)) return bad(ErrorCode::non_finite, "box: the centre is NaN or infinite");
    for (int k = 0; k < 3; ++k)
        if (std::abs(box.center[k]) > kMaxCoordinate)
            return bad(ErrorCode::out_of_range, "box: the centre exceeds 1e30");
    for (int i = 0; i < 3; ++i)
        for (int j = i; j < 3; ++j) {
            const double product = glm::dot(glm::dvec3(box.axes[i]), glm::dvec3(box.axes[j]));
            if (std::abs(product - (i == j ? 1.0 : 0.0)) > kMaxAxisDeviation)
                return bad(ErrorCode::invalid_argument,
                           "box: the axes are not orthonormal to 1e-4; normalise them first");
        }
    return {};
}

std::array<glm::dvec3, 8> corners(const Obb& box) {
    const glm::dvec3 u = half_edge(box, 0), v = half_edge(box, 1), w = half_edge(box, 2);
    std::array<glm::dvec3, 8> result;
    for (unsigned i = 0; i < 8; ++i)
        result[i] = box.center + ((i & 1u) ? u : -u) + ((i & 2u) ? v : -v) + ((i & 4u) ? w : -w);
    return result;
}

bool contains_along(const Obb& box, const glm::dvec3& point, int k) {
    if (const auto known = filtered_contains_along(box, point, k)) return *known;
    // point − center = Σ s_k axes[k] with s_k = det(d, axes[i], axes[j]) / det(axes); inside iff |s_k| ≤
    // half_extents[k].
    const Cross normal = exact_cross(glm::dvec3(box.axes[(k + 1) % 3]), glm::dvec3(box.axes[(k + 2) % 3]));
    const glm::dvec3 axis(box.axes[k]);
    auto projected_radius = (normal[0] * axis.x + normal[1] * axis.y + normal[2] * axis.z) * half_extent(box, k);
    auto distance = exact_difference(point.x, box.center.x) * normal[0] +
                    exact_difference(point.y, box.center.y) * normal[1] +
                    exact_difference(point.z, box.center.z) * normal[2];
    if (projected_radius.sign() < 0) projected_radius = -projected_radius;
    if (distance.sign() < 0) distance = -distance;
    return (distance - projected_radius).sign() <= 0;
}

bool contains(const Obb& box, const glm::dvec3& point) {
    return contains_along(box, point, 0) && contains_along(box, point, 1) && contains_along(box, point, 2);
}

glm::dvec3 support_point(const Obb& box, const glm::dvec3& direction) {
    glm::dvec3 point = box.center;
    for (int k = 0; k < 3; ++k) {
        const glm::dvec3 edge = half_edge(box, k);
        point += glm::dot(edge, direction) >= 0.0 ? edge : -edge;
    }
    return point;
}

Aabb aabb_of(const Obb& box) {
    Aabb result;
    for (int i = 0; i < 3; ++i) {
        double projected_radius = 0.0;
        for (int k = 0; k < 3; ++k) projected_radius += std::abs(half_edge(box, k)[i]);
        // Two rounded additions lie within 2^-52 relative of the exact sum; one more step outward covers the last
        // addition.
        projected_radius += projected_radius * 0x1p-51;
        result.min[i] = std::nextafter(box.center[i] - projected_radius, -kInfinity);
        result.max[i] = std::nextafter(box.center[i] + projected_radius, kInfinity);
    }
    return result;
}

Obb obb_of(const Aabb& box) {
    Obb result;
    result.center = box.center();
    for (int i = 0; i < 3; ++i) {
        const double half_width = std::max(box.max[i] - result.center[i], result.center[i] - box.min[i]);
        result.half_extents[i] = float_at_least(std::nextafter(half_width, kInfinity));
        if (box.min[i] == box.max[i]) result.half_extents[i] = 0.0f;
    }
    return result;
}

double volume(const Obb& box) {
    return 8.0 * half_extent(box, 0) * half_extent(box, 1) * half_extent(box, 2);
}

double surface_area(const Obb& box) {
    const double a = half_extent(box, 0), b = half_extent(box, 1), c = half_extent(box, 2);
    return 8.0 * (a * b + b * c + c * a);
}

double edge_sum(const Obb& box) {
    return 2.0 * (half_extent(box, 0) + half_extent(box, 1) + half_extent(box, 2));
}

}  // namespace crofton
