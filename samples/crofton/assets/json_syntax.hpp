// SPDX-License-Identifier: MIT
// Where a text stops being JSON, for messages that say so.
#pragma once
#include <cstddef>
#include <optional>
#include <string_view>

namespace crofton::assets {

// The first byte that cannot continue what precedes it; text.size() where the text ends too early; nothing for JSON.
[[nodiscard]] std::optional<std::size_t> syntax_error_position(std::string_view text);

}  // namespace crofton::assets
