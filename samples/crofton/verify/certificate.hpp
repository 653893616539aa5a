// SPDX-License-Identifier: MIT
// Proofs, checked in exact arithmetic, that a bound and a frustum meet or do not: the judge of `crofton verify cull`.
#pragma once
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/geometry/shapes.hpp>
#include <cstdint>

namespace crofton::cli {

enum class Proof : std::uint8_t { meets, disjoint, none };

// By the oracles of the tests: tests/oracle/feasible.hpp for boxes, sphere_verdict.hpp for spheres. Returns `none` for
// boxes that touch to within rounding.
[[nodiscard]] Proof prove(const Frustum& frustum, const Obb& box);
[[nodiscard]] Proof prove(const Frustum& frustum, const Aabb& box);
[[nodiscard]] Proof prove(const Frustum& frustum, const Sphere& sphere);

}  // namespace crofton::cli
