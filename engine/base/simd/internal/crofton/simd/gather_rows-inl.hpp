// SPDX-License-Identifier: MIT
// Rows of four floats, from wherever they lie, as four vectors: their transpose. Compiled once per instruction set
// (Highway).
#include <hwy/highway.h>
#include <cstddef>
#include <cstring>

#if defined(CROFTON_SIMD_GATHER_ROWS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_SIMD_GATHER_ROWS_INL
#undef CROFTON_SIMD_GATHER_ROWS_INL
#else
#define CROFTON_SIMD_GATHER_ROWS_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace crofton::simd::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET != HWY_SCALAR
using Row = hn::Vec<hn::Full128<float>>;
#else
struct Row {
    float at[4];
};
#endif

// Sixteen bytes at any address.
HWY_INLINE Row load_row(const unsigned char* from) {
#if HWY_TARGET == HWY_SCALAR
    Row row;
    std::memcpy(row.at, from, sizeof(row.at));
    return row;
#else
    return hn::LoadU(hn::Full128<float>(), reinterpret_cast<const float*>(from));
#endif
}

// Four doubles at any address, minus those at `b`, rounded to floats.
HWY_INLINE Row load_difference(const unsigned char* from, const double* b) {
#if HWY_TARGET == HWY_SCALAR
    double a[4];
    std::memcpy(a, from, sizeof(a));
    Row row;
    for (int j = 0; j < 4; ++j) row.at[j] = static_cast<float>(a[j] - b[j]);
    return row;
#else
    const double* a = reinterpret_cast<const double*>(from);
    const hn::Full128<float> d;
#if HWY_MAX_BYTES >= 32
    const hn::Full256<double> dd;
    return hn::DemoteTo(d, hn::Sub(hn::LoadU(dd, a), hn::LoadU(dd, b)));
#else
    const hn::Full128<double> dd;
    const hn::Full64<float> half;
    const auto low = hn::DemoteTo(half, hn::Sub(hn::LoadU(dd, a), hn::LoadU(dd, b))),
               high = hn::DemoteTo(half, hn::Sub(hn::LoadU(dd, a + 2), hn::LoadU(dd, b + 2)));
    return hn::Combine(d, high, low);
#endif
#endif
}

// Lane l of out[k] is number k of row(l), which returns a Row. It is asked for l below the number of lanes, 1, 4, 8 or
// 16.
template <class D, class RowOf>
HWY_INLINE void gather_rows([[maybe_unused]] D d, const RowOf& row, hn::Vec<D> (&out)[4]) {
#if HWY_TARGET == HWY_SCALAR
    const Row only = row(std::size_t{0});
    for (int k = 0; k < 4; ++k) out[k] = hn::Set(d, only.at[k]);
#else
    constexpr std::size_t kLanes = hn::MaxLanes(D());
    static_assert(kLanes == 4 || kLanes == 8 || kLanes == 16);
    // Block b of vector i is row 4 b + i.
    hn::Vec<D> rows[4];
    for (std::size_t i = 0; i < 4; ++i) {
        if constexpr (kLanes == 4) {
            rows[i] = row(i);
        } else if constexpr (kLanes == 8) {
            rows[i] = hn::Combine(d, row(i + 4), row(i));
        } else {
            const hn::Half<D> half;
            rows[i] = hn::Combine(d, hn::Combine(half, row(i + 12), row(i + 8)), hn::Combine(half, row(i + 4), row(i)));
        }
    }
    const auto ac_low = hn::InterleaveLower(d, rows[0], rows[2]), ac_high = hn::InterleaveUpper(d, rows[0], rows[2]),
               bd_low = hn::InterleaveLower(d, rows[1], rows[3]), bd_high = hn::InterleaveUpper(d, rows[1], rows[3]);
    out[0] = hn::InterleaveLower(d, ac_low, bd_low);
    out[1] = hn::InterleaveUpper(d, ac_low, bd_low);
    out[2] = hn::InterleaveLower(d, ac_high, bd_high);
    out[3] = hn::InterleaveUpper(d, ac_high, bd_high);
#endif
}

}  // namespace crofton::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
