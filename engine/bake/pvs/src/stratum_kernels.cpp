// SPDX-License-Identifier: MIT
#include "stratum_kernels.hpp"

#include <crofton/geometry/trigonometry.hpp>
#include <numbers>

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace crofton::pvs::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::CappedTag<double, 8>;
using V = hn::Vec<D>;
using DU = hn::RebindToUnsigned<D>;

// Integers below 2^32, exactly.
HWY_INLINE V to_double(D d, hn::Vec<DU> x) {
    const V big = hn::Set(d, 0x1p52);
    return hn::Sub(hn::BitCast(d, hn::Or(x, hn::BitCast(DU(), big))), big);
}

HWY_INLINE V polynomial(D d, const double (&c)[8], V y) {
    V sum = hn::Set(d, c[7]);
    for (std::size_t k = 7; k-- > 0;) sum = hn::Add(hn::Mul(sum, y), hn::Set(d, c[k]));
    return sum;
}

// sampling::circle_point, for u in [0, 1].
HWY_INLINE void circle_point(D d, V u, V* x, V* y) {
    const V one = hn::Set(d, 1.0);
    const V quarter = hn::Floor(hn::Add(hn::Mul(hn::Set(d, 4.0), u), hn::Set(d, 0.5)));
    const V rest = hn::Mul(hn::Set(d, 2.0 * std::numbers::pi), hn::Sub(u, hn::Mul(hn::Set(d, 0.25), quarter)));
    const V square = hn::Mul(rest, rest);
    const V c = hn::Add(one, hn::Mul(square, polynomial(d, crofton::detail::kCosineTerms, square)));
    const V s = hn::Add(rest, hn::Mul(rest, hn::Mul(square, polynomial(d, crofton::detail::kSineTerms, square))));
    const auto is_1 = hn::Eq(quarter, one), is_2 = hn::Eq(quarter, hn::Set(d, 2.0)),
               is_3 = hn::Eq(quarter, hn::Set(d, 3.0));
    const auto swapped = hn::Or(is_1, is_3);
    const V a = hn::IfThenElse(swapped, s, c), b = hn::IfThenElse(swapped, c, s);
    *x = hn::IfThenElse(hn::Or(is_1, is_2), hn::Neg(a), a);
    *y = hn::IfThenElse(hn::Or(is_2, is_3), hn::Neg(b), b);
}

void draw_stratum(const LineStratum& stratum, const std::uint64_t* bits, double* lines) {
    const D d;
    const DU du;
    const unsigned k = stratum.axis, s = (k + 1) % 3, t = (k + 2) % 3;
    alignas(64) double drawn[6][kStratumLines];
    for (std::size_t i = 0; i < kStratumLines; i += hn::Lanes(d)) {
        hn::Vec<DU> pair[2];
        hn::LoadInterleaved2(du, bits + 2 * i, pair[0], pair[1]);
        V u[4];
        for (std::size_t n = 0; n < 4; ++n) {
            const auto half =
                n % 2 == 0 ? hn::And(pair[n / 2], hn::Set(du, 0xffffffffu)) : hn::ShiftRight<32>(pair[n / 2]);
            const V unit = hn::Mul(hn::Add(to_double(d, half), hn::Set(d, 0.5)), hn::Set(d, 0x1p-32));
            u[n] = hn::Add(hn::Set(d, stratum.low[n]), hn::Mul(hn::Set(d, stratum.length[n]), unit));
        }
        V x, y;
        circle_point(d, u[3], &x, &y);
        const V radius = hn::Sqrt(u[2]);
        const V depth = hn::Sqrt(hn::Max(hn::Zero(d), hn::Sub(hn::Set(d, 1.0), u[2])));
        const auto on_face = [&](std::size_t n) {
            return hn::Add(hn::Set(d, stratum.corner[n]), hn::Mul(hn::Set(d, stratum.sides[n]), u[n]));
        };
        hn::Store(hn::Set(d, stratum.plane), d, drawn[k] + i);
        hn::Store(on_face(0), d, drawn[s] + i);
        hn::Store(on_face(1), d, drawn[t] + i);
        hn::Store(hn::Mul(hn::Set(d, stratum.inward), depth), d, drawn[3 + k] + i);
        hn::Store(hn::Mul(radius, x), d, drawn[3 + s] + i);
        hn::Store(hn::Mul(radius, y), d, drawn[3 + t] + i);
    }
    for (std::size_t i = 0; i < kStratumLines; ++i)
        for (std::size_t n = 0; n < 6; ++n) lines[6 * i + n] = drawn[n][i];
}

}  // namespace crofton::pvs::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::pvs::kernels {

HWY_EXPORT(draw_stratum);

void draw_stratum(const LineStratum& stratum, const std::uint64_t* bits, double* lines) {
    HWY_DYNAMIC_DISPATCH(draw_stratum)(stratum, bits, lines);
}

}  // namespace crofton::pvs::kernels
#endif
