// SPDX-License-Identifier: MIT
// The claims `crofton verify` can check, by topic.
#pragma once
#include <vector>

#include "rows.hpp"

namespace crofton::cli {

// The measures and criteria: equations, theorems and examples of the paper, corrected where theory.md says so.
[[nodiscard]] std::vector<VerifyRow> verify_paper(const VerifyOptions& options);
// Global lines: the densities that are uniform, those that are not, and what a patch expects of them.
[[nodiscard]] std::vector<VerifyRow> verify_lines(const VerifyOptions& options);

// Parts of verify_paper.
[[nodiscard]] std::vector<VerifyRow> kinematic_rows(const VerifyOptions& options);
[[nodiscard]] std::vector<VerifyRow> planar_rows(const VerifyOptions& options);
[[nodiscard]] std::vector<VerifyRow> criterion_rows(const VerifyOptions& options);
// The sharp rows: mostly without chance, at a cost that does not depend on the trials.
[[nodiscard]] std::vector<VerifyRow> volume_rows(const VerifyOptions& options);
[[nodiscard]] std::vector<VerifyRow> common_rows(const VerifyOptions& options);
[[nodiscard]] std::vector<VerifyRow> bound_rows(const VerifyOptions& options);
[[nodiscard]] std::vector<VerifyRow> triangulation_rows(const VerifyOptions& options);
[[nodiscard]] std::vector<VerifyRow> tree_rows(const VerifyOptions& options);
// Formulas that no theorem's row calls, mostly without random numbers.
[[nodiscard]] std::vector<VerifyRow> formula_rows(const VerifyOptions& options);
// Likewise of shapes: least figures, masses, meshes, limits and shadows.
[[nodiscard]] std::vector<VerifyRow> shape_rows(const VerifyOptions& options);

// Part of verify_lines.
[[nodiscard]] std::vector<VerifyRow> factor_rows(const VerifyOptions& options);

}  // namespace crofton::cli
