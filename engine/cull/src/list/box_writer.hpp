// Boxes into the rows and records of a list, in vectors, sixteen at a time.
#pragma once
#include <crofton/cull/list_layout.hpp>
#include <crofton/geometry/obb.hpp>
#include <cstddef>
#include <cstdint>

namespace crofton::cull {

// `boxes` into the rows and records of a chunk whose frame is chosen; its extent, reach and strays become theirs. Rows
// of boxes that vectors cannot take say nothing, and their indices go to `left`, which has room for all; returns how
// many. All that validate(Obb) refuses are among them.
std::size_t write_boxes(const Obb* boxes, std::size_t count, ListChunk& chunk, RowBlock* rows, BoxRecord* records,
                        std::uint32_t* left);

// The same for boxes[i] with i in `items`, at most kWriteBatch of them, in whatever chunks; extents and reach only
// grow. Those that are left stay as they were.
inline constexpr std::size_t kWriteBatch = 256;
std::size_t write_boxes(const Obb* boxes, const std::uint32_t* items, std::size_t count, ListChunk* chunks,
                        RowBlock* rows, BoxRecord* records, std::uint32_t* left);

}  // namespace crofton::cull
