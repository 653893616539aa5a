// SPDX-License-Identifier: MIT
#include "leaf_extents.hpp"

#include <hwy/cache_control.h>

// clang-format off
#include <hwy/foreach_target.h>
// clang-format on
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace crofton::boxtree::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

void ExtentOf(const Leaf& leaf, LeafExtent& extent) {
    const hn::CappedTag<float, kWidth> d;
    const hn::RebindToSigned<decltype(d)> di;
    const hn::RebindToUnsigned<decltype(d)> du;
    const auto lower = [&](const Int16x2* row) HWY_ATTR {
        return hn::ShiftRight<16>(hn::ShiftLeft<16>(hn::BitCast(di, hn::Load(du, row))));
    };
    const auto upper = [&](const Int16x2* row)
                           HWY_ATTR { return hn::ShiftRight<16>(hn::BitCast(di, hn::Load(du, row))); };
    const auto position_unit = hn::Set(d, leaf.position_unit), edge_unit = hn::Set(d, leaf.edge_unit);
    for (unsigned j = 0; j < 3; ++j) {
        auto low = hn::Set(d, 3.4e38f), high = hn::Set(d, -3.4e38f);
        for (std::size_t l = 0; l < kWidth; l += hn::Lanes(d)) {
            const auto used = hn::FirstN(d, leaf.count > l ? leaf.count - l : 0);
            const auto edge = [&](unsigned k) HWY_ATTR {
                if (j < 2) return hn::Abs(j == 0 ? lower(leaf.edge_xy[k] + l) : upper(leaf.edge_xy[k] + l));
                return hn::Abs(k == 0   ? lower(leaf.edge01_z + l)
                               : k == 1 ? upper(leaf.edge01_z + l)
                                        : upper(leaf.z_edge2_z + l));
            };
            const auto sum = hn::Add(hn::Add(edge(0), edge(1)), edge(2));
            const auto position = j == 0 ? lower(leaf.xy + l) : j == 1 ? upper(leaf.xy + l) : lower(leaf.z_edge2_z + l);
            // Both products are exact; the sums round once.
            const auto half = hn::Mul(hn::ConvertTo(d, sum), edge_unit);
            const auto center = hn::Mul(hn::ConvertTo(d, position), position_unit);
            low = hn::IfThenElse(used, hn::Min(low, hn::Sub(center, half)), low);
            high = hn::IfThenElse(used, hn::Max(high, hn::Add(center, half)), high);
        }
        extent.low[j] = hn::GetLane(hn::MinOfLanes(d, low));
        extent.high[j] = hn::GetLane(hn::MaxOfLanes(d, high));
    }
}

void LeafExtents(const Leaf* leaves, const LeafId* ids, std::size_t count, LeafExtent* extents) {
    constexpr std::size_t kAhead = 6;
    for (std::size_t i = 0; i < count; ++i) {
        if (i + kAhead < count)
            for (std::size_t at = 0; at < 448; at += 64)
                hwy::Prefetch(reinterpret_cast<const char*>(leaves + ids[i + kAhead]) + at);
        ExtentOf(leaves[ids[i]], extents[i]);
    }
}

using DF = hn::CappedTag<float, kWidth>;

HWY_INLINE hn::Vec<DF> lower_half(const Int16x2* row) {
    const hn::RebindToSigned<DF> di;
    const auto pairs = hn::BitCast(di, hn::Load(hn::RebindToUnsigned<DF>(), row));
    return hn::ConvertTo(DF(), hn::ShiftRight<16>(hn::ShiftLeft<16>(pairs)));
}
HWY_INLINE hn::Vec<DF> upper_half(const Int16x2* row) {
    const hn::RebindToSigned<DF> di;
    return hn::ConvertTo(DF(), hn::ShiftRight<16>(hn::BitCast(di, hn::Load(hn::RebindToUnsigned<DF>(), row))));
}

void TurnedExtent(const Leaf& leaf, const Axes& axes, LeafExtent& extent) {
    const DF d;
    hn::Vec<DF> low[3], high[3];
    for (unsigned k = 0; k < 3; ++k) low[k] = hn::Set(d, 3.4e38f), high[k] = hn::Set(d, -3.4e38f);
    const auto unit = hn::Set(d, leaf.position_unit), edge_unit = hn::Set(d, leaf.edge_unit);
    for (std::size_t l = 0; l < kWidth; l += hn::Lanes(d)) {
        const auto used = hn::FirstN(d, leaf.count > l ? leaf.count - l : 0);
        const hn::Vec<DF> vectors[4][3] = {
            {lower_half(leaf.xy + l), upper_half(leaf.xy + l), lower_half(leaf.z_edge2_z + l)},
            {lower_half(leaf.edge_xy[0] + l), upper_half(leaf.edge_xy[0] + l), lower_half(leaf.edge01_z + l)},
            {lower_half(leaf.edge_xy[1] + l), upper_half(leaf.edge_xy[1] + l), upper_half(leaf.edge01_z + l)},
            {lower_half(leaf.edge_xy[2] + l), upper_half(leaf.edge_xy[2] + l), upper_half(leaf.z_edge2_z + l)}};
        for (unsigned k = 0; k < 3; ++k) {
            hn::Vec<DF> turned[4];
            for (unsigned v = 0; v < 4; ++v) {
                turned[v] = hn::Zero(d);
                for (unsigned j = 0; j < 3; ++j)
                    turned[v] =
                        hn::Add(turned[v], hn::Mul(vectors[v][j], hn::Set(d, static_cast<float>(axes.rows[k][j]))));
            }
            const auto sum = hn::Add(hn::Add(hn::Abs(turned[1]), hn::Abs(turned[2])), hn::Abs(turned[3]));
            const auto center = hn::Mul(turned[0], unit), half = hn::Mul(sum, edge_unit);
            low[k] = hn::IfThenElse(used, hn::Min(low[k], hn::Sub(center, half)), low[k]);
            high[k] = hn::IfThenElse(used, hn::Max(high[k], hn::Add(center, half)), high[k]);
        }
    }
    for (unsigned k = 0; k < 3; ++k) {
        extent.low[k] = hn::GetLane(hn::MinOfLanes(d, low[k]));
        extent.high[k] = hn::GetLane(hn::MaxOfLanes(d, high[k]));
    }
}

}  // namespace
}  // namespace crofton::boxtree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::boxtree {

HWY_EXPORT(LeafExtents);
HWY_EXPORT(TurnedExtent);

void turned_leaf_extent(const Leaf& leaf, const Axes& axes, LeafExtent& extent) {
    HWY_DYNAMIC_DISPATCH(TurnedExtent)(leaf, axes, extent);
}

void leaf_extents(const Leaf* leaves, std::span<const LeafId> ids, LeafExtent* extents) {
    HWY_DYNAMIC_DISPATCH(LeafExtents)(leaves, ids.data(), ids.size(), extents);
}

}  // namespace crofton::boxtree
#endif
