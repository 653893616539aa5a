// SPDX-License-Identifier: MIT
// URIs as glTF files use them: data in base64, or the name of a file beside.
#pragma once
#include <crofton/core/error.hpp>
#include <string>
#include <string_view>

namespace crofton::assets {

// "scheme:…", which is no file beside; a data URI is one with the scheme "data".
[[nodiscard]] bool has_scheme(std::string_view uri);
[[nodiscard]] bool is_data_uri(std::string_view uri);

// The bytes of "data:TYPE;base64,…". Errors: not base64, or damaged.
[[nodiscard]] Result<std::string> decode_data_uri(std::string_view uri);
[[nodiscard]] std::string make_data_uri(std::string_view type, std::string_view bytes);

// "%20" and the like to bytes; what is no escape stays.
[[nodiscard]] std::string decode_percent(std::string_view uri);

}  // namespace crofton::assets
