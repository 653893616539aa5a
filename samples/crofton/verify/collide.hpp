// SPDX-License-Identifier: MIT
// The claims of `crofton verify collide`.
#pragma once
#include <vector>

#include "rows.hpp"

namespace crofton::cli {

// Boxes that nearly touch, against exact integers: no wrong answer in any class of gap and angle. The
// same of convex bodies, with their depths and casts.
[[nodiscard]] std::vector<VerifyRow> verify_collide(const VerifyOptions& options);

}  // namespace crofton::cli
