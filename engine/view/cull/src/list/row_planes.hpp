// SPDX-License-Identifier: MIT
// A view's planes in the integers of a chunk's rows.
#pragma once
#include <crofton/cull/list_layout.hpp>

#include "kernel_view.hpp"

namespace crofton::cull {

inline constexpr int kRowNormalBits = 14;

// s(x) = normal · x + offset for a row's integer centre x is within `error_bound` of 2^14 / quantum times the plane's
// exact value at the bound's centre. The row's radius r is 2^-9 larger than the bound's, which covers normals that are
// up to 1.0005 long. So a bound is outside if s + 2^14 r < −error bound, and inside of this plane if s − 2^14 r ≥ error
// bound.
struct RowPlanes {
    std::uint32_t normal_xy[KernelView::kMaxPlanes];  // as RowBlock::xy
    std::uint32_t normal_z[KernelView::kMaxPlanes];   // upper half 0
    std::int32_t offset[KernelView::kMaxPlanes];
    std::uint32_t count;
    std::int32_t error_bound;  // the largest of the planes
    std::uint32_t planes;      // those above as bits of the view's: all but those that the whole chunk is inside of
    bool outside;              // the whole chunk, of one plane
    bool useless;              // the integers are too coarse here to say anything
};

}  // namespace crofton::cull
