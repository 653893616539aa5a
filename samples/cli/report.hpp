// What every sub-command says and writes the same way: messages to stderr, files whole or not at all.
#pragma once
#include <crofton/core/error.hpp>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace crofton::cli {

// "crofton: FILE: message (item N)" to stderr; returns kBadInput.
int report_error(std::string_view subject, const Error& error);

// Writes `contents` to `path` through a temporary file beside it, renamed when complete, so that no partial file is
// left;
// "-" writes to stdout.
[[nodiscard]] Result<void> write_file(const std::string& path, std::string_view contents);
[[nodiscard]] Result<void> write_json(const std::string& path, const nlohmann::json& document);

// The whole of a file; errors name the path and the system's reason.
[[nodiscard]] Result<std::string> read_file(const std::string& path);

}  // namespace crofton::cli
