// SPDX-License-Identifier: MIT
// Whether a box contains the image of a point under an affine map, decided exactly.
#pragma once
#include <array>
#include <crofton/geometry/expansion.hpp>
#include <crofton/geometry/transform.hpp>

namespace crofton::testing {

// Whether linear·v + translation, taken in reals, lies in the box: the exact image is the sum of doubles below, and the
// box is the set of |det(d, a_i, a_j)| ≤ h_k·|det(a)|. Exact in expansions throughout.
inline bool contains_exact_image(const Obb& box, const Transform& t, const glm::dvec3& v) {
    const auto component = [&](int i) {
        return exact_product(t.linear[0][i], v.x) + exact_product(t.linear[1][i], v.y) +
               exact_product(t.linear[2][i], v.z) + (exact(t.translation[i]) - exact(box.center[i]));
    };
    const std::array<decltype(component(0)), 3> d = {component(0), component(1), component(2)};
    const auto cross_component = [&](const glm::dvec3& a, const glm::dvec3& b, int i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        return exact(a[j] * b[k]) - exact(a[k] * b[j]);
    };
    for (int k = 0; k < 3; ++k) {
        const glm::dvec3 a(box.axes[(k + 1) % 3]), b(box.axes[(k + 2) % 3]), c(box.axes[k]);
        const auto nx = cross_component(a, b, 0), ny = cross_component(a, b, 1), nz = cross_component(a, b, 2);
        auto distance = d[0] * nx + d[1] * ny + d[2] * nz;
        auto limit = (nx * c.x + ny * c.y + nz * c.z) * static_cast<double>(box.half_extents[k]);
        if (distance.sign() < 0) distance = -distance;
        if (limit.sign() < 0) limit = -limit;
        if ((distance - limit).sign() > 0) return false;
    }
    return true;
}

}  // namespace crofton::testing
