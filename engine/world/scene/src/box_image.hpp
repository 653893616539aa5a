// SPDX-License-Identifier: MIT
// The steps that transformed_box.cpp (one box) and box_kernel.cpp (many) share. Both take them in the same order, so
// that they give the same bits.
#pragma once

namespace crofton::scene {

// Directions whose cosine stays below this are perpendicular as far as a box's float axes can tell.
inline constexpr double kPerpendicular = 1e-7;
// Lengths below this, beside 1, give no direction.
inline constexpr double kNothing = 1e-12;

// How far rounding may have put the image of a box off, along each axis of a box around it. With u = 2^-53:
// L·a is off by at most 3u(1+3u)·|L||a| per component, and e = h·(L·a), h a float, by 4.1u·|L||a|h. In the 1-norm that
// is 4.1u·M_k, with M_k the sum of |L||a|h's components. The centre L·c + t is off by 4.1u·C, with C the sum of |L||c|
// and |t|. Let A be the box's axes, float and orthonormal within 1e-6, and N = A⁻¹ = K/d. K are the cross products of
// pairs of axes, d their determinant, 1 within 1e-5. Computed entries of K are off by 4u, d by 12u, products K·e by 3u
// more, their sum by 3u, the quotient by 1u. A point of the image needs |x_j| ≤ Σ_k |N_j·e_k| + |N_j·(exact − computed
// centre)|. The computed value of the first is off by at most 1.001·(4.1 + 4 + 3 + 3 + 12 + 1)u·Σ M_k < 2^-48·Σ M_k;
// the second is below 1.001·4.1u·C < 2^-50·C. Cheaper bounds of both: with |L| the sum of all |L_ij|, Σ M_k ≤
// |L|·1.0001·Σ h_k and C ≤ |L|·Σ|c_i| + Σ|t_i|. Their own rounding and the factor 1.0001 are covered by doubling the
// first and by the final factor of half extents. Products that underflow are off by 2^-1075 each, which 2^-1000 covers.
inline constexpr double kEdgeError = 0x1p-47, kCenterError = 0x1p-50, kUnderflow = 0x1p-1000;
// Half extents are multiplied by this, which rounds up the sums above.
inline constexpr double kRoundUp = 1.0 + 0x1p-50;

}  // namespace crofton::scene
