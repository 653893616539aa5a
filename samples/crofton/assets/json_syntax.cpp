// SPDX-License-Identifier: MIT
#include "assets/json_syntax.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace crofton::assets {
namespace {

using nlohmann::json;

// Accepts everything, and remembers how far the text was JSON.
class SyntaxCheck : public json::json_sax_t {
  public:
    SyntaxError error;

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
    bool parse_error(std::size_t at, const std::string&, const json::exception& reason) override {
        // The character read last is the wrong one, not the one after it.
        error.position = at > 0 ? at - 1 : 0;
        error.number_too_large = dynamic_cast<const json::out_of_range*>(&reason) != nullptr;
        return false;
    }
};

}  // namespace

std::optional<SyntaxError> syntax_error(std::string_view text) {
    SyntaxCheck check;
    if (json::sax_parse(text.begin(), text.end(), &check)) return std::nullopt;
    check.error.position = std::min(check.error.position, text.size());
    return check.error;
}

Result<void> check_json_shape(std::string_view text, const ReadLimits& limits) {
    constexpr std::uint64_t kValuesPerNode = 16;
    std::uint64_t depth = 0, values = 0;
    bool in_string = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (in_string && c == '\\') ++i;
        if (c == '"') in_string = !in_string;
        if (in_string) continue;
        values += c == ',' || c == '{' || c == '[';
        if ((c == '{' || c == '[') && ++depth > limits.nesting)
            return fail(ErrorCode::budget_exceeded, kNoItem,
                        "its JSON is nested deeper than " + std::to_string(limits.nesting) + ", the limit");
        if ((c == '}' || c == ']') && depth > 0) --depth;
    }
    if (values / kValuesPerNode <= limits.nodes) return {};
    return fail(ErrorCode::budget_exceeded, kNoItem,
                "its JSON has " + std::to_string(values) + " values, more than 16 for each of " +
                    std::to_string(limits.nodes) + " nodes, the limit: --max-nodes raises it");
}

}  // namespace crofton::assets
