// Nodes and leaves against one view's planes, 16 lanes at a time. Compiled once per instruction set (Highway).
#include <hwy/highway.h>
#include <bit>
#include <crofton/tree/layout.hpp>
#include <cstring>

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
using VF = hn::Vec<DF>;
using VU = hn::Vec<DU>;
using MF = hn::Mask<DF>;

// The halves of pairs as floats.
HWY_INLINE VF lower_half(VU pairs) {
    return hn::ConvertTo(DF(), hn::ShiftRight<16>(hn::ShiftLeft<16>(hn::BitCast(DI(), pairs))));
}
HWY_INLINE VF upper_half(VU pairs) {
    return hn::ConvertTo(DF(), hn::ShiftRight<16>(hn::BitCast(DI(), pairs)));
}

// Bit l for lane l. As one load of what was stored: bytes put together one by one cost more than the tests.
template <class M>
HWY_INLINE std::uint32_t bits_of(M mask) {
    static_assert(std::endian::native == std::endian::little);
    alignas(8) std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(DF(), mask, bytes);
    std::uint16_t bits;
    std::memcpy(&bits, bytes, 2);
    return bits;
}

// The lowest bits as a mask. Eight bytes are stored and loaded as one: parts would have to wait for each other.
HWY_INLINE hn::Mask<DU> mask_of(std::uint64_t bits) {
    alignas(8) std::uint8_t bytes[8];
    std::memcpy(bytes, &bits, 8);
    return hn::LoadMaskBits(DU(), bytes);
}

struct NodeTest {
    std::uint32_t settled;                 // lanes that are certainly inside of all planes
    std::uint32_t alive;                   // lanes that no plane certainly rejects and that share a layer with the view
    alignas(64) std::uint32_t planes[16];  // per lane, those of the planes that it is not certainly inside of
};

HWY_INLINE VF plane_value(const KernelPlane& plane, VF x, VF y, VF z, float offset) {
    const DF d;
    return hn::MulAdd(
        hn::Set(d, plane.normal_f[0]), x,
        hn::MulAdd(hn::Set(d, plane.normal_f[1]), y, hn::MulAdd(hn::Set(d, plane.normal_f[2]), z, hn::Set(d, offset))));
}

// Lanes below `count` that share a layer with the view; lane by lane only if not all of them do.
HWY_INLINE MF present(const KernelView& view, std::uint32_t every, const std::uint32_t* layers, std::uint32_t count,
                      std::size_t l) {
    const DU du;
    const MF used = hn::FirstN(DF(), count > l ? count - l : 0);
    if (HWY_LIKELY(every & view.layer_mask)) return used;
    const VU common = hn::And(hn::Load(du, layers + l), hn::Set(du, view.layer_mask));
    return hn::And(used, hn::RebindMask(DF(), hn::Ne(common, hn::Zero(du))));
}

HWY_INLINE NodeTest test_node(const KernelView& view, const tree::Node& node, std::uint32_t planes) {
    const DF d;
    const DU du;
    NodeTest result;
    result.alive = result.settled = 0;
    const LocalOrigin at = local_origin(view, node.origin, node.reach);
    LocalPlane local[KernelView::kMaxPlanes];
    for (std::uint32_t rest = planes; rest; rest &= rest - 1) {
        const auto i = hwy::Num0BitsBelowLS1Bit_Nonzero32(rest);
        local[i] = local_plane(view.planes[i], at);
    }
    const VF unit = hn::Set(d, node.unit);
    for (std::size_t l = 0; l < tree::kWidth; l += hn::Lanes(d)) {
        const VU middle_xy = hn::Load(du, node.middle_xy + l), half_xy = hn::Load(du, node.half_xy + l),
                 middle_half_z = hn::Load(du, node.middle_half_z + l);
        const VF x = hn::Mul(lower_half(middle_xy), unit), y = hn::Mul(upper_half(middle_xy), unit),
                 z = hn::Mul(lower_half(middle_half_z), unit), hx = hn::Mul(lower_half(half_xy), unit),
                 hy = hn::Mul(upper_half(half_xy), unit), hz = hn::Mul(upper_half(middle_half_z), unit);
        MF alive = present(view, node.layers_every, node.layers_any, node.count, l);
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
        result.settled |= bits_of(hn::RebindMask(d, hn::Eq(straddled, hn::Zero(du)))) << l;
    }
    return result;
}

