// SPDX-License-Identifier: MIT
// How much an occluder hides from a region of eyes: a measure to rank occluders by, before any view is known.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/measure/intrinsic_volumes.hpp>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

namespace crofton::occlude {

// From where one looks, and at what.
struct SeenScene {
    Aabb eyes;                         // uniformly distributed in here; may be flat, a segment or a point
    double range = 100.0;              // how far from the eye objects lie
    measure::IntrinsicVolumes object;  // of one object, or the means over all; objects lie and turn uniformly
    std::uint32_t samples = 64;        // of eyes; the same ones in every call
};

// The expected volume of the places in which an object is hidden as a whole by the convex hull of `points`: times the
// number of objects per volume, the expected number of hidden objects. The shadow volume of a body K from an eye is
// the union of the rays' parts from K on, up to `range`: convex, the hull of K and of K scaled from the eye. An object
// of surface F' and mean curvature M' lies in a convex body (V, F, M) with kinematic measure V − F·M'/4π to first
// order: what (1) in theory.md section 2 gives for "meets", with the sign of "contains". What is left out is of second
// order in the object's size. An eye inside the hull sees nothing hidden: 0. Errors: as
// measure::intrinsic_volumes_of_hull; eyes empty or not finite; a range that is not positive and finite; samples of 0.
[[nodiscard]] Result<double> occlusion_worth(std::span<const glm::dvec3> points, const SeenScene& scene);

}  // namespace crofton::occlude
