// SPDX-License-Identifier: MIT
// Casts of shapes of parts.
#pragma once
#include "part_query.hpp"

namespace crofton::convex {

// The cast of two convex shapes from the time `start` on, before which they are known not to touch. All is checked.
[[nodiscard]] Impact advance(const ShapeAtPose& a, const Motion& motion_a, const ShapeAtPose& b, const Motion& motion_b,
                             const CastOptions& options, double start, PairCache* cache);

// The same where a has parts.
// `slide`, or nullptr, knows what is no hit. `flipped`: its shapes come in the other order.
class ContactsAt;
[[nodiscard]] Impact cast_parts(const ShapeAtPose& a, const Motion& motion_a, const ShapeAtPose& b,
                                const Motion& motion_b, const CastOptions& options, double start,
                                const ContactsAt* slide, bool flipped);

}  // namespace crofton::convex
