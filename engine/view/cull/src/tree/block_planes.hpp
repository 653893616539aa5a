// SPDX-License-Identifier: MIT
// A view's planes in the integers of a tree's nodes and leaves.
#pragma once
#include <algorithm>
#include <bit>
#include <crofton/boxtree/layout.hpp>

#include "kernel_view.hpp"

namespace crofton::cull {

// In units of 2^-14 of the block's unit. A plane's value at integers x of the block is offset + pair_plane · x.
// `error_bound` bounds the error of that, with a box's projected radius added or taken away (boxtree::rounding_of).
struct BlockPlane {
    std::int32_t offset, error_bound;
};

inline std::uint32_t all_planes(const KernelView& view) {
    return (1u << view.plane_count) - 1;
}

// For the blocks of a tree, whose root node has this origin and radius. The offset's seven roundings of 2^-53 of
// Σ|origin − view| + |plane offset| each, as in local_plane, for any block whose origin lies in the root's bounds. It
// may lie farther out by less than the block's L1 radius: the share of that in `rounding` has room for it.
inline void bring_before(const double* root_origin, float root_l1_radius, std::uint32_t planes, const KernelView& view,
                         ViewPlace& place) {
    const LocalOrigin at = local_origin(place, root_origin, root_l1_radius);
    for (std::uint32_t rest = planes; rest; rest &= rest - 1) {
        const auto i = static_cast<std::uint32_t>(std::countr_zero(rest));
        place.far[i] = 0x1p-49 * (at.size + at.l1_radius + std::fabs(view.planes[i].offset));
    }
}

inline void bring_before(const double* root_origin, float root_l1_radius, KernelView& view) {
    bring_before(root_origin, root_l1_radius, all_planes(view), view, view);
}

inline constexpr double kMostOffset = 1.2e9;

inline double value_at(const KernelView& view, const ViewPlace& place, std::size_t i, const double* origin) {
    const KernelPlane& plane = view.planes[i];
    return plane.normal[0] * (origin[0] - place.origin[0]) + plane.normal[1] * (origin[1] - place.origin[1]) +
           plane.normal[2] * (origin[2] - place.origin[2]) + plane.offset;
}

// In the block's units, not yet integers.
struct ScaledPlane {
    double offset, error_bound;
};
template <class Block>
ScaledPlane scaled_plane(const KernelView& view, const ViewPlace& place, std::size_t i, const Block& block) {
    const double per_quantum = static_cast<double>(block.per_quantum);
    return {value_at(view, place, i, block.origin) * per_quantum,
            (static_cast<double>(block.rounding) + place.far[i]) * per_quantum};
}

// Offsets are clamped where the sums, |offset| + 2^14 · 1.0005 · √3 · 32767, would leave 32 bits. A clamped offset is
// nearer to 0 than the true one: a block that it finds certainly inside or outside is so.
inline BlockPlane block_plane(const KernelView& view, const ViewPlace& place, std::size_t i,
                              const boxtree::Node& node) {
    const ScaledPlane plane = scaled_plane(view, place, i, node);
    return {static_cast<std::int32_t>(std::max(-kMostOffset, std::min(kMostOffset, plane.offset))),
            static_cast<std::int32_t>(std::min(0x7fffffff * 1.0, plane.error_bound))};  // NaN decides nothing
}

// A leaf's plane must not claim a cut that is not certain. So a plane whose offset does not fit decides nothing.
inline BlockPlane block_plane(const KernelView& view, const ViewPlace& place, std::size_t i,
                              const boxtree::Leaf& leaf) {
    const ScaledPlane plane = scaled_plane(view, place, i, leaf);
    if (!(std::fabs(plane.offset) <= kMostOffset && plane.error_bound <= kMostOffset)) return {0, 0x7fffffff};
    return {static_cast<std::int32_t>(plane.offset), static_cast<std::int32_t>(plane.error_bound)};
}

// The view's normals along turned axes, computed when first asked for. A plane's value at o + Σ axis k · q[k] is its
// value at o plus (axis k · normal) q[k] for each k, whatever the axes: so only the normal is turned. Sums in double
// round by 2^-51, which the rounding to 2^-14 has room for (boxtree::rounding_of).
class TurnedPlanes {
  public:
    explicit TurnedPlanes(const KernelView& view) : view_(view) {}

    // The normals of `planes` along the axes of that index in a tree's `axes`. Valid until the next call.
    const PairPlane* along(const boxtree::Axes* axes, std::uint32_t index, std::uint32_t planes) {
        if (index == 0) return view_.pair_planes;
        if (axes + index != turned_to_) {
            turned_to_ = axes + index;
            turned_ = 0;
        }
        for (std::uint32_t rest = planes & ~turned_; rest; rest &= rest - 1)
            turn(static_cast<std::uint32_t>(std::countr_zero(rest)));
        return planes_;
    }

  private:
    void turn(std::uint32_t i) {
        double normal[3];
        for (unsigned k = 0; k < 3; ++k) normal[k] = boxtree::along(*turned_to_, k, view_.planes[i].normal);
        planes_[i] = pair_plane_of(normal);
        turned_ |= 1u << i;
    }

    const KernelView& view_;
    const boxtree::Axes* turned_to_ = nullptr;
    std::uint32_t turned_ = 0;
    PairPlane planes_[KernelView::kMaxPlanes];
};

}  // namespace crofton::cull
