// SPDX-License-Identifier: MIT
// Where things stand in a script's text, for messages that a person can follow.
#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace crofton::viewer {

// The line, from 1, on which the text stops being JSON. Absent where it is JSON.
[[nodiscard]] std::optional<std::size_t> line_of_syntax_error(const std::string& text);

// The line, from 1, on which each entry of the array under the top-level name "events" begins. Requires JSON.
[[nodiscard]] std::vector<std::size_t> lines_of_events(const std::string& text);

}  // namespace crofton::viewer
