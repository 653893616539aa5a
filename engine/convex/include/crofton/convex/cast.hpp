// SPDX-License-Identifier: MIT
// When will two moving bodies first touch?
#pragma once
#include <crofton/convex/query.hpp>

namespace crofton::convex {

// What a body does from its pose on: its `pivot` (in the body's frame: the center of mass) moves by velocity · t, and
// the body turns about it by |spin| · t radians around `spin` (world axes). Zero: it rests. Any number of turns.
struct Motion {
    glm::dvec3 velocity{0.0};
    glm::dvec3 spin{0.0};
    glm::dvec3 pivot{0.0};
};

// Where the body is at time t: the pose whose stored numbers the cast asks about. Angles beyond 1e5 radians are
// refused.
[[nodiscard]] RigidTransform moved(const RigidTransform& pose, const Motion& motion, double time);

struct CastOptions {
    double duration = 1.0;    // ≥ 0, finite
    double tolerance = 1e-6;  // > 0, in lengths: bodies this close have hit
    int max_steps = 500;      // ≥ 1
};

enum class CastResult : std::uint8_t {
    miss,        // proven: the bodies do not touch in [0, duration]
    hit,         // at `time` they are within the tolerance, and at no time before do they touch
    unresolved,  // max_steps were not enough: before `time` they do not touch; later is not known
};
struct Impact {
    CastResult result = CastResult::miss;
    double time = 0.0;       // of a miss: the duration
    glm::dvec3 normal{0.0};  // unit, from a to b, at that time; 0 where they overlap from the start
    glm::dvec3 on_a{0.0}, on_b{0.0};
    double distance = 0.0;
    int steps = 0;
};

// Conservative advancement (Mirtich 1996) by a bound of second order: each step ends before any vertex can have crossed
// the plane that parts the bodies, by its velocity across the plane and a bound of its acceleration. So no wall is too
// thin. "Touch" is said of the bodies as they move in real arithmetic; the rotation is off by 1e-15 a radian, which the
// bounds include. Errors: NaN or infinite motions, a turn beyond 1e5 radians, options out of range, half-spaces turned.
[[nodiscard]] Result<Impact> cast(const Placed& a, const Motion& motion_a, const Placed& b, const Motion& motion_b,
                                  const CastOptions& options = {}, PairCache* cache = nullptr);

}  // namespace crofton::convex
