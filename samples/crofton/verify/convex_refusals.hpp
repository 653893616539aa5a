// SPDX-License-Identifier: MIT
// Bad bodies, poses and motions: refused by name, with nothing lost.
#pragma once
#include <vector>

#include "rows.hpp"

namespace crofton::cli {

// A row for each kind of bad input. After each refusal good bodies answer as before; what is merely unusual is taken.
[[nodiscard]] std::vector<VerifyRow> verify_bad_bodies(const VerifyOptions& options);

}  // namespace crofton::cli
