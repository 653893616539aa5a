// SPDX-License-Identifier: MIT
#include "exact/box_constraints.hpp"

#include <crofton/geometry/finite.hpp>

namespace crofton::cull {
namespace {

// As unit vectors are, with much to spare.
bool is_short(const glm::dvec3& v) {
    return std::fabs(v.x) <= 2.0 && std::fabs(v.y) <= 2.0 && std::fabs(v.z) <= 2.0;
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
    if (!is_in_range(box.center) || !is_in_range(glm::dvec3(box.half_extents))) return false;
    for (int k = 0; k < 3; ++k)
        if (!is_short(glm::dvec3(box.axes[k]))) return false;
    return true;
}

bool is_usable(const Aabb& box) {
    return !box.is_empty() && is_in_range(box);
}

bool is_usable(const Sphere& sphere) {
    return is_in_range(sphere);
}

bool is_usable(const Frustum& frustum) {
    if (!is_in_range(frustum.origin)) return false;
    for (const Plane& plane : frustum.view())
        if (!is_short(plane.normal) || !(std::fabs(plane.offset) <= 1e50)) return false;
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
