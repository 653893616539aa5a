// SPDX-License-Identifier: MIT
#include "assets/udmf.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <string>

namespace crofton::assets {
namespace {

constexpr double kUnits = 32768.0;    // of a vertex, in a unit of the map
constexpr double kLargest = 32767.0;  // coordinate or height

bool is_word_character(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '.' ||
           c == '+' || c == '-';
}

std::string lower_case(std::string_view text) {
    std::string result(text);
    for (char& c : result)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return result;
}

// Decimal, hexadecimal (0x) or octal (a leading 0).
bool to_number(std::string_view word, double& value) {
    const bool negative = !word.empty() && word[0] == '-';
    if (!word.empty() && (word[0] == '-' || word[0] == '+')) word.remove_prefix(1);
    const bool hexadecimal = word.size() > 2 && word[0] == '0' && (word[1] == 'x' || word[1] == 'X');
    const bool octal = word.size() > 1 && word.find_first_not_of("01234567") == word.npos && word[0] == '0';
    std::from_chars_result done{};
    if (hexadecimal || octal) {
        std::uint64_t whole = 0;
        done = std::from_chars(word.data() + (hexadecimal ? 2 : 1), word.data() + word.size(), whole,
                               hexadecimal ? 16 : 8);
        value = static_cast<double>(whole);
    } else {
        done = std::from_chars(word.data(), word.data() + word.size(), value);
    }
    if (negative) value = -value;
    return done.ec == std::errc{} && done.ptr == word.data() + word.size() && std::isfinite(value);
}

class UdmfReader {
  public:
    explicit UdmfReader(std::string_view text) : text_(text) {}

    Result<WadLevel> read() {
        level_.units = kUnits;
        for (skip_space(); at_ < text_.size(); skip_space()) {
            std::string name;
            if (auto done = word(name); !done) return done.error();
            if (take('=')) {
                if (auto done = value(); !done) return done.error();
                continue;
            }
            if (!take('{')) return unexpected_character();
            block_line_ = line_;
            if (auto done = fields(); !done) return done.error();
            if (auto done = add(lower_case(name)); !done) return done.error();
        }
        return std::move(level_);
    }

  private:
    Error bad(std::size_t line, const std::string& why) const {
        return fail(ErrorCode::parse, line, "TEXTMAP: line " + std::to_string(line) + ": " + why);
    }

    Error unexpected_character() const {
        if (at_ >= text_.size()) return bad(line_, "ends too early");
        return bad(line_, std::string("'") + text_[at_] + "' is not expected here");
    }

    void skip_space() {
        for (; at_ < text_.size(); ++at_) {
            const std::string_view rest = text_.substr(at_);
            if (rest[0] == '\n') ++line_;
            if (rest[0] == '\n' || rest[0] == '\r' || rest[0] == ' ' || rest[0] == '\t') continue;
            const bool line = rest.substr(0, 2) == "//", block = rest.substr(0, 2) == "/*";
            if (!line && !block) return;
            const std::size_t end = line ? rest.find('\n') : rest.find("*/", 2);
            const std::string_view comment = rest.substr(0, end);
            line_ += static_cast<std::size_t>(std::count(comment.begin(), comment.end(), '\n'));
            at_ += comment.size() + (end != rest.npos && block ? 2 : 0) - 1;
        }
    }

    bool take(char c) {
        skip_space();
        if (at_ >= text_.size() || text_[at_] != c) return false;
        ++at_;
        return true;
    }

    Result<void> word(std::string& result) {
        skip_space();
        const std::size_t begin = at_;
        while (at_ < text_.size() && is_word_character(text_[at_])) ++at_;
        if (at_ == begin) return unexpected_character();
        result = text_.substr(begin, at_ - begin);
        return {};
    }

    // Behind "=", with its ";": a number, a word or a quoted text, as it stands.
    Result<std::string> value() {
        std::string result;
        if (take('"')) {
            for (; at_ < text_.size() && text_[at_] != '"'; ++at_) {
                if (text_[at_] == '\\' && at_ + 1 < text_.size()) ++at_;
                line_ += text_[at_] == '\n';
                result += text_[at_];
            }
            if (at_ < text_.size()) ++at_;
        } else if (auto done = word(result); !done) {
            return done.error();
        }
        if (!take(';')) return unexpected_character();
        return result;
    }

