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

HWY_INLINE VF plane_value(const KernelPlane& plane, VF x, VF y, VF z, float offset) {
    const DF d;
    return hn::MulAdd(
        hn::Set(d, plane.normal_f[0]), x,
        hn::MulAdd(hn::Set(d, plane.normal_f[1]), y, hn::MulAdd(hn::Set(d, plane.normal_f[2]), z, hn::Set(d, offset))));
}

// Layers and edges follow rows of half the vectors' length in a Leaf: they need not be aligned.
HWY_INLINE MF shares_layer(const KernelView& view, const std::uint32_t* layers) {
    const DU du;
    const VU common = hn::And(hn::LoadU(du, layers), hn::Set(du, view.layer_mask));
    return hn::RebindMask(DF(), hn::Ne(common, hn::Zero(du)));  // empty lanes have no layers
}

HWY_INLINE NodeTest test_node(const KernelView& view, const tree::Node& node, std::uint32_t planes) {
    const DF d;
    const DU du;
    NodeTest result;
    result.alive = 0;
    const LocalOrigin at = local_origin(view, node.origin, node.reach);
    LocalPlane local[KernelView::kMaxPlanes];
    for (std::uint32_t rest = planes; rest; rest &= rest - 1) {
        const auto i = hwy::Num0BitsBelowLS1Bit_Nonzero32(rest);
        local[i] = local_plane(view.planes[i], at);
    }
    for (std::size_t l = 0; l < tree::kWidth; l += hn::Lanes(d)) {
        const VF x = hn::Load(d, node.center[0] + l), y = hn::Load(d, node.center[1] + l),
                 z = hn::Load(d, node.center[2] + l);
        const VF hx = hn::Load(d, node.half[0] + l), hy = hn::Load(d, node.half[1] + l),
                 hz = hn::Load(d, node.half[2] + l);
        MF alive = shares_layer(view, node.layers_any + l);
        VU straddled = hn::Set(du, planes);
        for (std::uint32_t rest = planes; rest; rest &= rest - 1) {
            const auto i = hwy::Num0BitsBelowLS1Bit_Nonzero32(rest);
            const KernelPlane& plane = view.planes[i];
            const VF middle = plane_value(plane, x, y, z, local[i].offset);
            const VF reach = hn::MulAdd(hn::Set(d, std::fabs(plane.normal_f[0])), hx,
                                        hn::MulAdd(hn::Set(d, std::fabs(plane.normal_f[1])), hy,
                                                   hn::Mul(hn::Set(d, std::fabs(plane.normal_f[2])), hz)));
            alive = hn::And(alive, hn::Ge(hn::Add(middle, reach), hn::Set(d, -local[i].slack)));
            const MF inside = hn::Ge(hn::Sub(middle, reach), hn::Set(d, local[i].slack));
            const VU without = hn::And(straddled, hn::Set(du, ~(1u << i)));
            straddled = hn::IfThenElse(hn::RebindMask(du, inside), without, straddled);
        }
        hn::Store(straddled, du, result.planes + l);
        result.alive |= bits_of(alive) << l;
    }
    return result;
}

// Lanes of a leaf, `l` on: what the filter knows of their boxes.
struct LeafTest {
    MF inside;      // certainly inside
    MF straddling;  // certainly straddling (and, in the exact mode, meeting the frustum)
    MF undecided;   // the rest of those that are not certainly outside
};

// The boxes of a leaf in floats.
struct LeafBoxes {
    VF x, y, z, unit, edge_slack;
    VF edge[9];
    MF present;

    HWY_INLINE LeafBoxes(const KernelView& view, const tree::Leaf& leaf, std::size_t l) {
        const DF d;
        x = hn::Load(d, leaf.x + l);
        y = hn::Load(d, leaf.y + l);
        z = hn::Load(d, leaf.z + l);
        unit = hn::Mul(hn::Load(d, leaf.radius + l), hn::Set(d, tree::kEdgeUnit));
        // Nine components within one unit of the truth each, Σ|normal| ≤ √3: 5.2 units; the rest covers the sums'
        // rounding.
        edge_slack = hn::Mul(unit, hn::Set(d, 6.0f));
        for (unsigned i = 0; i < 9; ++i)
            edge[i] = hn::ConvertTo(d, hn::PromoteTo(DI(), hn::LoadU(D16(), leaf.edge[i] + l)));
        present = shares_layer(view, leaf.layers + l);
    }

    // normal · edge k, in units.
    HWY_INLINE VF slope(const KernelPlane& plane, unsigned k) const {
        const DF d;
        const VF nx = hn::Set(d, plane.normal_f[0]), ny = hn::Set(d, plane.normal_f[1]),
                 nz = hn::Set(d, plane.normal_f[2]);
        return hn::MulAdd(nx, edge[3 * k], hn::MulAdd(ny, edge[3 * k + 1], hn::Mul(nz, edge[3 * k + 2])));
    }

    HWY_INLINE VF reach(const KernelPlane& plane) const {
        const VF sum = hn::Add(hn::Add(hn::Abs(slope(plane, 0)), hn::Abs(slope(plane, 1))), hn::Abs(slope(plane, 2)));
        return hn::Mul(sum, unit);
    }
};

