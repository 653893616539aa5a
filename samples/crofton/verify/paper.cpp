// SPDX-License-Identifier: MIT
#include <utility>

#include "topics.hpp"

namespace crofton::cli {

std::vector<VerifyRow> verify_paper(const VerifyOptions& options) {
    std::vector<VerifyRow> rows;
    for (const auto part : {kinematic_rows, planar_rows, criterion_rows, volume_rows, common_rows, bound_rows,
                            triangulation_rows, tree_rows, formula_rows, shape_rows})
        for (VerifyRow& row : part(options)) rows.push_back(std::move(row));
    return rows;
}

}  // namespace crofton::cli
