// SPDX-License-Identifier: MIT
#include "cloud/enclose.hpp"

#include <bit>
#include <cmath>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "rounding.hpp"

namespace crofton::fit {
namespace {

// The reciprocal basis up to scale: a point c + d is inside iff |dot(normal[k], d)| ≤ half_extents[k] · determinant for
// all k. A product of floats is exact in double, so each component of a normal carries one rounding. The determinant
// (of nearly orthonormal axes: no cancellation, Σ|terms| ≤ 1.8) carries less than 16 units of it.
struct Slabs {
    glm::dmat3 normals;
    double determinant;

    explicit Slabs(const glm::mat3& axes) {
        const glm::dmat3 a(axes);
        for (int k = 0; k < 3; ++k) normals[k] = glm::cross(a[(k + 1) % 3], a[(k + 2) % 3]);
        determinant = glm::dot(normals[0], a[0]);
        if (determinant > 0.0) return;  // else the axes are mirrored
        normals = -normals;
        determinant = -determinant;
    }
};

// dot(normal, d) for d = p − c, with a bound of its rounding error. d and every factor and product is rounded once,
// sums twice: |error| ≤ 6 units of Σ|normal_i d_i|.
struct Distance {
    double value, error_bound;

    Distance(const glm::dvec3& normal, const glm::dvec3& d) {
        const double x = normal.x * d.x, y = normal.y * d.y, z = normal.z * d.z;
        value = std::abs(x + y + z);
        error_bound = 6.5 * kUnit * (std::abs(x) + std::abs(y) + std::abs(z));
    }
};

// Relative error bound of a half extent times the determinant, and of a distance divided by it.
constexpr double kScaleError = 24.0 * kUnit;

float float_below(double value) {
    const float nearest = static_cast<float>(std::max(0.0, value));
    return static_cast<double>(nearest) > value ? std::nextafter(nearest, 0.0f) : nearest;
}

float float_at_least(double value) {
    const float nearest = static_cast<float>(std::max(0.0, value));
    return static_cast<double>(nearest) < value ? std::nextafter(nearest, std::numeric_limits<float>::infinity())
                                                : nearest;
}

// Raises the half extent along axis k to the least float that holds the point too. That float depends on the point
// alone, so the largest over all points is the same in any order.
void grow(Obb& box, const Slabs& slabs, int k, const glm::dvec3& p) {
    float& half = box.half_extents[k];
    const Distance distance(slabs.normals[k], p - box.center);
    if (distance.value + distance.error_bound <= static_cast<double>(half) * (slabs.determinant * (1.0 - kScaleError)))
        return;
    const auto holds = [&](float candidate) {
        half = candidate;
        return contains_along(box, p, k);
    };
    float least = half;  // does not hold the point
    if (holds(least)) return;
    const float certain =
        float_below((distance.value - distance.error_bound) / slabs.determinant * (1.0 - kScaleError));
    float enough = float_at_least((distance.value + distance.error_bound) / slabs.determinant * (1.0 + kScaleError));
    if (certain > least) {
        if (holds(certain)) return;  // nothing less can
        least = certain;
    }
    // The error bound leaves out underflow, which costs a step or two.
    while (!holds(enough)) {
        least = enough;
        enough = std::nextafter(enough, std::numeric_limits<float>::infinity());
    }
    // Floats that are not negative have the order of their bits.
    std::uint32_t low = std::bit_cast<std::uint32_t>(least), high = std::bit_cast<std::uint32_t>(enough);
    while (high - low > 1) {
        const std::uint32_t middle = low + (high - low) / 2;
        (holds(std::bit_cast<float>(middle)) ? high : low) = middle;
    }
    half = std::bit_cast<float>(high);
}

glm::dvec3 center_of(const PointCloud& cloud, const glm::mat3& axes, const Slabs& slabs, const glm::dvec3& low,
                     const glm::dvec3& high) {
    return cloud.origin() + glm::dmat3(axes) * ((low + (high - low) * 0.5) / slabs.determinant);
}

}  // namespace

Obb enclose(PointCloud& cloud, const glm::mat3& axes) {
    const Slabs slabs(axes);
    Obb box;
    box.axes = axes;
    glm::dvec3 low, high, length;
    glm::dmat3 directions;
    for (int k = 0; k < 3; ++k) {
        length[k] = glm::length(slabs.normals[k]);
        directions[k] = slabs.normals[k] / length[k];
    }
    const Supports supports = cloud.supports(directions);
    for (int k = 0; k < 3; ++k) {
        high[k] = glm::dot(slabs.normals[k], supports[static_cast<std::size_t>(2 * k)]) * cloud.unit();
        low[k] = glm::dot(slabs.normals[k], supports[static_cast<std::size_t>(2 * k + 1)]) * cloud.unit();
    }
    box.center = center_of(cloud, axes, slabs, low, high);
    // From a float that is not too large, grow as exact tests demand. High and low come from normalised coordinates, at
    // most 1 in magnitude: each is off by less than 6 units of |normal|_1, and half their difference likewise.
    glm::dvec3 limit;
    for (int k = 0; k < 3; ++k) {
        const glm::dvec3 normal = glm::abs(slabs.normals[k]);
        const double error_bound = 8.0 * kUnit * (normal.x + normal.y + normal.z) * cloud.unit();
        const double half = ((high[k] - low[k]) * 0.5 - error_bound) / slabs.determinant;
        box.half_extents[k] = float_below(half * (1.0 - kScaleError));
        limit[k] = static_cast<double>(box.half_extents[k]) * slabs.determinant / length[k];
    }
    cloud.visit_beyond(directions, box.center, limit, [&](int k, const glm::dvec3& p) { grow(box, slabs, k, p); });
    return box;
}

Obb enclose_small_set(const PointCloud& cloud, const glm::mat3& axes) {
    const Slabs slabs(axes);
    Obb box;
    box.axes = axes;
    glm::dvec3 low, high;
    cloud.slab_extents(slabs.normals, cloud.origin(), low, high);
    box.center = center_of(cloud, axes, slabs, low, high);
    cloud.slab_extents(slabs.normals, box.center, low, high);
    // The error bound of Distance, with the largest of each difference for all points.
    const glm::dvec3 size =
        glm::max(glm::abs(cloud.bounds().max - box.center), glm::abs(cloud.bounds().min - box.center));
    for (int k = 0; k < 3; ++k) {
        float& half = box.half_extents[k];
        const double farthest = std::max(std::abs(low[k]), std::abs(high[k]));
        const double error_bound = 7.0 * kUnit * glm::dot(glm::abs(slabs.normals[k]), size);
        half = float_at_least((farthest - error_bound) / slabs.determinant * (1.0 - kScaleError));
        if (farthest + error_bound <= static_cast<double>(half) * (slabs.determinant * (1.0 - kScaleError))) continue;
        for (std::size_t i = 0; i < cloud.size(); ++i) grow(box, slabs, k, cloud.point(i));
    }
    return box;
}

glm::mat3 rounded(const glm::dmat3& axes, const glm::dvec3& edges, const Weights& weights, double tolerance) {
    constexpr int kUnits = 4;
    constexpr float kUnitInLast = 0x1p-24f;
    glm::mat3 result(axes);
    const double value = weights(edges.x, edges.y, edges.z);
    for (int i = 0; i < 3; ++i) {
        // Returns what the criterion gains by a tilt of axis i towards the others: edge i, times the tilt, widens them.
        const auto cost = [&](const glm::vec3& a) {
            double sum = 0.0;
            for (int k = 0; k < 3; ++k)
                if (k != i)
                    sum += weights.slope(edges[(k + 1) % 3], edges[(k + 2) % 3]) *
                           std::abs(glm::dot(axes[k], glm::dvec3(a)));
            return sum * edges[i];
        };
        const glm::vec3 nearest = result[i];
        double best = cost(nearest);
        if (best <= tolerance * value) continue;
        for (int x = -kUnits; x <= kUnits; ++x)
            for (int y = -kUnits; y <= kUnits; ++y)
                for (int z = -kUnits; z <= kUnits; ++z) {
                    const glm::vec3 a = nearest + kUnitInLast * glm::vec3(static_cast<float>(x), static_cast<float>(y),
                                                                          static_cast<float>(z));
                    if (const double tilted = cost(a); tilted < best) {
                        best = tilted;
                        result[i] = a;
                    }
                }
    }
    return result;
}

}  // namespace crofton::fit