// Most leaves that cross a frustum cross one plane; then a box that straddles it meets the frustum for certain.
HWY_INLINE LeafTest test_leaf(const KernelView& view, const tree::Leaf& leaf, std::size_t l, const KernelPlane& plane,
                              LocalPlane local) {
    const DF d;
    const LeafBoxes boxes(view, leaf, l);
    const VF middle = plane_value(plane, boxes.x, boxes.y, boxes.z, local.offset);
    const VF reach = boxes.reach(plane);
    const VF slack = hn::Add(boxes.edge_slack, hn::Set(d, local.slack));
    const VF top = hn::Add(middle, reach), bottom = hn::Sub(middle, reach);
    LeafTest result;
    result.inside = hn::And(boxes.present, hn::Ge(bottom, slack));
    result.straddling = hn::And(boxes.present, hn::And(hn::Ge(top, slack), hn::Lt(bottom, hn::Neg(slack))));
    const MF maybe = hn::And(boxes.present, hn::Ge(top, hn::Neg(slack)));
    result.undecided = hn::AndNot(hn::Or(result.inside, result.straddling), maybe);
    return result;
}

// Those of the wanted lanes whose boxes certainly have a point inside all planes: from the centre towards the plane
// that it is farthest outside of, to a little beyond it, and from there once more towards the plane that is worst then.
HWY_INLINE MF has_witness(const KernelView& view, const LeafBoxes& boxes, std::uint32_t planes, const LocalPlane* local,
                          MF wanted) {
    const DF d;
    const VF zero = hn::Zero(d), one = hn::Set(d, 1.0f);
    VF t[3] = {zero, zero, zero};
    MF found = hn::FirstN(d, 0);
    for (int round = 0;; ++round) {
        VF worst = hn::Set(d, 3e38f), slope[3] = {zero, zero, zero};
        MF inside = boxes.present;
        for (std::uint32_t rest = planes; rest; rest &= rest - 1) {
            const auto i = hwy::Num0BitsBelowLS1Bit_Nonzero32(rest);
            const VF a = hn::Mul(boxes.slope(view.planes[i], 0), boxes.unit),
                     b = hn::Mul(boxes.slope(view.planes[i], 1), boxes.unit),
                     c = hn::Mul(boxes.slope(view.planes[i], 2), boxes.unit);
            const VF value = hn::MulAdd(
                a, t[0],
                hn::MulAdd(
                    b, t[1],
                    hn::MulAdd(c, t[2], plane_value(view.planes[i], boxes.x, boxes.y, boxes.z, local[i].offset))));
            inside = hn::And(inside, hn::Ge(value, hn::Add(boxes.edge_slack, hn::Set(d, local[i].slack))));
            const MF worse = hn::Lt(value, worst);
            worst = hn::IfThenElse(worse, value, worst);
            slope[0] = hn::IfThenElse(worse, a, slope[0]);
            slope[1] = hn::IfThenElse(worse, b, slope[1]);
            slope[2] = hn::IfThenElse(worse, c, slope[2]);
        }
        found = hn::Or(found, inside);
        if (round == 2 || hn::AllFalse(d, hn::AndNot(found, wanted))) break;
        // Along the gradient, clamped to the box; any t in [−1, 1]³ is as good a guess as another.
        const VF square = hn::MulAdd(slope[0], slope[0], hn::MulAdd(slope[1], slope[1], hn::Mul(slope[2], slope[2])));
        const VF reach = hn::Add(hn::Add(hn::Abs(slope[0]), hn::Abs(slope[1])), hn::Abs(slope[2]));
        const VF step =
            hn::Div(hn::MulAdd(reach, hn::Set(d, 0.05f), hn::Neg(worst)), hn::Max(square, hn::Set(d, 1e-30f)));
        for (VF& coordinate : t)
            coordinate = hn::Max(hn::Neg(one), hn::Min(one, hn::MulAdd(step, slope[&coordinate - t], coordinate)));
    }
    return found;
}

HWY_INLINE LeafTest test_leaf(const KernelView& view, const tree::Leaf& leaf, std::size_t l, std::uint32_t planes,
                              const LocalPlane* local, bool exact) {
    const DF d;
    const LeafBoxes boxes(view, leaf, l);
    const MF none = hn::FirstN(d, 0);
    MF maybe = boxes.present, passes = boxes.present, center = boxes.present;
    MF crosses = none, open_once = none, open_twice = none;
    for (std::uint32_t rest = planes; rest; rest &= rest - 1) {
        const auto i = hwy::Num0BitsBelowLS1Bit_Nonzero32(rest);
        const VF middle = plane_value(view.planes[i], boxes.x, boxes.y, boxes.z, local[i].offset);
        const VF reach = boxes.reach(view.planes[i]);
        const VF slack = hn::Add(boxes.edge_slack, hn::Set(d, local[i].slack));
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
    result.inside = hn::AndNot(open_once, boxes.present);
    result.straddling = hn::And(passes, crosses);
    // A box that crosses one plane and lies inside all others meets the frustum; so does one whose centre is inside, or
    // another of its points.
    if (exact) {
        MF meets = hn::Or(hn::Not(open_twice), center);
        const MF wanted = hn::AndNot(meets, result.straddling);
        if (!hn::AllFalse(d, wanted)) meets = hn::Or(meets, has_witness(view, boxes, planes, local, wanted));
        result.straddling = hn::And(result.straddling, meets);
    }
    result.undecided = hn::AndNot(hn::Or(result.inside, result.straddling), maybe);
    return result;
}

}  // namespace crofton::cull::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
