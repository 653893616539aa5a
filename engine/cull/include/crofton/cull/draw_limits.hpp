// SPDX-License-Identifier: MIT
// What is not worth drawing: too small in the picture, or too far away.
#pragma once
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/core/error.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/camera.hpp>
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <span>

namespace crofton::cull {

// An item's radius r is half its box's diagonal, √(h₀² + h₁² + h₂²) of its half extents; its distance d is that of its
// box's centre from `eye`. The item is dropped if d > radii · r, if d > item_distances[id], if r < least_radius, or if
// d > layer_distances[l] for every layer l that it shares with the view. All of it exactly, for the stored numbers
// taken as reals; on a limit it is kept. Limits that are not finite or beyond 1e30 do not count, nor do any for a box
// or an eye that is not finite. Negative ones are 0.
struct DrawLimits {
    static constexpr double kNone = std::numeric_limits<double>::infinity();
    glm::dvec3 eye{0.0};  // of the camera whose picture counts: for its shadows' views too
    double radii = kNone;
    double least_radius = 0.0;
    std::span<const float> layer_distances = {};  // 32, or none
    std::span<const float> item_distances = {};   // one per item id, or none
    // Hysteresis: for items whose bit is set (id % 64 of word id / 64; beyond the end none is) distances are `longer`
    // times as long and least_radius as much smaller. Give the last frame's visible items (to_bits), and what goes in
    // and out at a limit flickers no more. Requires longer ≥ 1.
    std::span<const std::uint64_t> drawn_before = {};
    double longer = 1.0;
};

// Drops what is below `pixels` in a picture `picture_height` pixels high. In perspective: items around which the ball
// of radius r, seen from its distance in the middle of the picture, has a diameter of less than `pixels`; a ball
// elsewhere in the picture is drawn larger, and is judged as if in its middle. Orthographic: items whose 2 r is less.
// Up to rounding of `radii` or `least_radius` by 2^-50. Errors: as validate(Camera); a height or size that is not
// positive and finite.
[[nodiscard]] Result<DrawLimits> limits_of(const Camera& camera, double picture_height, double pixels);

// The test of one item, in these layers of it that the view sees.
[[nodiscard]] bool is_worth_drawing(const DrawLimits& limits, const Obb& box, boxtree::ItemId item,
                                    std::uint32_t common_layers = ~std::uint32_t{0});

}  // namespace crofton::cull
