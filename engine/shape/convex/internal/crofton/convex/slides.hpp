// SPDX-License-Identifier: MIT
// Tells whether a cast begins as a slide, and what it lands on.
#pragma once
#include <crofton/convex/query.hpp>
#include <optional>
#include <span>

namespace crofton::convex {

// Tests whether a shape that moves slides along one of the shapes that it touches at the start and that rest: it does
// not come together with that one, nor with another whose plane the contact lies behind.
[[nodiscard]] bool slides_along(const ShapeAtPose& shape, const Motion& motion, std::span<const ShapeAtPose> touched,
                                const CastOptions& options);

// If a shape touches an object that rests, and others beside it, over a crack between them that is no wider than
// rounding: its touch with the face that would be there without the crack, if it comes together with that.
[[nodiscard]] std::optional<Impact> touch_over_crack(const ShapeAtPose& shape, const Motion& motion,
                                                     const ShapeAtPose& object, std::span<const ShapeAtPose> touched,
                                                     const CastOptions& options);

}  // namespace crofton::convex
