// SPDX-License-Identifier: MIT
#include "print.hpp"

#include <cstdarg>
#include <cstdint>

namespace crofton {
namespace {

struct Character {
    std::uint32_t code = 0;
    std::size_t bytes = 1;
    bool is_utf8 = false;
};

// Reads the first character of a text that is not empty.
Character first_of(std::string_view text) {
    const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(text[i]); };
    const std::uint8_t head = byte(0);
    if (head < 0x80) return {head, 1, true};
    const std::size_t bytes = head >= 0xF0 ? 4 : head >= 0xE0 ? 3 : 2;
    if (head < 0xC0 || head >= 0xF8 || bytes > text.size()) return {head, 1, false};
    std::uint32_t code = head & (0x7Fu >> bytes);
    for (std::size_t i = 1; i < bytes; ++i) {
        if ((byte(i) & 0xC0) != 0x80) return {head, 1, false};
        code = code << 6 | (byte(i) & 0x3Fu);
    }
    constexpr std::uint32_t kLeast[] = {0, 0, 0x80, 0x800, 0x10000};
    const bool is_utf8 = code >= kLeast[bytes] && code <= 0x10FFFF && (code < 0xD800 || code > 0xDFFF);
    return is_utf8 ? Character{code, bytes, true} : Character{head, 1, false};
}

bool is_visible(std::uint32_t code) {
    const auto between = [&](std::uint32_t low, std::uint32_t high) { return code >= low && code <= high; };
    if (code < 0x20 || between(0x7F, 0x9F)) return false;  // C0, delete, C1
    // The direction of writing; line and paragraph separators; tags.
    return code != 0x61C && !between(0x200E, 0x200F) && !between(0x2028, 0x202E) && !between(0x2066, 0x2069) &&
           code != 0xFEFF && !between(0xE0000, 0xE007F);
}

std::string escaped(std::string_view text, bool keep_lines) {
    std::string result;
    result.reserve(text.size());
    for (std::size_t i = 0; i < text.size();) {
        const Character c = first_of(text.substr(i));
        if ((c.is_utf8 && is_visible(c.code)) || (keep_lines && c.code == '\n')) {
            result += text.substr(i, c.bytes);
        } else {
            char code[16];
            std::snprintf(code, sizeof code, c.bytes == 1 ? "\\x%02x" : "\\u%04x", static_cast<unsigned>(c.code));
            result += code;
        }
        i += c.bytes;
    }
    return result;
}

std::string formatted_list(const char* format, va_list values) {
    va_list again;
    va_copy(again, values);
    std::string text(static_cast<std::size_t>(std::vsnprintf(nullptr, 0, format, again)), '\0');
    va_end(again);
    std::vsnprintf(text.data(), text.size() + 1, format, values);
    return text;
}

}  // namespace

std::string printable(std::string_view text) {
    return escaped(text, false);
}

std::string markup_text(std::string_view text) {
    std::string result;
    for (const char c : escaped(text, true)) switch (c) {
            case '&':
                result += "&amp;";
                break;
            case '<':
                result += "&lt;";
                break;
            case '>':
                result += "&gt;";
                break;
            case '"':
                result += "&quot;";
                break;
            case '\'':
                result += "&#39;";
                break;
            default:
                result += c;
        }
    return result;
}

std::string formatted(const char* format, ...) {
    va_list values;
    va_start(values, format);
    std::string text = formatted_list(format, values);
    va_end(values);
    return text;
}

void print_to(std::FILE* file, const char* format, ...) {
    va_list values;
    va_start(values, format);
    print_text_to(file, formatted_list(format, values));
    va_end(values);
}

void print_text_to(std::FILE* file, std::string_view text) {
    const std::string safe = escaped(text, true);
    std::fwrite(safe.data(), 1, safe.size(), file);
}

}  // namespace crofton
