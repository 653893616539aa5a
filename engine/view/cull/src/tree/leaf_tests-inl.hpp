// SPDX-License-Identifier: MIT
// The boxes of a leaf against planes, in integers. Compiled once per instruction set (Highway).
#include "tree/block_tests-inl.hpp"

#if defined(CROFTON_CULL_LEAF_TESTS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_CULL_LEAF_TESTS_INL
#undef CROFTON_CULL_LEAF_TESTS_INL
#else
#define CROFTON_CULL_LEAF_TESTS_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace crofton::cull::HWY_NAMESPACE {

// A plane before a leaf, in units of 2^-14 of a position_unit. A box's centre is offset + normal · (x, y, z) inside of
// it. `error_bound` bounds the error of that, and of the value at any other point of the box.
struct LeafPlane {
    const PairPlane* normal;
    BlockPlane at;
};

// The boxes of a leaf from lane l on, as many as a vector holds.
struct LeafRows {
    VU xy, z_edge2_z, edge01_z, edge_xy[3];
    int edge_shift;

    HWY_INLINE LeafRows(const boxtree::Leaf& leaf, std::size_t l) : edge_shift(leaf.edge_shift) {
        const DU du;
        xy = hn::Load(du, leaf.xy + l);
        z_edge2_z = hn::Load(du, leaf.z_edge2_z + l);
        edge01_z = hn::Load(du, leaf.edge01_z + l);
        for (unsigned k = 0; k < 3; ++k) edge_xy[k] = hn::Load(du, leaf.edge_xy[k] + l);
    }
};

// A plane's values on boxes: at the centres, along the half edges in units of 2^-14 of an edge_unit, and the sum of
// the latter's sizes as the centre's.
struct PlaneValues {
    VI middle, slope[3], projected_radius;

    HWY_INLINE PlaneValues(const LeafRows& rows, const LeafPlane& plane) {
        const DI di;
        const DU du;
        const VU xy = hn::Set(du, plane.normal->xy), z = hn::Set(du, plane.normal->z),
                 upper_z = hn::Set(du, plane.normal->z << 16);
        middle = add_products(add_products(hn::Set(di, plane.at.offset), rows.xy, xy), rows.z_edge2_z, z);
        slope[0] = add_products(add_products(hn::Zero(di), rows.edge_xy[0], xy), rows.edge01_z, z);
        slope[1] = add_products(add_products(hn::Zero(di), rows.edge_xy[1], xy), rows.edge01_z, upper_z);
        slope[2] = add_products(add_products(hn::Zero(di), rows.edge_xy[2], xy), rows.z_edge2_z, upper_z);
        const VI sum = hn::Add(hn::Add(hn::Abs(slope[0]), hn::Abs(slope[1])), hn::Abs(slope[2]));
        projected_radius = hn::ShiftRightSame(sum, rows.edge_shift);
    }
};

// One plane's verdict. With m the centre's value and r the projected radius ≥ 0, the numbers below are all in range.
struct PlaneTest {
    MF cuts;    // certainly
    MF unsure;  // whether the plane cuts the box
    MF inside;  // the box is, as a whole, for certain

    HWY_INLINE PlaneTest(const PlaneValues& values, VI error_bound) {
        const DI di;
        const DF d;
        const VI across = hn::Sub(values.projected_radius, hn::Abs(values.middle));
        const VI bottom =
            hn::Sub(hn::Max(values.middle, hn::Zero(di)), values.projected_radius);  // where that is above 0
        cuts = hn::RebindMask(d, hn::Gt(across, error_bound));
        unsure = hn::Not(hn::RebindMask(d, hn::Gt(hn::Abs(across), error_bound)));
        inside = hn::RebindMask(d, hn::Gt(bottom, error_bound));
    }
};

