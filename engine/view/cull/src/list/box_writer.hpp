// SPDX-License-Identifier: MIT
// Boxes into the rows and records of a list, in vectors, sixteen at a time.
#pragma once
#include <crofton/cull/list_layout.hpp>
#include <crofton/geometry/box.hpp>
#include <cstddef>
#include <cstdint>
#include <span>

namespace crofton::cull {

// Writes `boxes` as the rows and records of a chunk whose frame is chosen, and sets the chunk's extent, L1 radius and
// count of boxes out of frame from them. A box that the kernel cannot take gets an empty row, and its index is appended
// to `rejected`, which has room for all. Every box that validate(Obb) refuses is rejected. Returns how many are.
std::size_t write_boxes(const Obb* boxes, std::size_t count, ListChunk& chunk, RowBlock* rows, BoxRecord* records,
                        std::uint32_t* rejected);

// The same for boxes[i] with i in `items`, at most kWriteBatch of them, in any chunks. Extents and L1 radii only grow.
// The rows and records of rejected boxes stay as they were.
inline constexpr std::size_t kWriteBatch = 256;
std::size_t write_boxes(const Obb* boxes, const std::uint32_t* items, std::size_t count, ListChunk* chunks,
                        RowBlock* rows, BoxRecord* records, std::uint32_t* rejected);

// Boxes `stride` bytes apart: the k-th is item items[k]'s, in any chunk. Stops before the first that write_boxes()
// would reject, and returns how many it has written. `in_order`: the items are one after the other. Extents and L1
// radii only grow; boxes out of frame are not counted.
//
// `before`, if given, are boxes by item; `differs` then has a byte for each item, which is set to 1 if its box differs
// from that before, bit for bit, else to 0. `shapes` has one for each block of sixteen items. kShapesWritten: the
// block's rows and records were written by this function, in the frames of `chunks`, from boxes with the axes and half
// extents of `before`, so that only centres are written where these stay. kShapesStay: the last boxes have them too.
inline constexpr std::uint8_t kShapesWritten = 1, kShapesStay = 2;
std::size_t write_strided_boxes(const Obb* first, std::size_t stride, std::span<const std::uint32_t> items,
                                bool in_order, ListChunk* chunks, RowBlock* rows, BoxRecord* records, const Obb* before,
                                std::uint8_t* shapes, std::uint8_t* differs);

}  // namespace crofton::cull
