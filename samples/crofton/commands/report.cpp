// SPDX-License-Identifier: MIT
#include "report.hpp"

#include <cstdio>

#include "assets/print.hpp"
#include "commands.hpp"
#include "json/json.hpp"

namespace crofton::cli {
int report_error(std::string_view geometry, const Error& error) {
    const std::string where = geometry.empty() ? "" : printable(geometry) + ": ";
    const std::string item = error.item == kNoItem ? "" : " (item " + std::to_string(error.item) + ")";
    print_to(stderr, "crofton: %s%s%s\n", where.c_str(), printable(error.message).c_str(), item.c_str());
    return error.code == ErrorCode::cancelled ? kInterrupted : kBadInput;
}

namespace {

// Puts arrays that hold only numbers on one line, outside of strings.
std::string with_short_arrays(const std::string& text) {
    std::string result;
    bool quoted = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (c == '"' && (i == 0 || !quoted))
            quoted = true;
        else if (quoted && c == '\\')
            result += text[i++];
        else if (quoted && c == '"')
            quoted = false;
        const std::size_t end = c == '[' && !quoted ? text.find_first_not_of("0123456789+-.eE, \n", i + 1) : text.npos;
        if (end == text.npos || text[end] != ']') {
            result += text[i];
            continue;
        }
        for (; i <= end; ++i) {
            if (text[i] == ',')
                result += ", ";
            else if (text[i] != ' ' && text[i] != '\n')
                result += text[i];
        }
        --i;
    }
    return result;
}

}  // namespace

Result<void> write_json(const std::string& path, const Json& document) {
    const std::string text = document.dump(1);
    return write_file(path, with_short_arrays(text) + "\n");
}

}  // namespace crofton::cli
