// SPDX-License-Identifier: MIT
// Bounds along turned axes: a point p is in such a box iff rows[k] · p lies between its ends for each k, in real
// arithmetic.
//
// The loss of precision. Axes are orthonormal to η = 2^-48: |rows[i] · rows[j] − δij| ≤ η. With A of these rows a
// node's integers q stand for p = o + Aᵀq. Then A p = A o + q + (A Aᵀ − I) q is within 3 η |q|₁ of A o + q, and q is as
// near to A (p − o). A product A p of three terms rounds by 3 · 2^-53 |p|₁, a difference by 2^-53 of its result. The
// ends of a bound have a third of |q|₁ at least. So kTurnRounding times the sizes of origin and ends covers it all;
// every bound is moved outward by as much.
#pragma once
#include <crofton/boxtree/layout.hpp>
#include <crofton/geometry/box.hpp>

namespace crofton::boxtree {

inline constexpr double kTurnRounding = 0x1p-44;

// The axes of a box, made orthonormal.
[[nodiscard]] Axes axes_of(const glm::mat3& columns);
[[nodiscard]] bool are_the_worlds(const Axes& axes);
// Do they keep what Axes promises?
[[nodiscard]] bool are_valid(const Axes& axes);
// Are both the same axes to about 0.1°, in any order and of any sign?
[[nodiscard]] bool are_alike(const Axes& a, const Axes& b);

// Bounds along `axes`, rounded outward.
[[nodiscard]] Aabb bounds_along(const Axes& axes, const Obb& box);
[[nodiscard]] Aabb bounds_along(const Axes& axes, const Leaf& leaf);
// The bound of a box that lies along other axes.
[[nodiscard]] Aabb bounds_along(const Axes& axes, const Aabb& box, const Axes& its_axes);

}  // namespace crofton::boxtree
