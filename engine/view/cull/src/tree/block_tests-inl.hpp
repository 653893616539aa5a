// SPDX-License-Identifier: MIT
// Nodes and leaves against one view's planes, 16 lanes at a time. Compiled once per instruction set (Highway).
#include "lanes-inl.hpp"
#include "second_stage-inl.hpp"
#include "tree/block_planes.hpp"

#if defined(CROFTON_CULL_BLOCK_TESTS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_CULL_BLOCK_TESTS_INL
#undef CROFTON_CULL_BLOCK_TESTS_INL
#else
#define CROFTON_CULL_BLOCK_TESTS_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace crofton::cull::HWY_NAMESPACE {

struct NodeTest {
    std::uint32_t inside;                  // lanes that are certainly inside of all planes
    std::uint32_t alive;                   // lanes that no plane certainly rejects and that share a layer with the view
    alignas(64) std::uint32_t planes[16];  // per lane, those of the planes that it is not certainly inside of
};

// Lanes below `count` that share a layer with the view. Compares lane by lane only if not all of them do.
HWY_INLINE MF present(const KernelView& view, std::uint32_t every, const std::uint32_t* layers, std::uint32_t count,
                      std::size_t l) {
    const DU du;
    const MF used = hn::FirstN(DF(), count > l ? count - l : 0);
    if (HWY_LIKELY(every & view.layer_mask)) return used;
    const VU common = hn::And(hn::Load(du, layers + l), hn::Set(du, view.layer_mask));
    return hn::And(used, hn::RebindMask(DF(), hn::Ne(common, hn::Zero(du))));
}

// The children of a node from lane l on, as many as a vector holds.
struct NodeRows {
    VU middle_xy, half_xy, middle_half_z;

    HWY_INLINE NodeRows(const boxtree::Node& node, std::size_t l) {
        const DU du;
        middle_xy = hn::Load(du, node.middle_xy + l);
        half_xy = hn::Load(du, node.half_xy + l);
        middle_half_z = hn::Load(du, node.middle_half_z + l);
    }
};

// On which side of a plane the bounds lie, for certain.
struct NodeSide {
    MF outside, inside;

    HWY_INLINE NodeSide(const NodeRows& rows, const PairPlane& normal, BlockPlane plane) {
        const DF d;
        const DI di;
        const DU du;
        VI middle = add_products(hn::Set(di, plane.offset), rows.middle_xy, hn::Set(du, normal.xy));
        middle = add_products(middle, rows.middle_half_z, hn::Set(du, normal.z));
        VI projected_radius = add_products(hn::Zero(di), rows.half_xy, hn::Set(du, normal.size_xy));
        projected_radius = add_products(projected_radius, rows.middle_half_z, hn::Set(du, normal.size_z));
        outside = hn::RebindMask(d, hn::Lt(hn::Add(middle, projected_radius), hn::Set(di, -plane.error_bound)));
        inside = hn::RebindMask(d, hn::Gt(hn::Sub(middle, projected_radius), hn::Set(di, plane.error_bound)));
    }
};

// `normals` are along the node's axes.
HWY_INLINE NodeTest test_node(const KernelView& view, const ViewPlace& place, const PairPlane* normals,
                              const boxtree::Node& node, std::uint32_t planes) {
    const DU du;
    NodeTest result;
    result.alive = result.inside = 0;
    BlockPlane before[KernelView::kMaxPlanes];
    for (std::uint32_t rest = planes; rest; rest &= rest - 1) {
        const auto i = hwy::Num0BitsBelowLS1Bit_Nonzero32(rest);
        before[i] = block_plane(view, place, i, node);
    }
    for (std::size_t l = 0; l < boxtree::kWidth; l += hn::Lanes(du)) {
        const NodeRows rows(node, l);
        MF alive = present(view, node.layers_every, node.layers_any, node.count, l);
        VU straddled = hn::Set(du, planes);
        for (std::uint32_t rest = planes; rest; rest &= rest - 1) {
            const auto i = hwy::Num0BitsBelowLS1Bit_Nonzero32(rest);
            const NodeSide side(rows, normals[i], before[i]);
            alive = hn::AndNot(side.outside, alive);
            const VU bit = hn::Set(du, 1u << i);
            straddled = hn::AndNot(hn::IfThenElseZero(hn::RebindMask(du, side.inside), bit), straddled);
        }
        hn::Store(straddled, du, result.planes + l);
        result.alive |= bits_of(alive) << l;
        result.inside |= bits_of(hn::RebindMask(DF(), hn::Eq(straddled, hn::Zero(du)))) << l;
    }
    return result;
}

