// SPDX-License-Identifier: MIT
// Vectors of three coordinates in double, eight triangles side by side. Included once per instruction set.
#if defined(CROFTON_COLLIDE_DOUBLE_LANES) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_COLLIDE_DOUBLE_LANES
#undef CROFTON_COLLIDE_DOUBLE_LANES
#else
#define CROFTON_COLLIDE_DOUBLE_LANES
#endif

#include <hwy/highway.h>

#include <crofton/mesh/mesh_layout.hpp>
#include <crofton/simd/mask_bits-inl.hpp>

HWY_BEFORE_NAMESPACE();
namespace crofton::mesh::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace simd = crofton::simd::HWY_NAMESPACE;

// Signs of determinants det(u, v, w) of differences of points are certain beyond kDeterminantError · |u|₁ |v|₁ |w|₁.
// Shewchuk's bound for orient3d, (7 + 56 u') u' with u' = 2^-53, holds for the sum of all products' magnitudes. That
// sum is at most |u|₁ |v|₁ |w|₁ in any of the factorings used here. Fused operations only lower the error. Underflow
// stays below 1e-280.
constexpr double kDeterminantError = 0x1.d0p-51;

using DD = hn::CappedTag<double, mesh::kMeshLeafWidth>;
using VD = hn::Vec<DD>;
using MD = hn::Mask<DD>;

HWY_INLINE VD sum_abs(const VD* v) {
    return hn::Add(hn::Abs(v[0]), hn::Add(hn::Abs(v[1]), hn::Abs(v[2])));
}

HWY_INLINE void cross(const VD* u, const VD* v, VD* out) {
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        out[i] = hn::NegMulAdd(u[k], v[j], hn::Mul(u[j], v[k]));
    }
}

HWY_INLINE VD dot(const VD* u, const VD* v) {
    return hn::MulAdd(u[0], v[0], hn::MulAdd(u[1], v[1], hn::Mul(u[2], v[2])));
}

// The same with every product rounded, as without fused operations. It is for numbers that are answers, not filters,
// and so the same bits on every instruction set.
HWY_INLINE void rounded_cross(const VD* u, const VD* v, VD* out) {
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        out[i] = hn::Sub(hn::Mul(u[j], v[k]), hn::Mul(u[k], v[j]));
    }
}

HWY_INLINE VD rounded_dot(const VD* u, const VD* v) {
    return hn::Add(hn::Add(hn::Mul(u[0], v[0]), hn::Mul(u[1], v[1])), hn::Mul(u[2], v[2]));
}

HWY_INLINE std::uint32_t bits_of(DD d, MD mask, std::size_t l) {
    return simd::mask_bits(d, mask) << l;
}

}  // namespace crofton::mesh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