// Most leaves that cross a frustum cross one plane; then a box that straddles it meets the frustum for certain.
HWY_INLINE BoxTest test_leaf(const LeafRows& rows, MF present, const LeafPlane& plane) {
    const PlaneTest test(PlaneValues(rows, plane), hn::Set(DI(), plane.at.error_bound));
    BoxTest result;
    result.straddling = hn::And(present, test.cuts);
    result.inside = hn::And(present, test.inside);
    result.undecided = hn::And(present, test.unsure);
    result.needs_edge_test = result.false_positives = hn::FirstN(DF(), 0);
    return result;
}

// The planes in the boxes' own coordinates. The conversions to floats and the sums in them: 2^-20 of |base| + radius.
HWY_INLINE BoxRows box_rows(const LeafRows& boxes, const LeafPlane* planes, unsigned count, MF wanted) {
    const DF d;
    const auto exponent = static_cast<std::uint32_t>(127 - boxes.edge_shift) << 23;  // of 2^-edge_shift
    BoxRows result(hn::BitCast(d, hn::Set(DU(), exponent)));
    for (unsigned i = 0; i < count; ++i) {
        const PlaneValues values(boxes, planes[i]);
        BoxRows::Row& row = result.rows[result.count];
        row.base = hn::ConvertTo(d, values.middle);
        row.projected_radius = hn::Zero(d);
        for (unsigned k = 0; k < 3; ++k) {
            row.slope[k] = hn::ConvertTo(d, values.slope[k]);
            row.projected_radius = hn::Add(row.projected_radius, hn::Abs(row.slope[k]));
        }
        const VF size = hn::MulAdd(row.projected_radius, result.unit, hn::Abs(row.base));
        row.error_bound =
            hn::MulAdd(size, hn::Set(d, 0x1p-20f), hn::Set(d, static_cast<float>(planes[i].at.error_bound)));
        result.keep_next(wanted);
    }
    return result;
}

// Not inlined, and without vectors as arguments, so that the caller keeps its own in registers.
static HWY_NOINLINE void resolve_leaf(const boxtree::Leaf& leaf, std::size_t l, const LeafPlane* planes, unsigned count,
                                      BoxTest& test) {
    resolve(box_rows(LeafRows(leaf, l), planes, count, test.needs_edge_test), test);
}

// Tests a leaf against two planes or more. In the exact mode a box that crosses two of them goes to the second stage,
// unless its centre is inside all.
HWY_INLINE BoxTest test_leaf(const boxtree::Leaf& leaf, std::size_t l, MF present, const LeafPlane* planes,
                             unsigned count, bool exact) {
    const DF d;
    const MF none = hn::FirstN(d, 0);
    const LeafRows rows(leaf, l);
    MF maybe = present, unsure = none, once = none, twice = none, center = present;
    for (unsigned i = 0; i < count; ++i) {
        const VI error_bound = hn::Set(DI(), planes[i].at.error_bound);
        const PlaneValues values(rows, planes[i]);
        const PlaneTest test(values, error_bound);
        maybe = hn::And(maybe, hn::Or(hn::Or(test.inside, test.cuts), test.unsure));
        unsure = hn::Or(unsure, test.unsure);
        twice = hn::Or(twice, hn::And(once, test.cuts));
        once = hn::Or(once, test.cuts);
        center = hn::And(center, hn::RebindMask(d, hn::Gt(values.middle, error_bound)));
    }
    BoxTest result;
    const MF sure = hn::AndNot(unsure, maybe);
    result.undecided = hn::And(unsure, maybe);
    result.inside = hn::AndNot(once, sure);
    result.false_positives = result.needs_edge_test = none;
    result.straddling = hn::And(once, sure);
    if (!exact) return result;
    result.needs_edge_test = hn::AndNot(center, hn::And(twice, sure));
    if (hn::AllFalse(d, result.needs_edge_test)) return result;
    result.straddling = hn::AndNot(result.needs_edge_test, result.straddling);
    resolve_leaf(leaf, l, planes, count, result);
    return result;
}

}  // namespace crofton::cull::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
