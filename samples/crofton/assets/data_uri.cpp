// SPDX-License-Identifier: MIT
#include "assets/data_uri.hpp"

#include <array>
#include <charconv>
#include <cstdint>

namespace crofton::assets {
namespace {

constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
constexpr std::uint8_t kNoDigit = 255;

std::array<std::uint8_t, 256> values_of_digits() {
    std::array<std::uint8_t, 256> values{};
    values.fill(kNoDigit);
    for (std::size_t i = 0; i < kDigits.size(); ++i)
        values[static_cast<unsigned char>(kDigits[i])] = static_cast<std::uint8_t>(i);
    return values;
}

Result<std::string> decode_base64(std::string_view text) {
    const auto values = values_of_digits();
    while (!text.empty() && text.back() == '=') text.remove_suffix(1);
    std::string bytes;
    bytes.reserve(text.size() / 4 * 3 + 2);
    std::uint32_t bits = 0;
    int count = 0;
    for (const char c : text) {
        const std::uint8_t value = values[static_cast<unsigned char>(c)];
        if (value == kNoDigit) return fail(ErrorCode::parse, kNoItem, "damaged base64");
        bits = bits << 6 | value;
        count += 6;
        if (count < 8) continue;
        count -= 8;
        bytes.push_back(static_cast<char>(bits >> count & 0xFFu));
    }
    if (text.size() % 4 == 1) return fail(ErrorCode::parse, kNoItem, "damaged base64");
    return bytes;
}

}  // namespace

bool has_scheme(std::string_view uri) {
    const std::size_t end = uri.find_first_of(":/?#");
    return end != std::string_view::npos && end > 0 && uri[end] == ':';
}

bool is_data_uri(std::string_view uri) {
    return uri.substr(0, 5) == "data:";
}

Result<std::string> decode_data_uri(std::string_view uri) {
    const std::size_t comma = uri.find(',');
    const std::string_view head = uri.substr(0, comma == std::string_view::npos ? 0 : comma);
    constexpr std::string_view kEnd = ";base64";
    if (head.size() < kEnd.size() || head.substr(head.size() - kEnd.size()) != kEnd)
        return fail(ErrorCode::unsupported, kNoItem, "a data URI that is not base64");
    return decode_base64(uri.substr(comma + 1));
}

std::string make_data_uri(std::string_view type, std::string_view bytes) {
    std::string uri = "data:" + std::string(type) + ";base64,";
    uri.reserve(uri.size() + (bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const auto byte = [&](std::size_t k) -> std::uint32_t {
            return i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u;
        };
        const std::uint32_t bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for (std::size_t k = 0; k < 4; ++k)
            uri.push_back(i + k <= bytes.size() ? kDigits[bits >> (18 - 6 * k) & 63u] : '=');
    }
    return uri;
}

std::string decode_percent(std::string_view uri) {
    std::string result;
    for (std::size_t i = 0; i < uri.size(); ++i) {
        unsigned value = 0;
        if (uri[i] == '%' && i + 2 < uri.size()) {
            const auto [end, error] = std::from_chars(uri.data() + i + 1, uri.data() + i + 3, value, 16);
            if (error == std::errc{} && end == uri.data() + i + 3) {
                result.push_back(static_cast<char>(value));
                i += 2;
                continue;
            }
        }
        result.push_back(uri[i]);
    }
    return result;
}

}  // namespace crofton::assets