// Lanes of boxes: what the filter knows of them.
struct BoxTest {
    MF inside;      // certainly inside
    MF straddling;  // certainly straddling (and, in the exact mode, meeting the frustum)
    MF unsettled;   // certainly not rejected by a plane, certainly not inside; whether they meet the frustum is open
    MF undecided;   // the rest of those that are not certainly outside
    MF improper;    // rejected by no plane, and certainly outside all the same
};

// Boxes in floats: from a leaf, or a list's records.
struct BoxLanes {
    VF x, y, z, unit;
    VF edge_slack;
    VF edge[9];  // in units
    MF present;

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

    HWY_INLINE VF slack(LocalPlane local) const { return hn::Add(edge_slack, hn::Set(DF(), local.slack)); }
};

HWY_INLINE BoxLanes lanes_of(const KernelView& view, const tree::Leaf& leaf, std::size_t l) {
    const DF d;
    BoxLanes boxes;
    const VF position_unit = hn::Set(d, leaf.position_unit);
    const DU du;
    const VU xy = hn::Load(du, leaf.xy + l), z = hn::Load(du, leaf.z_edge2_z + l),
             edge_z = hn::Load(du, leaf.edge01_z + l);
    boxes.x = hn::Mul(lower_half(xy), position_unit);
    boxes.y = hn::Mul(upper_half(xy), position_unit);
    boxes.z = hn::Mul(lower_half(z), position_unit);
    boxes.unit = hn::Set(d, leaf.edge_unit);
    boxes.edge_slack = hn::Set(d, leaf.slack);
    for (unsigned k = 0; k < 3; ++k) {
        const VU edge_xy = hn::Load(du, leaf.edge_xy[k] + l);
        boxes.edge[3 * k] = lower_half(edge_xy);
        boxes.edge[3 * k + 1] = upper_half(edge_xy);
    }
    boxes.edge[2] = lower_half(edge_z);
    boxes.edge[5] = upper_half(edge_z);
    boxes.edge[8] = upper_half(z);
    boxes.present = present(view, leaf.layers_every, leaf.layers, leaf.count, l);
    return boxes;
}

// Most leaves that cross a frustum cross one plane; then a box that straddles it meets the frustum for certain.
template <class Lanes>
HWY_INLINE BoxTest test_boxes(const Lanes& boxes, const KernelPlane& plane, LocalPlane local) {
    const DF d;
    const VF middle = plane_value(plane, boxes.x, boxes.y, boxes.z, local.offset);
    const VF reach = boxes.reach(plane), slack = boxes.slack(local);
    const VF top = hn::Add(middle, reach), bottom = hn::Sub(middle, reach);
    BoxTest result;
    result.inside = hn::And(boxes.present, hn::Ge(bottom, slack));
    result.straddling = hn::And(boxes.present, hn::And(hn::Ge(top, slack), hn::Lt(bottom, hn::Neg(slack))));
    result.unsettled = result.improper = hn::FirstN(d, 0);
    const MF maybe = hn::And(boxes.present, hn::Ge(top, hn::Neg(slack)));
    result.undecided = hn::AndNot(hn::Or(result.inside, result.straddling), maybe);
    return result;
}

