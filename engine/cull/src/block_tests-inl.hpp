// Nodes and leaves against one view's planes, 16 lanes at a time. Compiled once per instruction set (Highway).
#include <hwy/highway.h>
#include <crofton/tree/layout.hpp>

#include "kernel_view.hpp"

#if defined(CROFTON_CULL_BLOCK_TESTS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_CULL_BLOCK_TESTS_INL
#undef CROFTON_CULL_BLOCK_TESTS_INL
#else
#define CROFTON_CULL_BLOCK_TESTS_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace crofton::cull::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using DF = hn::CappedTag<float, tree::kWidth>;
using DU = hn::RebindToUnsigned<DF>;
using DI = hn::RebindToSigned<DF>;
using D16 = hn::Rebind<std::int16_t, DF>;
using VF = hn::Vec<DF>;
using VU = hn::Vec<DU>;
using MF = hn::Mask<DF>;

template <class M>
HWY_INLINE std::uint32_t bits_of(M mask) {
    alignas(8) std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(DF(), mask, bytes);
    return static_cast<std::uint32_t>(bytes[0]) | static_cast<std::uint32_t>(bytes[1]) << 8;
}

struct NodeTest {
    std::uint32_t alive;                   // lanes that no plane certainly rejects and that share a layer with the view
    alignas(64) std::uint32_t planes[16];  // per lane, those of the planes that it is not certainly inside of
};

HWY_INLINE NodeTest test_node(const KernelView& view, const tree::Node& node, std::uint32_t planes) {
    const DF d;
    const DU du;
    NodeTest result;
    result.alive = 0;
    LocalPlane local[KernelView::kMaxPlanes];
    unsigned index[KernelView::kMaxPlanes], count = 0;
    for (std::uint32_t rest = planes; rest; rest &= rest - 1) {
        index[count] = static_cast<unsigned>(hwy::Num0BitsBelowLS1Bit_Nonzero32(rest));
        local[count] = local_plane(view.planes[index[count]], view.origin, node.origin, node.reach);
        ++count;
    }
    for (std::size_t l = 0; l < tree::kWidth; l += hn::Lanes(d)) {
        const VF x = hn::Load(d, node.center[0] + l), y = hn::Load(d, node.center[1] + l),
                 z = hn::Load(d, node.center[2] + l);
        const VF hx = hn::Load(d, node.half[0] + l), hy = hn::Load(d, node.half[1] + l),
                 hz = hn::Load(d, node.half[2] + l);
        MF alive = hn::RebindMask(
            d, hn::Ne(hn::And(hn::Load(du, node.layers_any + l), hn::Set(du, view.layer_mask)), hn::Zero(du)));
        VU straddled = hn::Set(du, planes);
        for (unsigned i = 0; i < count; ++i) {
            const VF nx = hn::Set(d, local[i].normal[0]), ny = hn::Set(d, local[i].normal[1]),
                     nz = hn::Set(d, local[i].normal[2]);
            const VF middle = hn::MulAdd(nx, x, hn::MulAdd(ny, y, hn::MulAdd(nz, z, hn::Set(d, local[i].offset))));
            const VF reach = hn::MulAdd(hn::Abs(nx), hx, hn::MulAdd(hn::Abs(ny), hy, hn::Mul(hn::Abs(nz), hz)));
            const VF slack = hn::Set(d, local[i].slack);
            alive = hn::And(alive, hn::Ge(hn::Add(middle, reach), hn::Neg(slack)));
            const MF inside = hn::Ge(hn::Sub(middle, reach), slack);
            straddled = hn::IfThenElse(hn::RebindMask(du, inside), hn::AndNot(hn::Set(du, 1u << index[i]), straddled),
                                       straddled);
        }
        hn::Store(straddled, du, result.planes + l);
        result.alive |= bits_of(alive) << l;
    }
    result.alive &= (1u << node.count) - 1;  // count ≤ 16
    return result;
}

// Lanes of a leaf, `l` on: what the filter knows of their boxes.
struct LeafTest {
    MF inside;      // certainly inside
    MF straddling;  // certainly straddling (and, in the exact mode, meeting the frustum)
    MF undecided;   // the rest of those that are not certainly outside
};

HWY_INLINE LeafTest test_leaf(const KernelView& view, const tree::Leaf& leaf, const LocalPlane* local,
                              unsigned plane_count, std::size_t l, bool exact) {
    const DF d;
    const DU du;
    const DI di;
    const D16 d16;
    const VF x = hn::Load(d, leaf.x + l), y = hn::Load(d, leaf.y + l), z = hn::Load(d, leaf.z + l);
    const VF unit = hn::Mul(hn::Load(d, leaf.radius + l), hn::Set(d, tree::kEdgeUnit));
    VF edge[9];
    for (unsigned i = 0; i < 9; ++i) edge[i] = hn::ConvertTo(d, hn::PromoteTo(di, hn::Load(d16, leaf.edge[i] + l)));
    // Nine components within one unit of the truth each, Σ|normal| ≤ √3: 5.2 units; the rest covers the sums' rounding.
    const VF edge_slack = hn::Mul(unit, hn::Set(d, 6.0f));
    const MF present = hn::And(
        hn::FirstN(d, leaf.count > l ? leaf.count - l : 0),
        hn::RebindMask(d, hn::Ne(hn::And(hn::Load(du, leaf.layers + l), hn::Set(du, view.layer_mask)), hn::Zero(du))));
    MF maybe = present, passes = present, center = present;
    const MF none = hn::FirstN(d, 0);
    MF crosses = none, open_once = none, open_twice = none;
    for (unsigned i = 0; i < plane_count; ++i) {
        const VF nx = hn::Set(d, local[i].normal[0]), ny = hn::Set(d, local[i].normal[1]),
                 nz = hn::Set(d, local[i].normal[2]);
        const VF middle = hn::MulAdd(nx, x, hn::MulAdd(ny, y, hn::MulAdd(nz, z, hn::Set(d, local[i].offset))));
        VF reach = hn::Zero(d);
        for (unsigned k = 0; k < 9; k += 3)
            reach =
                hn::Add(reach, hn::Abs(hn::MulAdd(nx, edge[k], hn::MulAdd(ny, edge[k + 1], hn::Mul(nz, edge[k + 2])))));
        reach = hn::Mul(reach, unit);
        const VF slack = hn::Add(edge_slack, hn::Set(d, local[i].slack));
        const VF top = hn::Add(middle, reach), bottom = hn::Sub(middle, reach);
        const MF open = hn::Lt(bottom, slack);
        maybe = hn::And(maybe, hn::Ge(top, hn::Neg(slack)));
        passes = hn::And(passes, hn::Ge(top, slack));
        center = hn::And(center, hn::Ge(middle, slack));
        crosses = hn::Or(crosses, hn::Lt(bottom, hn::Neg(slack)));
        open_twice = hn::Or(open_twice, hn::And(open_once, open));
        open_once = hn::Or(open_once, open);
    }
    LeafTest result;
    result.inside = hn::AndNot(open_once, present);
    result.straddling = hn::And(passes, crosses);
    // A box that crosses one plane and lies inside all others meets the frustum; so does one whose centre is inside.
    if (exact) result.straddling = hn::And(result.straddling, hn::Or(hn::Not(open_twice), center));
    result.undecided = hn::AndNot(hn::Or(result.inside, result.straddling), maybe);
    return result;
}

}  // namespace crofton::cull::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
