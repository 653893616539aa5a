// SPDX-License-Identifier: MIT
// A criterion as the user writes it.
#pragma once
#include <crofton/measure/measure.hpp>
#include <string>

#include "read_options.hpp"

namespace crofton::cli {

inline constexpr const char* kCriterionSyntax =
    "volume | area | perimeter | rays:LENGTH | frustum:FOVY,ASPECT,NEAR,FAR (FOVY in radians) | partner:FILE | "
    "weights:A,B,C";

// Errors say what is wrong with the text; `partner` reads its file, whose convex hull is the partner.
[[nodiscard]] Result<measure::Criterion> parse_criterion(const std::string& text, const ReadOptions& options = {});

}  // namespace crofton::cli
