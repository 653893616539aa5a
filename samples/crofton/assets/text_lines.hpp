// SPDX-License-Identifier: MIT
// The lines of a text file, however it ends and continues them.
#pragma once
#include <cstddef>
#include <string>
#include <string_view>

namespace crofton::assets {

[[nodiscard]] inline bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}

// Takes the next word, between blanks, off `line`; empty where there is none.
[[nodiscard]] std::string_view next_word(std::string_view& line);

// Lines end in LF, CR LF or CR. A line whose last character that is no blank is "\" continues on the next one: the "\"
// and the line's end count as a blank. A comment (from "#" at the line's begin or behind a blank) does not continue, so
// that one that ends in a Windows path swallows nothing. Byte order marks of UTF-8 at the begin of a line are skipped:
// files that are put together keep those of their parts.
class TextLines {
  public:
    explicit TextLines(std::string_view text) : text_(text) {}

    // False at the end of the text. `line` lives until the next call.
    [[nodiscard]] bool next(std::string_view& line);
    // Returns the number of the line from next(), counted from 1; of a continued line, that of its first part.
    [[nodiscard]] std::size_t number() const { return number_; }

  private:
    [[nodiscard]] std::string_view physical_line();

    std::string_view text_;
    std::string joined_;
    std::size_t number_ = 0, lines_read_ = 0;
};

}  // namespace crofton::assets
