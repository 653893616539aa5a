// SPDX-License-Identifier: MIT
// Filters that test shapes and rays against the sixteen children of a BoxTree node, or the sixteen boxes of a leaf.
// They reject nothing that overlaps.
#pragma once
#include <crofton/boxtree/layout.hpp>
#include <cstdint>

namespace crofton::collide {

// A ray relative to a node's or leaf's origin; parameters are distances.
struct LaneRay {
    float origin[3];
    float inverse[3];  // of the unit direction's components; finite
    float limit;
    float slack = 0.0f;  // 2^20 times what the position may be off by, along an axis, beside its rounding to float
    float wide[3] = {};  // half the size of a box that moves along the ray
};

// An axis-aligned box relative to a node's or leaf's origin.
struct LaneBox {
    float low[3], high[3];
};

// A bit for every lane whose axis-aligned bounds the ray may meet within its limit, and where it enters those at the
// earliest.
[[nodiscard]] std::uint32_t lanes_along(const boxtree::Node& node, const LaneRay& ray, float* entry);
[[nodiscard]] std::uint32_t lanes_along(const boxtree::Leaf& leaf, const LaneRay& ray, float* entry);

// A bit for every lane whose axis-aligned bounds may be within the limit of the box, and the least that its distance
// may be.
[[nodiscard]] std::uint32_t lanes_near(const boxtree::Node& node, const LaneBox& box, float limit, float* gaps);
[[nodiscard]] std::uint32_t lanes_near(const boxtree::Leaf& leaf, const LaneBox& box, float limit, float* gaps);

// A bit for every lane whose axis-aligned bounds may meet the box.
[[nodiscard]] std::uint32_t lanes_within(const boxtree::Node& node, const LaneBox& box);
[[nodiscard]] std::uint32_t lanes_within(const boxtree::Leaf& leaf, const LaneBox& box);

}  // namespace crofton::collide
