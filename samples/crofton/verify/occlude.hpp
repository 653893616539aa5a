// SPDX-License-Identifier: MIT
// crofton verify occlude: is anything that a ray sees ever called hidden?
#pragma once
#include <vector>

#include "rows.hpp"

namespace crofton::cli {

// `trials` rays of each kind at each camera offset from 0 to 1e7: to points of objects, and through covered pixels. All
// counts, no chance.
[[nodiscard]] std::vector<VerifyRow> verify_occlude(const VerifyOptions& options);

}  // namespace crofton::cli
