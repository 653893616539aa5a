// SPDX-License-Identifier: MIT
// The claims of `crofton verify collide` about convex shapes.
#pragma once
#include <vector>

#include "rows.hpp"

namespace crofton::cli {

// Polytopes that nearly touch, their depths and casts: no wrong answer, by exact arithmetic.
[[nodiscard]] std::vector<VerifyRow> verify_convex(const VerifyOptions& options);

}  // namespace crofton::cli
