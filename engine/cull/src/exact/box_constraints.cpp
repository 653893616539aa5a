// SPDX-License-Identifier: MIT
#include "exact/box_constraints.hpp"

namespace crofton::cull {
namespace {

bool within(const glm::dvec3& v, double limit) {
    return std::fabs(v.x) <= limit && std::fabs(v.y) <= limit && std::fabs(v.z) <= limit;
}

}  // namespace

Dyadic exact_entry(const Plane& plane, const glm::dvec3& origin, const Obb& box, unsigned k) {
    Dyadic sum = k == 3 ? Dyadic(plane.offset) : Dyadic();
    for (int j = 0; j < 3; ++j) {
        const Dyadic factor =
            k == 3 ? Dyadic(box.center[j]) - Dyadic(origin[j]) : Dyadic(half_edge(box, static_cast<int>(k))[j]);
        sum = sum + Dyadic(plane.normal[j]) * factor;
    }
    return sum;
}

Dyadic exact_entry(const Plane& plane, const glm::dvec3& origin, const Aabb& box, unsigned k) {
    const auto axis = static_cast<int>(k);
    if (k < 3) return Dyadic(plane.normal[axis]) * (Dyadic(box.max[axis]) - Dyadic(box.min[axis]));
    Dyadic sum = Dyadic(plane.offset) + Dyadic(plane.offset);
    for (int j = 0; j < 3; ++j) {
        const Dyadic start(origin[j]);
        sum = sum + Dyadic(plane.normal[j]) * ((Dyadic(box.min[j]) - start) + (Dyadic(box.max[j]) - start));
    }
    return sum;
}

bool is_usable(const Obb& box) {
    if (!within(box.center, kMaxCoordinate) || !within(glm::dvec3(box.half_extents), kMaxCoordinate)) return false;
    for (int k = 0; k < 3; ++k)
        if (!within(glm::dvec3(box.axes[k]), 2.0)) return false;
    return true;
}

bool is_usable(const Aabb& box) {
    return !box.is_empty() && within(box.min, kMaxCoordinate) && within(box.max, kMaxCoordinate);
}

bool is_usable(const Sphere& sphere) {
    return within(sphere.center, kMaxCoordinate) && sphere.radius >= 0.0 && sphere.radius <= kMaxCoordinate;
}

bool is_usable(const Frustum& frustum) {
    if (!within(frustum.origin, kMaxCoordinate)) return false;
    for (const Plane& plane : frustum.view())
        if (!within(plane.normal, 2.0) || !(std::fabs(plane.offset) <= 1e50)) return false;
    return true;
}

bool has_unit_normals(const Frustum& frustum) {
    for (const Plane& plane : frustum.view()) {
        const glm::dvec3& n = plane.normal;
        if (std::fabs(n.x * n.x + n.y * n.y + n.z * n.z - 1.0) > 1e-3) return false;
    }
    return true;
}

}  // namespace crofton::cull
