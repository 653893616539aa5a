// SPDX-License-Identifier: MIT
// Common output of all sub-commands: messages on stderr, files that are complete or not written.
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
