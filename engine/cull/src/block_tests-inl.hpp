// Nodes and leaves against one view's planes, 16 lanes at a time. Compiled once per instruction set (Highway).
#include "kernel_view.hpp"
#include "lanes-inl.hpp"
#include "second_stage-inl.hpp"

#if defined(CROFTON_CULL_BLOCK_TESTS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_CULL_BLOCK_TESTS_INL
#undef CROFTON_CULL_BLOCK_TESTS_INL
#else
#define CROFTON_CULL_BLOCK_TESTS_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace crofton::cull::HWY_NAMESPACE {

struct NodeTest {
    std::uint32_t settled;                 // lanes that are certainly inside of all planes
    std::uint32_t alive;                   // lanes that no plane certainly rejects and that share a layer with the view
    alignas(64) std::uint32_t planes[16];  // per lane, those of the planes that it is not certainly inside of
};

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
    const DI di;
    NodeTest result;
    result.alive = result.settled = 0;
    const LocalOrigin at = local_origin(view, node.origin, node.reach);
    IntegerPlane rows[KernelView::kMaxPlanes];
    for (std::uint32_t rest = planes; rest; rest &= rest - 1) {
        const auto i = hwy::Num0BitsBelowLS1Bit_Nonzero32(rest);
        rows[i] = integer_plane(view.planes[i], at, inverse_quantum(node.unit));
    }
    for (std::size_t l = 0; l < tree::kWidth; l += hn::Lanes(d)) {
        const VU middle_xy = hn::Load(du, node.middle_xy + l), half_xy = hn::Load(du, node.half_xy + l),
                 middle_half_z = hn::Load(du, node.middle_half_z + l);
        MF alive = present(view, node.layers_every, node.layers_any, node.count, l);
        VU straddled = hn::Set(du, planes);
        for (std::uint32_t rest = planes; rest; rest &= rest - 1) {
            const auto i = hwy::Num0BitsBelowLS1Bit_Nonzero32(rest);
            const PairPlane& plane = view.pair_planes[i];
            VI middle = add_products(hn::Set(di, rows[i].offset), middle_xy, hn::Set(du, plane.xy));
            middle = add_products(middle, middle_half_z, hn::Set(du, plane.z));
            VI reach = add_products(hn::Zero(di), half_xy, hn::Set(du, plane.size_xy));
            reach = add_products(reach, middle_half_z, hn::Set(du, plane.size_z));
            const auto outside = hn::Lt(hn::Add(middle, reach), hn::Set(di, -rows[i].slack));
            alive = hn::AndNot(hn::RebindMask(d, outside), alive);
            const auto inside = hn::Gt(hn::Sub(middle, reach), hn::Set(di, rows[i].slack));
            const VU bit = hn::Set(du, 1u << i);
            straddled = hn::AndNot(hn::IfThenElseZero(hn::RebindMask(du, inside), bit), straddled);
        }
        hn::Store(straddled, du, result.planes + l);
        result.alive |= bits_of(alive) << l;
        result.settled |= bits_of(hn::RebindMask(d, hn::Eq(straddled, hn::Zero(du)))) << l;
    }
    return result;
}

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
