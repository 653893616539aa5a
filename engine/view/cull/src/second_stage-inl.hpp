// SPDX-License-Identifier: MIT
// Boxes that cross two planes or more: do they meet the frustum? Compiled once per instruction set (Highway).
#include "kernel_view.hpp"
#include "lanes-inl.hpp"

#if defined(CROFTON_CULL_SECOND_STAGE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_CULL_SECOND_STAGE_INL
#undef CROFTON_CULL_SECOND_STAGE_INL
#else
#define CROFTON_CULL_SECOND_STAGE_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace crofton::cull::HWY_NAMESPACE {

// Lanes of boxes: what the filter knows of them.
struct BoxTest {
    MF inside;           // certainly inside
    MF straddling;       // certainly straddling (and, in the exact mode, meeting the frustum)
    MF needs_edge_test;  // certainly not rejected by a plane, certainly not inside; whether they meet the frustum is
                         // open
    MF undecided;        // the rest of those that are not certainly outside
    MF false_positives;  // rejected by no plane, and certainly outside all the same
};

HWY_INLINE VF plane_value(const KernelPlane& plane, VF x, VF y, VF z, float offset) {
    const DF d;
    return hn::MulAdd(
        hn::Set(d, plane.normal_f[0]), x,
        hn::MulAdd(hn::Set(d, plane.normal_f[1]), y, hn::MulAdd(hn::Set(d, plane.normal_f[2]), z, hn::Set(d, offset))));
}

// Planes in the boxes' own coordinates: plane i is f_i(t) = base_i + unit · Σ slope_ik t_k ≥ 0 on the cube |t| ≤ 1, and
// error_bound_i bounds the error of f_i anywhere there.
struct BoxRows {
    struct Row {
        VF base, error_bound, projected_radius, slope[3];
    };
    Row rows[KernelView::kMaxPlanes];
    std::uint32_t
        cut[KernelView::kMaxPlanes],  // bit l: lane l is wanted, and its box not certainly inside of the plane
        out[KernelView::kMaxPlanes];  // besides, the box's centre is not
    unsigned count = 0;
    VF unit;

    HWY_INLINE explicit BoxRows(VF unit_of_boxes) : unit(unit_of_boxes) {}
    template <class Lanes>
    HWY_INLINE BoxRows(const KernelView& view, const Lanes& boxes, std::uint32_t planes, const LocalPlane* local)
        : unit(boxes.unit) {
        for (std::uint32_t rest = planes; rest; rest &= rest - 1) {
            const auto i = hwy::Num0BitsBelowLS1Bit_Nonzero32(rest);
            Row& row = rows[count];
            row.base = plane_value(view.planes[i], boxes.x, boxes.y, boxes.z, local[i].offset);
            row.error_bound = boxes.error_bound(local[i]);
            row.projected_radius = hn::Zero(DF());
            for (unsigned k = 0; k < 3; ++k) {
                row.slope[k] = boxes.slope(view.planes[i], k);
                row.projected_radius = hn::Add(row.projected_radius, hn::Abs(row.slope[k]));
            }
            keep_next(boxes.present);
        }
    }

    // Adds the row that was written behind the last, unless all wanted boxes are certainly inside of its plane.
    HWY_INLINE void keep_next(MF wanted) {
        set_bits(count, wanted);
        count += cut[count] != 0;
    }

    // Finds which of the wanted boxes each plane cuts, from the rows that are set.
    HWY_INLINE void keep_first(unsigned rows_set, MF wanted) {
        for (count = 0; count < rows_set; ++count) set_bits(count, wanted);
    }

  private:
    HWY_INLINE void set_bits(unsigned i, MF wanted) {
        const Row& row = rows[i];
        const VF size = hn::MulAdd(row.projected_radius, unit, hn::Abs(row.base));
        const VF bottom = hn::Sub(row.base, hn::Mul(row.projected_radius, unit));
        cut[i] = bits_of(hn::And(wanted, hn::Lt(bottom, hn::MulAdd(size, hn::Set(DF(), 0x1p-19f), row.error_bound))));
        out[i] = cut[i] & bits_of(hn::Lt(row.base, row.error_bound));
    }
};

