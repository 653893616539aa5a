// SPDX-License-Identifier: MIT
// A map of a level from above: its cells, and what one of them sees.
#pragma once
#include <crofton/pvs/pvs.hpp>
#include <string>

namespace crofton::cli {

// Objects by their boxes' outlines: green where the cell sees them, yellow where that is open, grey where they are
// hidden. Cells of the same height as thin lines, solid ones dark. y is up.
[[nodiscard]] std::string pvs_svg(const pvs::Pvs& pvs, const pvs::BakeGeometry& geometry, std::uint32_t cell);

}  // namespace crofton::cli
