// SPDX-License-Identifier: MIT
// crofton verify cull: is anything visible ever culled?
#pragma once
#include <vector>

#include "rows.hpp"

namespace crofton::cli {

// `trials` straddlers of each kind of bound at each camera offset from 0 to 1e7, and what every path of the culling
// makes of them. All counts, no chance.
[[nodiscard]] std::vector<VerifyRow> verify_cull(const VerifyOptions& options);

}  // namespace crofton::cli
