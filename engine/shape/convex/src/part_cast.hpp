// SPDX-License-Identifier: MIT
// Casts of bodies of parts.
#pragma once
#include "part_query.hpp"

namespace crofton::convex {

// The cast of two convex bodies from the time `start` on, before which they are known not to touch. All is checked.
[[nodiscard]] Impact advance(const BodyAtPose& a, const Motion& motion_a, const BodyAtPose& b, const Motion& motion_b,
                             const CastOptions& options, double start, PairCache* cache);

// The same where a has parts.
[[nodiscard]] Impact cast_parts(const BodyAtPose& a, const Motion& motion_a, const BodyAtPose& b,
                                const Motion& motion_b, const CastOptions& options, double start);

}  // namespace crofton::convex
