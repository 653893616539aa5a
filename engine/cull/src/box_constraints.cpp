#include "box_constraints.hpp"

#include <cmath>

namespace crofton::cull {
namespace {

bool within(const glm::dvec3& v, double limit) {
    return std::fabs(v.x) <= limit && std::fabs(v.y) <= limit && std::fabs(v.z) <= limit;
}

glm::dvec3 half_edge(const Obb& box, int k) {
    return glm::dvec3(box.axes[k]) * static_cast<double>(box.half_extents[k]);
}

int exact_corner_sign(const Plane& plane, const glm::dvec3& origin, const Obb& box, bool innermost) {
    Dyadic sum = exact_entry(plane, origin, box, 3);
    for (unsigned k = 0; k < 3; ++k) {
        const Dyadic reach = abs(exact_entry(plane, origin, box, k));
        sum = innermost ? sum + reach : sum - reach;
    }
    return sum.sign();
}

}  // namespace

double Constraint::reach() const {
    return std::fabs(slope[0]) + std::fabs(slope[1]) + std::fabs(slope[2]);
}

Constraint constraint_of(const Plane& plane, const glm::dvec3& origin, const Obb& box) {
    const glm::dvec3& n = plane.normal;
    Constraint result;
    for (int k = 0; k < 3; ++k) {
        const glm::dvec3 edge = half_edge(box, k);
        const double x = n.x * edge.x, y = n.y * edge.y, z = n.z * edge.z;
        result.slope[k] = x + y + z;
        result.slope_size[k] = std::fabs(x) + std::fabs(y) + std::fabs(z);
    }
    const glm::dvec3 d = box.center - origin;
    const double x = n.x * d.x, y = n.y * d.y, z = n.z * d.z;
    result.base = x + y + z + plane.offset;
    result.base_size = std::fabs(x) + std::fabs(y) + std::fabs(z) + std::fabs(plane.offset);
    return result;
}

Dyadic exact_entry(const Plane& plane, const glm::dvec3& origin, const Obb& box, unsigned k) {
    Dyadic sum = k == 3 ? Dyadic(plane.offset) : Dyadic();
    for (int j = 0; j < 3; ++j) {
        const Dyadic factor =
            k == 3 ? Dyadic(box.center[j]) - Dyadic(origin[j]) : Dyadic(half_edge(box, static_cast<int>(k))[j]);
        sum = sum + Dyadic(plane.normal[j]) * factor;
    }
    return sum;
}

int innermost_sign(const Constraint& constraint, const Plane& plane, const glm::dvec3& origin, const Obb& box) {
    const double value = constraint.base + constraint.reach();
    const double bound = 12.0 * kUnit * constraint.size() + kTiny;
    if (value > bound) return 1;
    if (value < -bound) return -1;
    return exact_corner_sign(plane, origin, box, true);
}

int outermost_sign(const Constraint& constraint, const Plane& plane, const glm::dvec3& origin, const Obb& box) {
    const double value = constraint.base - constraint.reach();
    const double bound = 12.0 * kUnit * constraint.size() + kTiny;
    if (value > bound) return 1;
    if (value < -bound) return -1;
    return exact_corner_sign(plane, origin, box, false);
}

bool is_usable(const Obb& box) {
    if (!within(box.center, kMaxCoordinate) || !within(glm::dvec3(box.half_extents), kMaxCoordinate)) return false;
    for (int k = 0; k < 3; ++k)
        if (!within(glm::dvec3(box.axes[k]), 2.0)) return false;
    return true;
}

bool is_usable(const Frustum& frustum) {
    if (!within(frustum.origin, kMaxCoordinate)) return false;
    for (const Plane& plane : frustum.view())
        if (!within(plane.normal, 2.0) || !(std::fabs(plane.offset) <= 1e50)) return false;
    return true;
}

}  // namespace crofton::cull