template <class Lanes>
HWY_INLINE BoxTest test_boxes(const KernelView& view, const Lanes& boxes, std::uint32_t planes, const LocalPlane* local,
                              bool exact) {
    const DF d;
    const MF none = hn::FirstN(d, 0);
    MF maybe = boxes.present, passes = boxes.present, center = boxes.present;
    MF crosses = none, open_once = none, open_twice = none;
    for (std::uint32_t rest = planes; rest; rest &= rest - 1) {
        const auto i = hwy::Num0BitsBelowLS1Bit_Nonzero32(rest);
        const VF middle = plane_value(view.planes[i], boxes.x, boxes.y, boxes.z, local[i].offset);
        const VF reach = boxes.reach(view.planes[i]), slack = boxes.slack(local[i]);
        const VF top = hn::Add(middle, reach), bottom = hn::Sub(middle, reach);
        const MF open = hn::Lt(bottom, slack);
        maybe = hn::And(maybe, hn::Ge(top, hn::Neg(slack)));
        passes = hn::And(passes, hn::Ge(top, slack));
        center = hn::And(center, hn::Ge(middle, slack));
        crosses = hn::Or(crosses, hn::Lt(bottom, hn::Neg(slack)));
        open_twice = hn::Or(open_twice, hn::And(open_once, open));
        open_once = hn::Or(open_once, open);
    }
    BoxTest result;
    result.improper = none;
    result.inside = hn::AndNot(open_once, boxes.present);
    const MF crossing = hn::And(passes, crosses);
    // A box that crosses one plane and lies inside all others meets the frustum; so does one whose centre is inside.
    const MF meets = exact ? hn::Or(hn::Not(open_twice), center) : boxes.present;
    result.straddling = hn::And(crossing, meets);
    result.unsettled = hn::AndNot(meets, crossing);
    result.undecided = hn::AndNot(hn::Or(result.inside, crossing), maybe);
    return result;
}

// Planes in the boxes' own coordinates: plane i is f_i(t) = base_i + unit · Σ slope_ik t_k ≥ 0 on the cube |t| ≤ 1, and
// slack_i bounds the error of f_i anywhere there.
template <class Lanes>
struct BoxRows {
    struct Row {
        VF base, slack, reach, slope[3];
    };
    Row rows[KernelView::kMaxPlanes];
    unsigned count = 0;
    VF unit;

    HWY_INLINE BoxRows(const KernelView& view, const Lanes& boxes, std::uint32_t planes, const LocalPlane* local)
        : unit(boxes.unit) {
        for (std::uint32_t rest = planes; rest; rest &= rest - 1) {
            const auto i = hwy::Num0BitsBelowLS1Bit_Nonzero32(rest);
            Row& row = rows[count++];
            row.base = plane_value(view.planes[i], boxes.x, boxes.y, boxes.z, local[i].offset);
            row.slack = boxes.slack(local[i]);
            row.reach = hn::Zero(DF());
            for (unsigned k = 0; k < 3; ++k) {
                row.slope[k] = boxes.slope(view.planes[i], k);
                row.reach = hn::Add(row.reach, hn::Abs(row.slope[k]));
            }
        }
    }
};

// Those of the wanted lanes whose boxes certainly have a point inside all planes: from the centre towards the plane
// that it is farthest outside of, to a little beyond it, and on towards the plane that is worst then; coordinates that
// have come to a face stay there while the way leads across it. Of the boxes that cross an edge of the frustum about
// one in fifty needs more than six steps.
template <class Lanes>
HWY_INLINE MF has_witness(const BoxRows<Lanes>& box, MF wanted) {
    const DF d;
    const VF zero = hn::Zero(d), one = hn::Set(d, 1.0f);
    VF t[3] = {zero, zero, zero};
    MF found = hn::FirstN(d, 0);
    for (int round = 0;; ++round) {
        VF worst = hn::Set(d, 3e38f), reach = zero, slope[3] = {zero, zero, zero};
        MF inside = wanted;
        for (unsigned i = 0; i < box.count; ++i) {
            const auto& row = box.rows[i];
            const VF along =
                hn::MulAdd(row.slope[0], t[0], hn::MulAdd(row.slope[1], t[1], hn::Mul(row.slope[2], t[2])));
            const VF value = hn::MulAdd(along, box.unit, row.base);
            inside = hn::And(inside, hn::Ge(value, row.slack));
            const MF worse = hn::Lt(value, worst);
            worst = hn::IfThenElse(worse, value, worst);
            reach = hn::IfThenElse(worse, row.reach, reach);
            for (unsigned k = 0; k < 3; ++k) slope[k] = hn::IfThenElse(worse, row.slope[k], slope[k]);
        }
        found = hn::Or(found, inside);
        if (round == 6 || hn::AllFalse(d, hn::AndNot(found, wanted))) break;
        // Along the gradient, clamped to the box; any t in [−1, 1]³ is as good a guess as another.
        VF square = hn::Set(d, 1e-20f);
        for (unsigned k = 0; k < 3; ++k) {
            const MF blocked = hn::Ge(hn::Mul(t[k], slope[k]), hn::Abs(slope[k]));
            slope[k] = hn::IfThenZeroElse(blocked, slope[k]);
            square = hn::MulAdd(slope[k], slope[k], square);
        }
        const VF beyond = hn::MulAdd(hn::Mul(reach, box.unit), hn::Set(d, 0.05f), hn::Neg(worst));
        const VF step = hn::Div(beyond, hn::Mul(square, box.unit));
        for (unsigned k = 0; k < 3; ++k) t[k] = hn::Max(hn::Neg(one), hn::Min(one, hn::MulAdd(step, slope[k], t[k])));
    }
    return found;
}

