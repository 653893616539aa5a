#include "enclose.hpp"

#include <cmath>
#include <crofton/core/assert.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>

namespace crofton::fit {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kUnit = 0x1p-53;  // unit roundoff of double

// The reciprocal basis up to scale: a point c + d is inside iff |dot(normal[k], d)| ≤ half_extents[k] · determinant for
// all k. A product of floats is exact in double, so each component of a normal carries one rounding, and the
// determinant (of nearly orthonormal axes: no cancellation, Σ|terms| ≤ 1.8) less than 16 units of it.
struct Slabs {
    glm::dmat3 normals;
    double determinant;

    explicit Slabs(const glm::mat3& axes) {
        const glm::dmat3 a(axes);
        for (int k = 0; k < 3; ++k) normals[k] = glm::cross(a[(k + 1) % 3], a[(k + 2) % 3]);
        determinant = std::abs(glm::dot(normals[0], a[0]));
    }
};

// True if the filter proves the point inside slab k. d = p − c and every factor and product below is rounded once, sums
// twice: |error| ≤ 6 units of Σ|normal_i d_i| (+ one least denormal each where products underflow).
bool surely_inside(const glm::dvec3& normal, const glm::dvec3& d, double reach) {
    const double x = normal.x * d.x, y = normal.y * d.y, z = normal.z * d.z;
    const double magnitude = std::abs(x) + std::abs(y) + std::abs(z);
    return std::abs(x + y + z) + 6.5 * kUnit * magnitude <= reach;
}

float nearest_float(double value) {
    return static_cast<float>(value);
}

template <class Point>
Obb enclose_points(std::span<const Point> points, const glm::mat3& axes, const glm::dvec3& reference) {
    CROFTON_ASSERT(!points.empty(), "enclose needs a point");
    const Slabs slabs(axes);
    glm::dvec3 low(kInfinity), high(-kInfinity);
    for (const Point& point : points) {
        const glm::dvec3 d = glm::dvec3(point) - reference;
        for (int k = 0; k < 3; ++k) {
            const double t = glm::dot(slabs.normals[k], d);
            low[k] = std::min(low[k], t);
            high[k] = std::max(high[k], t);
        }
    }
    Obb box;
    box.axes = axes;
    const glm::dvec3 middle = (low + (high - low) * 0.5) / slabs.determinant;
    box.center = reference + glm::dmat3(axes) * middle;
    // The centre is rounded: measure again from where it is.
    low = glm::dvec3(kInfinity);
    high = glm::dvec3(-kInfinity);
    for (const Point& point : points) {
        const glm::dvec3 d = glm::dvec3(point) - box.center;
        for (int k = 0; k < 3; ++k) {
            const double t = glm::dot(slabs.normals[k], d);
            low[k] = std::min(low[k], t);
            high[k] = std::max(high[k], t);
        }
    }
    glm::dvec3 reach;
    const auto set = [&](int k, float half) {
        box.half_extents[k] = half;
        reach[k] = static_cast<double>(half) * (slabs.determinant * (1.0 - 20.0 * kUnit));
    };
    for (int k = 0; k < 3; ++k) set(k, nearest_float(std::max(high[k], -low[k]) / slabs.determinant));
    for (const Point& point : points) {
        const glm::dvec3 p(point), d = p - box.center;
        for (int k = 0; k < 3; ++k) {
            if (surely_inside(slabs.normals[k], d, reach[k])) continue;
            while (!contains_along(box, p, k))
                set(k, std::nextafter(box.half_extents[k], std::numeric_limits<float>::infinity()));
        }
    }
    return box;
}

}  // namespace

Obb enclose(std::span<const glm::vec3> points, const glm::mat3& axes, const glm::dvec3& reference) {
    return enclose_points(points, axes, reference);
}
Obb enclose(std::span<const glm::dvec3> points, const glm::mat3& axes, const glm::dvec3& reference) {
    return enclose_points(points, axes, reference);
}

glm::mat3 rounded(const glm::dmat3& axes) {
    return glm::mat3(axes);
}

}  // namespace crofton::fit
