#include "script_lines.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace crofton::viewer {
namespace {

using nlohmann::json;

std::size_t line_at(const std::string& text, std::size_t position) {
    const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(position, text.size()));
    return 1 + static_cast<std::size_t>(std::count(text.begin(), end, '\n'));
}

// Accepts everything, and remembers how far the text was JSON.
class SyntaxCheck : public json::json_sax_t {
  public:
    std::size_t position = 0;

    bool null() override { return true; }
    bool boolean(bool) override { return true; }
    bool number_integer(number_integer_t) override { return true; }
    bool number_unsigned(number_unsigned_t) override { return true; }
    bool number_float(number_float_t, const string_t&) override { return true; }
    bool string(string_t&) override { return true; }
    bool binary(binary_t&) override { return true; }
    bool start_object(std::size_t) override { return true; }
    bool key(string_t&) override { return true; }
    bool end_object() override { return true; }
    bool start_array(std::size_t) override { return true; }
    bool end_array() override { return true; }
    bool parse_error(std::size_t at, const std::string&, const json::exception&) override {
        // The character read last is the wrong one, not the one after it.
        position = at > 0 ? at - 1 : 0;
        return false;
    }
};

}  // namespace

std::optional<std::size_t> line_of_syntax_error(const std::string& text) {
    SyntaxCheck check;
    if (json::sax_parse(text, &check)) return std::nullopt;
    return line_at(text, check.position);
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
