// SPDX-License-Identifier: MIT
// Where a text stops being JSON, for messages that say so, and how much it asks for.
#pragma once
#include <cstddef>
#include <optional>
#include <string_view>

#include "assets/read_limits.hpp"

namespace crofton::assets {

// The first byte that cannot continue what precedes it; text.size() where the text ends too early; nothing for JSON.
[[nodiscard]] std::optional<std::size_t> syntax_error_position(std::string_view text);

// Looked at before the text is parsed: what walks a document recurses as deep as it is nested, and each value takes
// memory. Errors: nested deeper than limits.nesting; more values than 16 for each of limits.nodes.
[[nodiscard]] Result<void> check_json_shape(std::string_view text, const ReadLimits& limits);

}  // namespace crofton::assets
