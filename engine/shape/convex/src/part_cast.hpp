// SPDX-License-Identifier: MIT
// Casts of bodies of parts.
#pragma once
#include "part_query.hpp"

namespace crofton::convex {

// The cast of two convex bodies from the time `start` on, before which they are known not to touch. All is checked.
[[nodiscard]] Impact advance(const BodyAtPose& a, const Motion& motion_a, const BodyAtPose& b, const Motion& motion_b,
                             const CastOptions& options, double start, PairCache* cache);

// The same where a has parts.
// `slide`, or nullptr, knows what is no hit. `flipped`: its bodies come in the other order.
class ContactsAt;
[[nodiscard]] Impact cast_parts(const BodyAtPose& a, const Motion& motion_a, const BodyAtPose& b,
                                const Motion& motion_b, const CastOptions& options, double start,
                                const ContactsAt* slide, bool flipped);

}  // namespace crofton::convex
