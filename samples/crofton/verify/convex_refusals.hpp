// SPDX-License-Identifier: MIT
// Bad shapes, poses and motions: refused by name, with nothing lost.
#pragma once
#include <vector>

#include "rows.hpp"

namespace crofton::cli {

// A row for each kind of bad input. After each refusal good shapes answer as before; what is merely unusual is taken.
[[nodiscard]] std::vector<VerifyRow> verify_bad_shapes(const VerifyOptions& options);

}  // namespace crofton::cli