    Result<void> fields() {
        fields_.clear();
        while (!take('}')) {
            std::string name;
            if (auto done = word(name); !done) return done;
            if (!take('=')) return unexpected_character();
            auto read = value();
            if (!read) return read.error();
            fields_[lower_case(name)] = std::move(*read);
        }
        return {};
    }

    // A field of the block that was read last. Without `otherwise` it must be there.
    Result<double> number(const char* name, double largest, const double* otherwise = nullptr) const {
        const auto found = fields_.find(name);
        if (found == fields_.end() && otherwise) return *otherwise;
        if (found == fields_.end()) return bad(block_line_, std::string("a block has no ") + name);
        double result = 0.0;
        if (!to_number(found->second, result) || std::abs(result) > largest)
            return bad(block_line_, std::string(name) + ": '" + found->second.substr(0, 40) + "' is no number from " +
                                        std::to_string(-static_cast<long long>(largest)) + " to " +
                                        std::to_string(static_cast<long long>(largest)));
        return result;
    }

    Result<int> coordinate(const char* name) const {
        const auto read = number(name, kLargest);
        if (!read) return read.error();
        return static_cast<int>(std::round(*read * kUnits));
    }

    Result<int> height(const char* name, double otherwise) const {
        const auto read = number(name, kLargest, &otherwise);
        if (!read) return read.error();
        return static_cast<int>(std::round(*read));
    }

    // −1 is none.
    Result<std::uint32_t> index(const char* name, bool may_be_absent) const {
        constexpr double kNone = -1.0, kMost = 2147483647.0;
        const auto read = number(name, kMost, may_be_absent ? &kNone : nullptr);
        if (!read) return read.error();
        return *read < 0.0 ? kNoSide : static_cast<std::uint32_t>(*read);
    }

    std::string texture(const char* name) const {
        const auto found = fields_.find(name);
        if (found == fields_.end()) return "-";
        std::string result = found->second;
        for (char& c : result) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
        return result;
    }

    Result<void> add(const std::string& block) {
        if (block == "vertex") return add_vertex();
        if (block == "linedef") return add_line();
        if (block == "sidedef") return add_side();
        if (block == "sector") return add_sector();
        return {};
    }

    Result<void> add_vertex() {
        const auto x = coordinate("x"), y = coordinate("y");
        if (!x) return x.error();
        if (!y) return y.error();
        level_.vertices.push_back({*x, *y});
        return {};
    }

    Result<void> add_line() {
        const auto from = index("v1", false), to = index("v2", false), right = index("sidefront", false),
                   left = index("sideback", true);
        for (const auto* read : {&from, &to, &right, &left})
            if (!*read) return read->error();
        level_.lines.push_back({*from, *to, *right, *left});
        return {};
    }

    Result<void> add_side() {
        const auto sector = index("sector", false);
        if (!sector) return sector.error();
        level_.sides.push_back({*sector, texture("texturetop"), texture("texturebottom"), texture("texturemiddle")});
        return {};
    }

    Result<void> add_sector() {
        const auto floor = height("heightfloor", 0.0), ceiling = height("heightceiling", 0.0),
                   light = height("lightlevel", 160.0);
        for (const auto* read : {&floor, &ceiling, &light})
            if (!*read) return read->error();
        level_.sectors.push_back(
            {*floor, *ceiling, std::clamp(*light, 0, 255), texture("texturefloor"), texture("textureceiling")});
        return {};
    }

    std::string_view text_;
    std::size_t at_ = 0, line_ = 1, block_line_ = 1;
    std::map<std::string, std::string, std::less<>> fields_;
    WadLevel level_;
};

}  // namespace

Result<WadLevel> read_udmf(std::string_view text) {
    return UdmfReader(text).read();
}

}  // namespace crofton::assets
