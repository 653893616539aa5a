// SPDX-License-Identifier: MIT
// Whole files, read and written, and errors that say which file.
#pragma once
#include <crofton/core/error.hpp>
#include <string>
#include <string_view>

namespace crofton::assets {

// The whole of a file. Errors name the path and the system's reason.
[[nodiscard]] Result<std::string> read_file(const std::string& path);

// Writes `contents` to `path` through a temporary file beside it, renamed when complete, so that no partial file is
// left; "-" writes to stdout. A link stays a link, and what is no plain file (a pipe, /dev/null) is written to
// directly. Errors name the path and the system's reason.
[[nodiscard]] Result<void> write_file(const std::string& path, std::string_view contents);

// Whether write_file can be expected to work there, asked before long work: the folder exists and may be written to.
// Creates nothing.
[[nodiscard]] Result<void> check_writable(const std::string& path);

// The same error with "path: what: " before its message, `what` left out where empty.
[[nodiscard]] tl::unexpected<Error> in_file(const std::string& path, const std::string& what, Error error);

// The name without folders, and in lower case the part behind its last dot.
[[nodiscard]] std::string file_name(const std::string& path);
[[nodiscard]] std::string extension(const std::string& path);
[[nodiscard]] std::string folder(const std::string& path);  // with its slash; empty where there is none

}  // namespace crofton::assets