// Returns the wanted lanes whose boxes certainly have a point inside all planes. The search starts at the centre. Each
// step goes to a little beyond the plane that the point is farthest outside of. A coordinate that has reached a face
// stays there while the step leads out across it. Of the boxes that cross an edge of the frustum about one in fifty
// needs more than six steps.
HWY_INLINE MF has_witness(const BoxRows& box, MF wanted) {
    const DF d;
    const VF zero = hn::Zero(d), one = hn::Set(d, 1.0f);
    VF t[3] = {zero, zero, zero};
    MF found = hn::FirstN(d, 0);
    const std::uint32_t wanted_bits = bits_of(wanted);
    unsigned cutting[KernelView::kMaxPlanes], count = 0;  // the planes that may cut one of the wanted boxes
    for (unsigned i = 0; i < box.count; ++i) {
        cutting[count] = i;
        count += (box.cut[i] & wanted_bits) != 0;
    }
    for (int round = 0;; ++round) {
        VF worst = hn::Set(d, 3e38f), projected_radius = zero, slope[3] = {zero, zero, zero};
        MF inside = wanted;
        for (unsigned n = 0; n < count; ++n) {
            const auto& row = box.rows[cutting[n]];
            const VF along =
                hn::MulAdd(row.slope[0], t[0], hn::MulAdd(row.slope[1], t[1], hn::Mul(row.slope[2], t[2])));
            const VF value = hn::MulAdd(along, box.unit, row.base);
            inside = hn::And(inside, hn::Ge(value, row.error_bound));
            const MF worse = hn::Lt(value, worst);
            worst = hn::IfThenElse(worse, value, worst);
            projected_radius = hn::IfThenElse(worse, row.projected_radius, projected_radius);
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
        const VF beyond = hn::MulAdd(hn::Mul(projected_radius, box.unit), hn::Set(d, 0.05f), hn::Neg(worst));
        const VF step = hn::Div(beyond, hn::Mul(square, box.unit));
        for (unsigned k = 0; k < 3; ++k) t[k] = hn::Max(hn::Neg(one), hn::Min(one, hn::MulAdd(step, slope[k], t[k])));
    }
    return found;
}

// The verdict on boxes by pairs of planes.
struct PairTest {
    MF separated;  // certainly outside
    MF met;        // certainly met by every two of the planes; so, if no third one cuts the box, by all
};

// A sum with weights ≥ 0 of two f_i that is negative on the whole cube is a proof that the box is outside. Its largest
// value on the cube is convex and piecewise linear in the weights. So the least of all is that of one plane alone, or
// is found where one slope vanishes: a separating axis across an edge of the frustum and one of the box. If it is ≥ 0,
// the box meets both half-spaces at once (minimax). For any weights the sum's largest value is within Σ weight ·
// error_bound of what the floats of f_i, f_j give. Evaluating it here, at weights that are rounded too, is off by at
// most ten times 2^-24 of Σ weight · (|base| + radius), which is below 2^-19. What underflow eats is far below 1e-30.
// The difference of a convex function and that linear bound is convex, with the same corners.
HWY_INLINE PairTest test_pairs(const BoxRows& box, MF wanted) {
    const DF d;
    const VF zero = hn::Zero(d), tiny = hn::Set(d, 1e-30f);
    VF top[KernelView::kMaxPlanes], low[KernelView::kMaxPlanes];  // base with all that it may be off by
    for (unsigned i = 0; i < box.count; ++i) {
        const auto& row = box.rows[i];
        const VF size = hn::MulAdd(row.projected_radius, box.unit, hn::Abs(row.base));
        const VF error = hn::MulAdd(size, hn::Set(d, 0x1p-19f), row.error_bound);
        top[i] = hn::Add(row.base, error);
        low[i] = hn::Sub(row.base, error);
    }
    PairTest result{hn::FirstN(d, 0), wanted};
    for (unsigned i = 0; i < box.count; ++i)
        for (unsigned j = i + 1; j < box.count; ++j) {
            // Where a box is inside of one of the two, they exclude it only if the other does alone. Where its centre
            // is inside of both, it meets both.
            if ((box.cut[i] & box.cut[j] & (box.out[i] | box.out[j])) == 0) continue;
            const VF(&a)[3] = box.rows[i].slope;
            const VF(&b)[3] = box.rows[j].slope;
            for (unsigned k = 0; k < 3; ++k) {
                const unsigned p = (k + 1) % 3, q = (k + 2) % 3;
                const VF weight_a = hn::Abs(b[k]), weight_b = hn::Abs(a[k]);
                const VF along_p = hn::MulAdd(weight_a, a[p], hn::Mul(weight_b, b[p])),
                         along_q = hn::MulAdd(weight_a, a[q], hn::Mul(weight_b, b[q]));
                const VF projected_radius = hn::Mul(hn::Add(hn::Abs(along_p), hn::Abs(along_q)), box.unit);
                const VF most = hn::MulAdd(weight_a, top[i], hn::MulAdd(weight_b, top[j], projected_radius));
                const VF least = hn::MulAdd(weight_a, low[i], hn::MulAdd(weight_b, low[j], projected_radius));
                const MF opposed = hn::Xor(hn::Lt(a[k], zero), hn::Lt(b[k], zero));
                result.separated = hn::Or(result.separated, hn::And(opposed, hn::Lt(most, hn::Neg(tiny))));
                result.met = hn::AndNot(hn::AndNot(hn::Gt(least, tiny), opposed), result.met);
            }
        }
    result.separated = hn::And(result.separated, wanted);
    return result;
}

// Wanted lanes that at most two of the planes may cut: the whole cube is inside of the others.
HWY_INLINE MF cut_twice_at_most(const BoxRows& box, MF wanted) {
    std::uint32_t once = 0, twice = 0, thrice = 0;
    for (unsigned i = 0; i < box.count; ++i) {
        thrice |= twice & box.cut[i];
        twice |= once & box.cut[i];
        once |= box.cut[i];
    }
    return hn::AndNot(hn::RebindMask(DF(), mask_of(thrice)), wanted);
}

// The second stage, for boxes that no plane certainly rejects. What it cannot resolve is undecided.
HWY_INLINE void resolve(const BoxRows& box, BoxTest& test) {
    const DF d;
    const PairTest pairs = test_pairs(box, test.needs_edge_test);
    test.false_positives = pairs.separated;
    MF meets = hn::And(pairs.met, cut_twice_at_most(box, test.needs_edge_test));
    const MF rest = hn::AndNot(hn::Or(meets, pairs.separated), test.needs_edge_test);
    if (!hn::AllFalse(d, rest)) meets = hn::Or(meets, has_witness(box, rest));
    test.straddling = hn::Or(test.straddling, meets);
    test.undecided = hn::Or(test.undecided, hn::AndNot(hn::Or(meets, pairs.separated), test.needs_edge_test));
    test.needs_edge_test = hn::FirstN(d, 0);
}

template <class Lanes>
HWY_INLINE void resolve(const KernelView& view, const Lanes& boxes, std::uint32_t planes, const LocalPlane* local,
                        BoxTest& test) {
    resolve(BoxRows(view, boxes, planes, local), test);
}

}  // namespace crofton::cull::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
