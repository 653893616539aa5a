// SPDX-License-Identifier: MIT
// What every sub-command says and writes the same way: messages to stderr, files whole or not at all.
#pragma once
#include <crofton/core/error.hpp>
#include <string>
#include <string_view>

#include "assets/file.hpp"
#include "json/json.hpp"

namespace crofton::cli {

// "crofton: FILE: message (item N)" to stderr; returns kBadInput, or kInterrupted for what was cancelled.
int report_error(std::string_view geometry, const Error& error);

using assets::read_file;
using assets::write_file;
[[nodiscard]] Result<void> write_json(const std::string& path, const Json& document);

}  // namespace crofton::cli
