// SPDX-License-Identifier: MIT
// All text that the programs print goes through here: names and messages come from files, and a terminal obeys some
// characters of theirs.
#pragma once
#include <cstdio>
#include <string>
#include <string_view>

namespace crofton {

// Returns the text on one line of visible characters: control characters, marks that turn the direction of writing, and
// bytes that are not UTF-8 are written as \x1b or \u202e.
[[nodiscard]] std::string printable(std::string_view text);

// Returns such text for SVG and HTML, between tags and within quotes; ends of lines stay.
[[nodiscard]] std::string markup_text(std::string_view text);

// Returns what printf prints, however long it is.
[[nodiscard, gnu::format(printf, 1, 2)]] std::string formatted(const char* format, ...);

// Prints printable text; ends of lines stay. `format` and what follows are those of printf. Names that may hold a byte
// 0 or an end of line are passed through printable() first.
[[gnu::format(printf, 2, 3)]] void print_to(std::FILE* file, const char* format, ...);
void print_text_to(std::FILE* file, std::string_view text);

}  // namespace crofton
