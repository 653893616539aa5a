// SPDX-License-Identifier: MIT
#include "assets/text_lines.hpp"

namespace crofton::assets {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

bool has_comment(std::string_view line) {
    for (std::size_t i = line.find('#'); i != std::string_view::npos; i = line.find('#', i + 1))
        if (i == 0 || is_blank(line[i - 1])) return true;
    return false;
}

// Takes the "\" off a line that continues on the next one.
bool take_continuation(std::string_view& line) {
    std::size_t end = line.size();
    while (end > 0 && is_blank(line[end - 1])) --end;
    if (end == 0 || line[end - 1] != '\\' || has_comment(line)) return false;
    line = line.substr(0, end - 1);
    return true;
}

}  // namespace

std::string_view next_word(std::string_view& line) {
    while (!line.empty() && is_blank(line.front())) line.remove_prefix(1);
    std::size_t end = 0;
    while (end < line.size() && !is_blank(line[end])) ++end;
    const std::string_view word = line.substr(0, end);
    line.remove_prefix(end);
    return word;
}

std::string_view TextLines::physical_line() {
    ++lines_read_;
    while (text_.substr(0, kByteOrderMark.size()) == kByteOrderMark) text_.remove_prefix(kByteOrderMark.size());
    const std::size_t end = text_.find_first_of("\r\n");
    const std::string_view line = text_.substr(0, end);
    if (end == std::string_view::npos) {
        text_ = {};
        return line;
    }
    const bool two = text_[end] == '\r' && end + 1 < text_.size() && text_[end + 1] == '\n';
    text_.remove_prefix(end + (two ? 2 : 1));
    return line;
}

bool TextLines::next(std::string_view& line) {
    if (text_.empty()) return false;
    number_ = lines_read_ + 1;
    line = physical_line();
    if (!take_continuation(line)) return true;
    joined_.clear();
    for (bool goes_on = true; goes_on;) {
        joined_ += line;
        joined_ += ' ';
        line = physical_line();
        goes_on = take_continuation(line);
    }
    joined_ += line;
    line = joined_;
    return true;
}

}  // namespace crofton::assets
