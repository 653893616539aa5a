// SPDX-License-Identifier: MIT
// Overlap of a box with a sphere or a capsule.
#include <cmath>
#include <crofton/collide/bound_contacts.hpp>
#include <crofton/geometry/finite.hpp>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace crofton::collide {
namespace {

// Whether a sphere meets a box, where two bounds of the distance d between its centre p and the box tell. From above:
// the point q that is nearest if the axes are orthonormal lies in the box, so d ≤ |p − q|. From below: for the unit
// vector n along p − q, d ≥ dot(n, p) − Σ h_k |dot(n, a_k)|. Each is summed from fewer than 20 roundings of 2^-53 of
// `size`.
enum class Verdict : std::uint8_t { apart, meets, open };
Verdict sphere_meets(const Obb& box, const Sphere& sphere) {
    const glm::dvec3 p = sphere.center - box.center;
    glm::dvec3 q(0.0);
    double size = std::abs(p.x) + std::abs(p.y) + std::abs(p.z) + sphere.radius;
    for (int k = 0; k < 3; ++k) {
        const glm::dvec3 axis(box.axes[k]);
        const double half = static_cast<double>(box.half_extents[k]);
        q += glm::clamp(glm::dot(axis, p), -half, half) * axis;
        size += half;
    }
    const double error_bound = 1e-14 * size, above = glm::length(p - q);
    if (above < sphere.radius - error_bound) return Verdict::meets;
    if (!(above > sphere.radius + error_bound)) return Verdict::open;
    const glm::dvec3 n = (p - q) / above;
    double below = glm::dot(n, p);
    for (int k = 0; k < 3; ++k)
        below -= static_cast<double>(box.half_extents[k]) * std::abs(glm::dot(n, glm::dvec3(box.axes[k])));
    return below > sphere.radius + error_bound ? Verdict::apart : Verdict::open;
}

}  // namespace

bool intersects(const Obb& box, const Sphere& sphere) {
    if (!is_in_range(sphere) || !validate(box)) return false;
    if (const Verdict verdict = sphere_meets(box, sphere); verdict != Verdict::open) return verdict == Verdict::meets;
    return distance(box, Capsule{sphere.center, sphere.center, sphere.radius}).distance <= 0.0;
}

bool intersects(const Obb& box, const Capsule& capsule) {
    if (!is_in_range(capsule.begin) || !is_in_range(Sphere{capsule.end, capsule.radius}) || !validate(box))
        return false;
    // A segment is a triangle without area: its core is decided exactly.
    if (intersects(box, Triangle{capsule.begin, capsule.end, capsule.end})) return true;
    return distance(box, capsule).distance <= 0.0;
}

}  // namespace crofton::collide
