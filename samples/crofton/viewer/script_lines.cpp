// SPDX-License-Identifier: MIT
#include "script.hpp"

#include <algorithm>

#include "assets/json_syntax.hpp"

namespace crofton::viewer {
namespace {

std::size_t line_at(const std::string& text, std::size_t position) {
    const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(position, text.size()));
    return 1 + static_cast<std::size_t>(std::count(text.begin(), end, '\n'));
}

}  // namespace

std::optional<std::size_t> line_of_syntax_error(const std::string& text) {
    const auto error = assets::syntax_error(text);
    if (!error) return std::nullopt;
    return line_at(text, error->position);
}

std::vector<std::size_t> lines_of_events(const std::string& text) {
    std::vector<std::size_t> lines;
    std::size_t depth = 0, line = 1;
    bool in_events = false, expects_entry = false;
    std::string name, last_string;  // of the top level: the name before the colon
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (c == '\n') ++line;
        if (std::string_view(" \t\r\n").find(c) != std::string_view::npos) continue;
        if (in_events && depth == 2 && expects_entry && c != ']') lines.push_back(line);
        expects_entry = false;
        if (c == '"') {
            const std::size_t begin = ++i;
            while (i < text.size() && text[i] != '"') i += text[i] == '\\' ? 2 : 1;
            last_string = text.substr(begin, i - begin);
        } else if (c == ':' && depth == 1) {
            name = last_string;
        } else if (c == '[' || c == '{') {
            ++depth;
            if (depth == 2) in_events = c == '[' && name == "events";
            expects_entry = depth == 2;
        } else if (c == ']' || c == '}') {
            --depth;
        } else if (c == ',') {
            expects_entry = depth == 2;
        }
    }
    return lines;
}

}  // namespace crofton::viewer
