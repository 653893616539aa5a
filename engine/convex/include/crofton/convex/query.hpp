// SPDX-License-Identifier: MIT
// Do two convex bodies meet, how far apart are they, how deep do they overlap?
#pragma once
#include <crofton/convex/body.hpp>
#include <cstdint>

namespace crofton::convex {

// A body where it stands: the image of its stored points under the stored pose, all taken as reals. Poses are valid
// and without reflection, as validate_pose tells. Alive for the call only.
struct Placed {
    const Body& body;
    const RigidTransform& pose;
};

// As validate(RigidTransform), and refuses a pose that mirrors: it would turn the body inside out.
[[nodiscard]] Result<void> validate_pose(const RigidTransform& pose, std::uint64_t item = kNoItem);

// What a pair remembers from one call to the next: it makes calls faster and changes no answer of `intersects`. Numbers
// stay within their stated bounds. Zero-initialised for a new pair; belongs to one pair in one order, and to one thread
// at a time.
struct PairCache {
    glm::dvec3 axis{0.0};  // from a to b, where the bodies were last apart or least deep
    std::uint16_t on_a[4] = {}, on_b[4] = {};
    std::uint16_t count = 0;
    // Of a manifold: whose face it lies on, that of a (1) or of b (2), and which.
    std::uint16_t reference = 0, face = 0;
};

// Touching counts. Exact for two polytopes and for a polytope and a half-space. Where a body is round, a gap or overlap
// below 1e-11 of the size, with cylinders and cones 1e-7, may be told either way. The size of a pair is the sum of the
// bodies' reaches and of the offset between their origins. Two half-spaces: exact where the normals' rounded cross
// product is not 0, as they meet then. A pose with NaN meets nothing.
[[nodiscard]] bool intersects(const Placed& a, const Placed& b, PairCache* cache = nullptr);

struct Distance {
    double distance = 0.0;            // between on_a and on_b; 0 iff the bodies meet
    double lower = 0.0, upper = 0.0;  // proven: the true distance lies between
    glm::dvec3 on_a{0.0}, on_b{0.0};  // nearest points; of bodies that meet, a common point up to 1e-9 of the size
    glm::dvec3 normal{0.0};           // unit, from a to b; 0 of bodies that meet
};
// upper − lower ≤ 1e-9 of the size for polytopes, also rounded ones. Gilbert, Johnson,
// Keerthi 1988; where double does not reach the bound, in exact arithmetic. Half-spaces that do not meet: parallel
// ones.
[[nodiscard]] Distance distance(const Placed& a, const Placed& b, PairCache* cache = nullptr);

// The shortest motion of b that ends the overlap: depth · normal.
struct Penetration {
    bool overlapping = false;  // as `intersects`; all else is 0 where it is not
    double depth = 0.0;
    double lower = 0.0, upper = 0.0;  // proven: the true depth lies between
    glm::dvec3 normal{0.0};           // unit, from a to b
    glm::dvec3 on_a{0.0}, on_b{0.0};  // deepest points: on_a − on_b = depth · normal
};
// upper − lower ≤ 1e-9 of the size for polytopes, also rounded ones; 1e-5 for cylinders and cones. Expanding polytope
// (van den Bergen 2001), checked afterwards from both sides; where that fails, all separating axes. Two half-spaces
// overlap without end: depth, lower and upper are infinite.
[[nodiscard]] Penetration penetration(const Placed& a, const Placed& b, PairCache* cache = nullptr);

// From a point (in the world) to the body: a is the point.
[[nodiscard]] Distance closest_point(const Placed& body, const glm::dvec3& point);

}  // namespace crofton::convex
