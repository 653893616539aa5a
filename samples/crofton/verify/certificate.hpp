// SPDX-License-Identifier: MIT
// Proofs, checked in exact arithmetic, that a bound and a frustum meet or do not: the judge of `crofton verify cull`.
#pragma once
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/geometry/shapes.hpp>
#include <cstdint>

namespace crofton::cli {

enum class Proof : std::uint8_t { meets, disjoint, none };

// A point of the bound that lies in all half-spaces, or a sum of half-spaces, with factors ≥ 0, that excludes the whole
// bound. The point and the factors are guessed in floating point, in the end by trying all vertices; whether they prove
// anything is decided exactly: in floating point where an error bound allows it, else by arithmetic on integers of any
// length. `none` where no guess proves anything: bounds that
// touch to within rounding.
[[nodiscard]] Proof prove(const Frustum& frustum, const Obb& box);
[[nodiscard]] Proof prove(const Frustum& frustum, const Aabb& box);
[[nodiscard]] Proof prove(const Frustum& frustum, const Sphere& sphere);

}  // namespace crofton::cli
