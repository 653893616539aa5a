// SPDX-License-Identifier: MIT
// The second stage for spheres, 16 lanes at a time. Compiled once per instruction set (Highway).
#include "tree/block_tests-inl.hpp"

#if defined(CROFTON_CULL_SPHERE_TESTS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_CULL_SPHERE_TESTS_INL
#undef CROFTON_CULL_SPHERE_TESTS_INL
#else
#define CROFTON_CULL_SPHERE_TESTS_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace crofton::cull::HWY_NAMESPACE {

struct SphereLanes {
    VF x, y, z, radius;
    MF present;

    HWY_INLINE VF projected_radius(const KernelPlane& plane) const {
        return hn::Mul(radius, hn::Set(DF(), plane.length_f));
    }
    // The radius, the normal's length and their product round by 2^-24 of the result each, the sums with it by as much.
    HWY_INLINE VF error_bound(LocalPlane local) const {
        return hn::MulAdd(radius, hn::Set(DF(), 0x1p-20f), hn::Set(DF(), local.error_bound));
    }
};

// A plane's value at the centre is off by its error bound at most; so it is at the centre + v, |v| ≤ radius.
struct SphereRow {
    const KernelPlane* plane;
    VF base, error_bound;
};

// Returns the wanted lanes that certainly have a point inside all planes. The search steps from the centre onto the
// plane that is missed by most, a little beyond it, again and again. 2^-16 covers the roundings of |v|² and of the
// radius. Radii whose squares might overflow, or underflow to where floats lose digits, are left to exact arithmetic.
HWY_INLINE MF has_witness(const SphereLanes& spheres, const SphereRow* rows, unsigned count, MF wanted) {
    const DF d;
    wanted =
        hn::And(wanted, hn::And(hn::Ge(spheres.radius, hn::Set(d, 1e-15f)), hn::Le(spheres.radius, hn::Set(d, 1e18f))));
    VF v[3] = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
    const VF most = hn::Mul(hn::Mul(spheres.radius, spheres.radius), hn::Set(d, 1.0f - 0x1p-16f));
    MF found = hn::FirstN(d, 0);
    for (int round = 0;; ++round) {
        VF worst = hn::Set(d, 3e38f), normal[3] = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
        const VF square = hn::MulAdd(v[0], v[0], hn::MulAdd(v[1], v[1], hn::Mul(v[2], v[2])));
        MF inside = hn::And(wanted, hn::Le(square, most));
        for (unsigned i = 0; i < count; ++i) {
            const float* n = rows[i].plane->normal_f;
            const VF value =
                hn::MulAdd(hn::Set(d, n[0]), v[0],
                           hn::MulAdd(hn::Set(d, n[1]), v[1], hn::MulAdd(hn::Set(d, n[2]), v[2], rows[i].base)));
            inside = hn::And(inside, hn::Ge(value, rows[i].error_bound));
            const MF worse = hn::Lt(value, worst);
            worst = hn::IfThenElse(worse, value, worst);
            for (unsigned k = 0; k < 3; ++k) normal[k] = hn::IfThenElse(worse, hn::Set(d, n[k]), normal[k]);
        }
        found = hn::Or(found, inside);
        if (round == 6 || hn::AllFalse(d, hn::AndNot(found, wanted))) return found;
        const VF step = hn::MulAdd(spheres.radius, hn::Set(d, 0x1p-6f), hn::Neg(worst));
        for (unsigned k = 0; k < 3; ++k) v[k] = hn::MulAdd(step, normal[k], v[k]);
    }
}

// Returns the wanted lanes that two planes together certainly exclude: λ_a s_a + λ_b s_b + radius |λ_a n_a + λ_b n_b|
// < 0 for some λ ≥ 0 (sphere.cpp). The square of the length rounds by less than 2^-20 (λ_a + λ_b)², the rest by less
// than 2^-19 relative to each term. What underflow eats is far below 1e-30, and sums near overflow prove nothing.
HWY_INLINE MF is_excluded(const SphereLanes& spheres, const SphereRow* rows, unsigned count, MF wanted) {
    const DF d;
    const VF zero = hn::Zero(d), trifle = hn::Set(d, 0x1p-19f);
    const VF radius = hn::Mul(spheres.radius, hn::Set(d, 1.0f + 0x1p-18f));
    MF excluded = hn::FirstN(d, 0);
    for (unsigned i = 0; i < count; ++i)
        for (unsigned j = i + 1; j < count; ++j) {
            const SphereRow &a = rows[i], &b = rows[j];
            const float *n = a.plane->normal_f, *m = b.plane->normal_f;
            const VF product = hn::Set(d, n[0] * m[0] + n[1] * m[1] + n[2] * m[2]);
            const VF square_a = hn::Set(d, a.plane->length_f * a.plane->length_f),
                     square_b = hn::Set(d, b.plane->length_f * b.plane->length_f);
            const VF weight_a = hn::Max(zero, hn::Sub(hn::Mul(product, b.base), a.base)),
                     weight_b = hn::Max(zero, hn::Sub(hn::Mul(product, a.base), b.base));
            const VF sum = hn::Add(weight_a, weight_b);
            VF square =
                hn::MulAdd(hn::Mul(weight_a, weight_a), square_a, hn::Mul(hn::Mul(weight_b, weight_b), square_b));
            square = hn::MulAdd(hn::Mul(hn::Add(weight_a, weight_a), weight_b), product, square);
            square = hn::Max(zero, hn::MulAdd(hn::Mul(sum, sum), hn::Set(d, 0x1p-20f), square));
            const VF top_a = hn::Add(a.base, hn::MulAdd(hn::Abs(a.base), trifle, a.error_bound)),
                     top_b = hn::Add(b.base, hn::MulAdd(hn::Abs(b.base), trifle, b.error_bound));
            const VF bound =
                hn::MulAdd(weight_a, top_a, hn::MulAdd(weight_b, top_b, hn::Mul(radius, hn::Sqrt(square))));
            excluded = hn::Or(excluded, hn::And(hn::Lt(bound, hn::Set(d, -1e-30f)), hn::Gt(bound, hn::Set(d, -1e37f))));
        }
    return hn::And(excluded, wanted);
}

HWY_INLINE void resolve(const KernelView& view, const SphereLanes& spheres, std::uint32_t planes,
                        const LocalPlane* local, BoxTest& test) {
    const DF d;
    SphereRow rows[KernelView::kMaxPlanes];
    unsigned count = 0;
    for (std::uint32_t rest = planes; rest; rest &= rest - 1) {
        const auto i = hwy::Num0BitsBelowLS1Bit_Nonzero32(rest);
        rows[count++] = {&view.planes[i], plane_value(view.planes[i], spheres.x, spheres.y, spheres.z, local[i].offset),
                         spheres.error_bound(local[i])};
    }
    const MF meets = has_witness(spheres, rows, count, test.needs_edge_test);
    test.straddling = hn::Or(test.straddling, meets);
    test.needs_edge_test = hn::AndNot(meets, test.needs_edge_test);
    if (!hn::AllFalse(d, test.needs_edge_test))
        test.false_positives = is_excluded(spheres, rows, count, test.needs_edge_test);
    test.undecided = hn::Or(test.undecided, hn::AndNot(test.false_positives, test.needs_edge_test));
}

}  // namespace crofton::cull::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
