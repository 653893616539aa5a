// SPDX-License-Identifier: MIT
#pragma once

namespace crofton::fit {

// tan(π/8) = √2 − 1, half the edge of the cube of Rodrigues vectors that a search over all orientations starts from: by
// the 24 symmetries of a box, vectors c with |c_i| ≤ tan(π/8) and Σ|c_i| ≤ 1 cover all frames.
inline constexpr double kRootCellHalfSize = 0.41421356237309515;

}  // namespace crofton::fit
