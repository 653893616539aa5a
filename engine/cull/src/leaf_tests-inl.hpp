// The boxes of a leaf against planes, in integers. Compiled once per instruction set (Highway).
#include "block_tests-inl.hpp"

#if defined(CROFTON_CULL_LEAF_TESTS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_CULL_LEAF_TESTS_INL
#undef CROFTON_CULL_LEAF_TESTS_INL
#else
#define CROFTON_CULL_LEAF_TESTS_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace crofton::cull::HWY_NAMESPACE {

// A plane before a leaf: in units of 2^-14 of a position_unit, a box's centre is offset + normal · (x, y, z) inside of
// it, and `slack` bounds what that and the box's reach together may be off by.
//   The position's rounding, half a unit along each axis: 2^13 · Σ|normal| ≤ 2^13 · √3 · 1.0005 < 0.87 · 2^14.
//   The normal's, half a unit of 2^-14 each: half of |x| + |y| + |z|, 2^-15 · reach in world units.
//   Three edges, no component of which is beyond 2^15: their rounding, 0.502 of a unit, as the position's; and the
//   normal's, half of the nine components' sum. In all less than 12 · 2^14 units of 2^-14 of an edge_unit. The
//   offset's, seven roundings of 2^-53 of Σ|origin − view| + |plane offset| as in local_plane; `far` says how much for
//   any leaf whose boxes lie in the root's bounds, but for the leaf's own reach, which the reach's share above has room
//   for. 1 each for the offset's truncation, the shift from the edges' units to the position's and the slack's own
//   truncation.
// Where the sums, |offset| + 2^14 · 1.0005 · √3 · 32767, would leave 32 bits, a plane says nothing.
struct LeafPlane {
    const PairPlane* normal;
    std::int32_t offset, slack;
};

class LeafPlaneMaker {
  public:
    HWY_INLINE LeafPlaneMaker(const KernelView& view, const tree::Node& root) : view_(view) {
        const LocalOrigin at = local_origin(view, root.origin, root.reach);
        for (std::uint32_t i = 0; i < view.plane_count; ++i)
            far_[i] = 0x1p-49 * (at.size + at.reach + std::fabs(view.planes[i].offset));
    }

    HWY_INLINE LeafPlane operator()(std::size_t i, const tree::Leaf& leaf) const {
        constexpr double kMost = 1.2e9;
        const KernelPlane& plane = view_.planes[i];
        const double per_quantum = inverse_quantum(leaf.position_unit);
        const double x = leaf.origin[0] - view_.origin[0], y = leaf.origin[1] - view_.origin[1],
                     z = leaf.origin[2] - view_.origin[2];
        const double value = plane.normal[0] * x + plane.normal[1] * y + plane.normal[2] * z + plane.offset;
        const double offset = value * per_quantum;
        // A float's roundings of five sums and products: 2^-21.
        const float roundings = leaf.position_unit + 12.0f * leaf.edge_unit + 0x1.01p-15f * leaf.reach;
        const double slack = (static_cast<double>(roundings) * (1.0 + 0x1p-20) + far_[i]) * per_quantum + 3.0;
        if (HWY_UNLIKELY(!(std::fabs(offset) <= kMost && slack <= kMost)))
            return {&view_.pair_planes[i], 0, 0x7fffffff};
        return {&view_.pair_planes[i], static_cast<std::int32_t>(offset), static_cast<std::int32_t>(slack)};
    }

  private:
    const KernelView& view_;
    double far_[KernelView::kMaxPlanes];
};

// Lanes l on of a leaf.
struct LeafRows {
    VU xy, z_edge2_z, edge01_z, edge_xy[3];
    int shift;  // a position_unit is 2^shift edge_units
    MF present;

    HWY_INLINE LeafRows(const KernelView& view, const tree::Leaf& leaf, std::size_t l) {
        const DU du;
        xy = hn::Load(du, leaf.xy + l);
        z_edge2_z = hn::Load(du, leaf.z_edge2_z + l);
        edge01_z = hn::Load(du, leaf.edge01_z + l);
        for (unsigned k = 0; k < 3; ++k) edge_xy[k] = hn::Load(du, leaf.edge_xy[k] + l);
        shift = std::min(31, exponent_of(leaf.position_unit) - exponent_of(leaf.edge_unit));
        present = HWY_NAMESPACE::present(view, leaf.layers_every, leaf.layers, leaf.count, l);
    }

