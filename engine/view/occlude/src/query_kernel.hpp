// SPDX-License-Identifier: MIT
// Boxes against the buffer, in vectors.
#pragma once
#include <crofton/boxtree/layout.hpp>
#include <cstddef>
#include <cstdint>

namespace crofton::occlude {

struct TileCovers;
struct BodyShadow;

// A view's map in float, and the buffer, as the kernel reads them. Forms: column, row, and w (perspective) or z.
struct QueryView {
    double origin[4];  // the last is 0
    float form[3][4];
    float max_abs[3];  // ≥ |form_k| for each k < 3
    float least_w;
    float half_width, half_height;
    std::uint32_t width, height;
    std::uint32_t tile_columns, padded_rows;
    bool perspective;
    const float* pixels;
    const float* least;
    const float* front;
    const TileCovers* covers;
    const BodyShadow* shadows;
};

// Results for up to 64 boxes, a bit each: hidden; wholly outside of the picture (and then not hidden).
struct QueryBits {
    std::uint64_t hidden, outside_picture;
};

// `boxes` is an array of Obb; box i is the one at items[i], or at i where there are no items.
[[nodiscard]] QueryBits query_boxes_kernel(const QueryView& view, const unsigned char* boxes,
                                           const std::uint32_t* items, std::size_t count);

// The same for the children of a tree's node: bit l for the bound of lane l.
struct ChildBits {
    std::uint32_t hidden, outside_picture;
};
[[nodiscard]] ChildBits query_children_kernel(const QueryView& view, const boxtree::Node& node,
                                              const boxtree::Axes& axes);

}  // namespace crofton::occlude
