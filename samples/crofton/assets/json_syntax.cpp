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

std::optional<std::size_t> syntax_error_position(std::string_view text) {
    SyntaxCheck check;
    if (json::sax_parse(text.begin(), text.end(), &check)) return std::nullopt;
    return std::min(check.position, text.size());
}

}  // namespace crofton::assets
