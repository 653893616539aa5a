// SPDX-License-Identifier: MIT
// The slow, obvious answers that `crofton frames --verify` holds the engine against: every triangle clipped, every pair
// tested, in double, sharing no code with the engine's queries.
#pragma once
#include <array>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/camera.hpp>
#include <cstdint>
#include <span>

namespace crofton::pipeline {

// `unclear`: the answer hangs on less than the rounding of double arithmetic; either verdict of an exact test may then
// be right.
enum class Truth : std::uint8_t { no, yes, unclear };

struct BodyTruth {
    Truth meets = Truth::no;      // the body shares a point with the frustum
    Truth contained = Truth::no;  // all of the body lies in the frustum
};

// Clips the triangle (or any convex polygon of up to 8 points) against the planes, once grown and once shrunk by the
// rounding.
[[nodiscard]] BodyTruth clip_polygon(const Frustum& frustum, std::span<const glm::dvec3> polygon);

// Six faces clipped; a box whose surface misses the frustum meets it iff it contains `interior`, a point inside the
// frustum.
[[nodiscard]] BodyTruth clip_box(const Frustum& frustum, const Obb& box, const glm::dvec3& interior);

// Sphere against each plane in turn, which is how spheres are culled everywhere: near the frustum's edges a sphere
// outside may pass.
[[nodiscard]] BodyTruth clip_sphere(const Frustum& frustum, const glm::dvec3& center, double radius);

// The fifteen separating axes, one after another.
[[nodiscard]] Truth boxes_meet(const Obb& a, const Obb& b);

}  // namespace crofton::pipeline
