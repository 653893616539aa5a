// SPDX-License-Identifier: MIT
#pragma once

namespace crofton::fit {

inline constexpr double kUnit = 0x1p-53;  // unit roundoff of double

}  // namespace crofton::fit
