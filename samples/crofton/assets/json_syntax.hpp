// SPDX-License-Identifier: MIT
// Where a text stops being JSON, for messages that say so, and how much it asks for.
#pragma once
#include <cstddef>
#include <optional>
#include <string_view>

#include "assets/read_limits.hpp"

namespace crofton::assets {

struct SyntaxError {
    std::size_t position = 0;       // the first byte that cannot continue what precedes it; the size: it ends too early
    bool number_too_large = false;  // it is JSON, but no double holds the number that ends here
};
// Nothing for JSON.
[[nodiscard]] std::optional<SyntaxError> syntax_error(std::string_view text);

// Looked at before the text is parsed: what walks a document recurses as deep as it is nested, and each value takes
// memory. Errors: nested deeper than limits.nesting; more values than 16 for each of limits.nodes.
[[nodiscard]] Result<void> check_json_shape(std::string_view text, const ReadLimits& limits);

}  // namespace crofton::assets
