// SPDX-License-Identifier: MIT
// Does one convex body meet every segment between two others?
#pragma once
#include <array>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/shapes.hpp>
#include <crofton/occlude/occlusion.hpp>
#include <crofton/pvs/pvs.hpp>
#include <cstdint>
#include <optional>

namespace crofton::pvs {

// An opaque convex body: where all planes are at least 0. Relative to a bake's origin.
struct Blocker {
    Vector<Plane> planes;  // unit normals
    Aabb bounds;
    // Proves nothing for eyes in here, and for eyes outside of one of the planes.
    Aabb left_out_within;
    Vector<Plane> eyes;
};

// Returns none for a patch, a flat occluder, or a transform that is not valid.
[[nodiscard]] std::optional<Blocker> blocker_of(const PlacedOccluder& placed, const glm::dvec3& origin);

// The corners of a convex body with eight of them, some of which may be equal.
using Corners = std::array<glm::dvec3, 8>;
[[nodiscard]] Corners corners_of(const Aabb& box);

// True only if the body meets every segment from a point of one hull to a point of the other. For a fixed point q the
// points p whose segments to q meet a convex body are convex themselves. So the 64 segments between corners decide.
// Where it says true, each of them passes deeper than `margin` inside of all planes. The margin is far above the
// rounding of what is computed here. docs/notes/pvs.md has the proof.
[[nodiscard]] bool blocks_all(const Blocker& body, const Corners& eyes, const Corners& object, double margin);

// Whether the body meets the segment from p to q, as deep as that.
[[nodiscard]] bool blocks(const Blocker& body, const glm::dvec3& p, const glm::dvec3& q, double margin);

// Whether the body may prove anything for these eyes; `near_radius` as in ProofOptions.
[[nodiscard]] bool may_prove_for(const Blocker& body, const Aabb& eyes, double near_radius, double margin);

}  // namespace crofton::pvs
