// The claims `crofton verify` can check, by topic.
#pragma once
#include <vector>

#include "verify_rows.hpp"

namespace crofton::cli {

// The measures and criteria: equations, theorems and examples of the paper, corrected where THEORY.md says so.
[[nodiscard]] std::vector<VerifyRow> verify_paper(const VerifyOptions& options);

}  // namespace crofton::cli