// Returns those of `lanes` below which every item is in a layer that the view sees.
HWY_INLINE std::uint32_t seen(const KernelView& view, const boxtree::Node& node, std::uint32_t lanes) {
    if (HWY_LIKELY(node.layers_every & view.layer_mask)) return lanes;
    std::uint32_t result = 0;
    for (std::uint32_t rest = lanes; rest; rest &= rest - 1) {
        const auto lane = static_cast<unsigned>(hwy::Num0BitsBelowLS1Bit_Nonzero32(rest));
        if (node.layers_all[lane] & view.layer_mask) result |= 1u << lane;
    }
    return result;
}

// Boxes in floats, from a list's records.
struct BoxLanes {
    VF x, y, z, unit;
    VF edge_error_bound;
    VF edge[9];  // in units
    MF present;

    // As slope(), with a normal for each lane.
    HWY_INLINE void slopes(const VF (&n)[3], VF (&result)[3]) const {
        for (unsigned k = 0; k < 3; ++k)
            result[k] =
                hn::MulAdd(n[0], edge[3 * k], hn::MulAdd(n[1], edge[3 * k + 1], hn::Mul(n[2], edge[3 * k + 2])));
    }

    // normal · edge k, in units.
    HWY_INLINE VF slope(const KernelPlane& plane, unsigned k) const {
        const DF d;
        const VF nx = hn::Set(d, plane.normal_f[0]), ny = hn::Set(d, plane.normal_f[1]),
                 nz = hn::Set(d, plane.normal_f[2]);
        return hn::MulAdd(nx, edge[3 * k], hn::MulAdd(ny, edge[3 * k + 1], hn::Mul(nz, edge[3 * k + 2])));
    }

    HWY_INLINE VF projected_radius(const KernelPlane& plane) const {
        const VF sum = hn::Add(hn::Add(hn::Abs(slope(plane, 0)), hn::Abs(slope(plane, 1))), hn::Abs(slope(plane, 2)));
        return hn::Mul(sum, unit);
    }

    HWY_INLINE VF error_bound(LocalPlane local) const {
        return hn::Add(edge_error_bound, hn::Set(DF(), local.error_bound));
    }
};

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
        const VF projected_radius = boxes.projected_radius(view.planes[i]), error_bound = boxes.error_bound(local[i]);
        const VF top = hn::Add(middle, projected_radius), bottom = hn::Sub(middle, projected_radius);
        const MF open = hn::Lt(bottom, error_bound);
        maybe = hn::And(maybe, hn::Ge(top, hn::Neg(error_bound)));
        passes = hn::And(passes, hn::Ge(top, error_bound));
        center = hn::And(center, hn::Ge(middle, error_bound));
        crosses = hn::Or(crosses, hn::Lt(bottom, hn::Neg(error_bound)));
        open_twice = hn::Or(open_twice, hn::And(open_once, open));
        open_once = hn::Or(open_once, open);
    }
    BoxTest result;
    result.false_positives = none;
    result.inside = hn::AndNot(open_once, boxes.present);
    const MF crossing = hn::And(passes, crosses);
    // A box that crosses one plane and lies inside all others meets the frustum; so does one whose centre is inside.
    const MF meets = exact ? hn::Or(hn::Not(open_twice), center) : boxes.present;
    result.straddling = hn::And(crossing, meets);
    result.needs_edge_test = hn::AndNot(meets, crossing);
    result.undecided = hn::AndNot(hn::Or(result.inside, crossing), maybe);
    return result;
}

}  // namespace crofton::cull::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
