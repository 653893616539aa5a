// SPDX-License-Identifier: MIT
// crofton verify pvs: is what lines have missed as little as was promised, and is what is hidden hidden?
#pragma once
#include <vector>

#include "rows.hpp"

namespace crofton::cli {

// A bake of the town with about `trials` lines; 20 times as many for each of some cells, by another way. `trials` rays
// from eyes in the cells, and pictures of street views.
[[nodiscard]] std::vector<VerifyRow> verify_pvs(const VerifyOptions& options);

}  // namespace crofton::cli