// Those of the wanted lanes whose boxes a separating axis across an edge of the frustum and an edge of the box
// certainly keeps apart. A sum with weights ≥ 0 of two f_i that is negative on the whole cube is a proof. The best
// weights let one slope vanish. For any weights the sum's largest value is at most what the floats of f_i, f_j give
// plus Σ weight · slack. Evaluating it here rounds at most eight times 2^-24 of Σ weight · (|base| + reach): 2^-19;
// what underflow eats is far below 1e-30, since weights are at most 1.7 · 2^15.
template <class Lanes>
HWY_INLINE MF is_separated(const BoxRows<Lanes>& box, MF wanted) {
    const DF d;
    VF top[KernelView::kMaxPlanes];  // base with all that it may be off by
    for (unsigned i = 0; i < box.count; ++i) {
        const auto& row = box.rows[i];
        const VF size = hn::MulAdd(row.reach, box.unit, hn::Abs(row.base));
        top[i] = hn::Add(row.base, hn::MulAdd(size, hn::Set(d, 0x1p-19f), row.slack));
    }
    MF separated = hn::FirstN(d, 0);
    for (unsigned i = 0; i < box.count; ++i)
        for (unsigned j = i + 1; j < box.count; ++j) {
            const VF(&a)[3] = box.rows[i].slope;
            const VF(&b)[3] = box.rows[j].slope;
            for (unsigned k = 0; k < 3; ++k) {
                const unsigned p = (k + 1) % 3, q = (k + 2) % 3;
                const VF weight_a = hn::Abs(b[k]), weight_b = hn::Abs(a[k]);
                const VF along_p = hn::MulAdd(weight_a, a[p], hn::Mul(weight_b, b[p])),
                         along_q = hn::MulAdd(weight_a, a[q], hn::Mul(weight_b, b[q]));
                const VF reach = hn::Mul(hn::Add(hn::Abs(along_p), hn::Abs(along_q)), box.unit);
                const VF bound = hn::MulAdd(weight_a, top[i], hn::MulAdd(weight_b, top[j], reach));
                const MF opposed = hn::Lt(hn::Mul(a[k], b[k]), hn::Zero(d));
                separated = hn::Or(separated, hn::And(opposed, hn::Lt(bound, hn::Set(d, -1e-30f))));
            }
            if (hn::AllFalse(d, hn::AndNot(separated, wanted))) return wanted;
        }
    return hn::And(separated, wanted);
}

// The second stage in vectors: what it cannot settle either is undecided.
template <class Lanes>
HWY_INLINE void settle(const KernelView& view, const Lanes& boxes, std::uint32_t planes, const LocalPlane* local,
                       BoxTest& test) {
    const DF d;
    const BoxRows<Lanes> box(view, boxes, planes, local);
    const MF meets = has_witness(box, test.unsettled);
    test.straddling = hn::Or(test.straddling, meets);
    test.unsettled = hn::AndNot(meets, test.unsettled);
    if (!hn::AllFalse(d, test.unsettled)) test.improper = is_separated(box, test.unsettled);
    test.undecided = hn::Or(test.undecided, hn::AndNot(test.improper, test.unsettled));
}

HWY_INLINE BoxTest test_leaf(const KernelView& view, const tree::Leaf& leaf, std::size_t l, std::uint32_t planes,
                             const LocalPlane* local, bool exact) {
    const BoxLanes boxes = lanes_of(view, leaf, l);
    BoxTest result = test_boxes(view, boxes, planes, local, exact);
    if (!hn::AllFalse(DF(), result.unsettled)) settle(view, boxes, planes, local, result);
    return result;
}

}  // namespace crofton::cull::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
