// SPDX-License-Identifier: MIT
// Proofs, checked in exact arithmetic, that a bound and a frustum meet or do not: the judge of `crofton verify cull`.
#pragma once
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/geometry/shapes.hpp>
#include <cstdint>

namespace crofton::cli {

enum class Proof : std::uint8_t { meets, disjoint, none };

// A common point, or a sum of half-spaces, with factors ≥ 0, that excludes the whole bound. Both are guessed in
// floating point; whether they prove anything is decided exactly: of boxes by tests/oracle/feasible.hpp, of spheres by
// integers of any length where an error bound does not allow floating point. Returns `none` if no guess proves
// anything: for bounds that touch to within rounding.
[[nodiscard]] Proof prove(const Frustum& frustum, const Obb& box);
[[nodiscard]] Proof prove(const Frustum& frustum, const Aabb& box);
[[nodiscard]] Proof prove(const Frustum& frustum, const Sphere& sphere);

}  // namespace crofton::cli