    HWY_INLINE VI middle(const LeafPlane& plane) const {
        const DU du;
        const VI sum = add_products(hn::Set(DI(), plane.offset), xy, hn::Set(du, plane.normal->xy));
        return add_products(sum, z_edge2_z, hn::Set(du, plane.normal->z));
    }
    // normal · edge k, in units of 2^-14 of an edge_unit.
    HWY_INLINE VI slope(const LeafPlane& plane, unsigned k) const {
        const DU du;
        const VI sum = add_products(hn::Zero(DI()), edge_xy[k], hn::Set(du, plane.normal->xy));
        const VU lower = hn::Set(du, plane.normal->z), upper = hn::Set(du, plane.normal->z << 16);
        if (k == 2) return add_products(sum, z_edge2_z, upper);
        return add_products(sum, edge01_z, k == 0 ? lower : upper);
    }
    HWY_INLINE VI reach(const LeafPlane& plane) const {
        const VI sum = hn::Add(hn::Add(hn::Abs(slope(plane, 0)), hn::Abs(slope(plane, 1))), hn::Abs(slope(plane, 2)));
        return hn::ShiftRightSame(sum, shift);
    }
};

// One plane's word. With s the centre's value and r the reach, both ≥ 0 but for the sign of s: r − |s| is in range,
// and positive where the plane cuts the box.
struct PlaneTest {
    MF cuts;      // certainly
    MF clear;     // certainly not; then the box is inside of the plane iff
    MF positive;  // the centre is

    HWY_INLINE PlaneTest(const LeafRows& rows, const LeafPlane& plane) {
        const DI di;
        const DF d;
        const VI middle = rows.middle(plane);
        const VI across = hn::Sub(rows.reach(plane), hn::Abs(middle));
        cuts = hn::RebindMask(d, hn::Gt(across, hn::Set(di, plane.slack)));
        clear = hn::RebindMask(d, hn::Lt(across, hn::Set(di, -plane.slack)));
        positive = hn::RebindMask(d, hn::Gt(middle, hn::Zero(di)));
    }
};

// Most leaves that cross a frustum cross one plane; then a box that straddles it meets the frustum for certain.
HWY_INLINE BoxTest test_leaf(const LeafRows& rows, const LeafPlane& plane) {
    const PlaneTest test(rows, plane);
    BoxTest result;
    result.straddling = hn::And(rows.present, test.cuts);
    result.inside = hn::And(rows.present, hn::And(test.clear, test.positive));
    result.undecided = hn::AndNot(hn::Or(test.cuts, test.clear), rows.present);
    result.unsettled = result.improper = hn::FirstN(DF(), 0);
    return result;
}

// The planes in the boxes' own coordinates. The conversions to floats and the sums in them: 2^-20 of |base| + reach.
HWY_INLINE BoxRows box_rows(const LeafRows& boxes, const LeafPlane* planes, unsigned count) {
    const DF d;
    BoxRows result(hn::Set(d, std::ldexp(1.0f, -boxes.shift)));
    result.count = count;
    for (unsigned i = 0; i < count; ++i) {
        BoxRows::Row& row = result.rows[i];
        row.base = hn::ConvertTo(d, boxes.middle(planes[i]));
        row.reach = hn::Zero(d);
        for (unsigned k = 0; k < 3; ++k) {
            row.slope[k] = hn::ConvertTo(d, boxes.slope(planes[i], k));
            row.reach = hn::Add(row.reach, hn::Abs(row.slope[k]));
        }
        const VF size = hn::MulAdd(row.reach, result.unit, hn::Abs(row.base));
        row.slack = hn::MulAdd(size, hn::Set(d, 0x1p-20f), hn::Set(d, static_cast<float>(planes[i].slack)));
    }
    return result;
}

HWY_NOINLINE void settle_leaf(const LeafRows& boxes, const LeafPlane* planes, unsigned count, BoxTest& test) {
    settle(box_rows(boxes, planes, count), test);
}

// In the exact mode a box that crosses two planes or more is asked for a common point, unless its centre is one.
HWY_INLINE BoxTest test_leaf(const LeafRows& rows, const LeafPlane* planes, unsigned count, bool exact) {
    const DF d;
    const MF none = hn::FirstN(d, 0);
    MF outside = none, unsure = none, once = none, twice = none, center = rows.present;
    for (unsigned i = 0; i < count; ++i) {
        const PlaneTest test(rows, planes[i]);
        outside = hn::Or(outside, hn::AndNot(test.positive, test.clear));
        unsure = hn::Or(unsure, hn::Not(hn::Or(test.cuts, test.clear)));
        twice = hn::Or(twice, hn::And(once, test.cuts));
        once = hn::Or(once, test.cuts);
        const auto within = hn::Gt(rows.middle(planes[i]), hn::Set(DI(), planes[i].slack));
        center = hn::And(center, hn::RebindMask(d, within));
    }
    BoxTest result;
    const MF maybe = hn::AndNot(outside, rows.present);
    const MF sure = hn::AndNot(unsure, maybe);
    result.undecided = hn::And(unsure, maybe);
    result.inside = hn::AndNot(once, sure);
    result.improper = result.unsettled = none;
    result.straddling = hn::And(once, sure);
    if (!exact) return result;
    result.unsettled = hn::AndNot(center, hn::And(twice, sure));
    if (hn::AllFalse(d, result.unsettled)) return result;
    result.straddling = hn::AndNot(result.unsettled, result.straddling);
    settle_leaf(rows, planes, count, result);
    return result;
}

}  // namespace crofton::cull::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
