#include "enclose.hpp"

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

namespace crofton::fit {
namespace {

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

// True if the filter proves |dot(normal, d)| ≤ half · determinant. d = p − c and every factor and product below is
// rounded once, sums twice: |error| ≤ 6 units of Σ|normal_i d_i|.
bool surely_inside(const glm::dvec3& normal, const glm::dvec3& d, double half, double determinant) {
    const double x = normal.x * d.x, y = normal.y * d.y, z = normal.z * d.z;
    const double magnitude = std::abs(x) + std::abs(y) + std::abs(z);
    return std::abs(x + y + z) + 6.5 * kUnit * magnitude <= half * (determinant * (1.0 - 20.0 * kUnit));
}

float float_below(double value) {
    const float nearest = static_cast<float>(value);
    return static_cast<double>(nearest) > value ? std::nextafter(nearest, 0.0f) : nearest;
}

float float_at_least(double value) {
    const float nearest = static_cast<float>(std::max(0.0, value));
    return static_cast<double>(nearest) < value ? std::nextafter(nearest, std::numeric_limits<float>::infinity())
                                                : nearest;
}

// Grows the half extent along axis k until the point is inside, by exact tests.
void grow(Obb& box, const Slabs& slabs, int k, const glm::dvec3& p) {
    float& reach = box.half_extents[k];
    const glm::dvec3 normal = slabs.normals[k], d = p - box.center;
    if (surely_inside(normal, d, static_cast<double>(reach), slabs.determinant)) return;
    if (contains_along(box, p, k)) return;
    // The centre's own rounding may ask for more than a few steps.
    const double needed = std::abs(glm::dot(normal, d)) / slabs.determinant;
    reach = std::max(reach, float_below(needed * (1.0 - 1e-12)));
    if (contains_along(box, p, k)) return;
    // Around flat points `needed` may be nothing but rounding, and single steps from zero would take for ever: the
    // bound of surely_inside says how much is enough.
    const glm::dvec3 parts = glm::abs(normal * d);
    const double rounding = 16.0 * kUnit * (parts.x + parts.y + parts.z) / slabs.determinant;
    reach = std::max(reach, float_below(needed + rounding));
    while (!contains_along(box, p, k)) reach = std::nextafter(reach, std::numeric_limits<float>::infinity());
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
    // From just below the least float that can do, grow by single steps as exact tests demand.
    glm::dvec3 limit;
    for (int k = 0; k < 3; ++k) {
        const double half = std::max(0.0, (high[k] - low[k]) * 0.5) / slabs.determinant;
        box.half_extents[k] = float_below(half * (1.0 - 1e-12));
        limit[k] = static_cast<double>(box.half_extents[k]) * slabs.determinant / length[k];
    }
    cloud.visit_beyond(directions, box.center, limit, [&](int k, const glm::dvec3& p) { grow(box, slabs, k, p); });
    return box;
}

Obb enclose_few(const PointCloud& cloud, const glm::mat3& axes) {
    const Slabs slabs(axes);
    Obb box;
    box.axes = axes;
    glm::dvec3 low, high;
    cloud.slab_extents(slabs.normals, cloud.origin(), low, high);
    box.center = center_of(cloud, axes, slabs, low, high);
    cloud.slab_extents(slabs.normals, box.center, low, high);
    // Between which bounds the farthest point lies, by the error that surely_inside derives, with the largest of each
    // difference for all.
    const glm::dvec3 size =
        glm::max(glm::abs(cloud.bounds().max - box.center), glm::abs(cloud.bounds().min - box.center));
    for (int k = 0; k < 3; ++k) {
        float& reach = box.half_extents[k];
        const double farthest = std::max(std::abs(low[k]), std::abs(high[k]));
        const double error = 7.0 * kUnit * glm::dot(glm::abs(slabs.normals[k]), size);
        reach = float_at_least((farthest - error) / slabs.determinant * (1.0 - 24.0 * kUnit));
        if (farthest + error <= static_cast<double>(reach) * (slabs.determinant * (1.0 - 24.0 * kUnit))) continue;
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
        // What the criterion gains by a tilt of axis i towards the others: edge i, times the tilt, widens them.
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
