// SPDX-License-Identifier: MIT
// Whether a cast begins as a slide.
#pragma once
#include <crofton/convex/query.hpp>
#include <span>

namespace crofton::convex {

// Tests whether a shape that moves slides along one of the shapes that it touches at the start and that rest: it does
// not come together with that one, nor with another whose plane the contact lies behind.
[[nodiscard]] bool slides_along(const ShapeAtPose& shape, const Motion& motion, std::span<const ShapeAtPose> touched,
                                const CastOptions& options);

}  // namespace crofton::convex
