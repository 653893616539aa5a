// SPDX-License-Identifier: MIT
// Whole files, read and written, and errors that say which file.
#pragma once
#include <crofton/core/error.hpp>
#include <cstddef>
#include <mutex>
#include <string>
#include <string_view>

#include "assets/read_limits.hpp"

namespace crofton::assets {

// The whole of a file that the user named; it may be a pipe. Errors name the path and the system's reason: a folder,
// more than `limit` bytes.
[[nodiscard]] Result<std::string> read_file(const std::string& path, std::uint64_t limit = ReadLimits{}.bytes);

// The whole of a file that another file named, below `folder` ("" is the current one). Absolute names, "..", links
// that lead out of the folder, and what is no regular file (a pipe, a device) are refused.
[[nodiscard]] Result<std::string> read_file_below(const std::string& folder, const std::string& name,
                                                  std::uint64_t limit = ReadLimits{}.bytes);

// bake::write_file, the old file or all of the new one; "-" writes to stdout.
[[nodiscard]] Result<void> write_file(const std::string& path, std::string_view contents);

// Held while write_file writes a file: who ends the program takes it first. And how many files were written.
[[nodiscard]] std::mutex& writing();
[[nodiscard]] std::size_t files_written();

// Whether write_file can be expected to work there, asked before long work: the folder exists and may be written to.
// Creates nothing.
[[nodiscard]] Result<void> check_writable(const std::string& path);

// The same error with "path: what: " before its message, `what` left out where empty.
[[nodiscard]] Error in_file(const std::string& path, const std::string& what, Error error);

// The name without folders, and in lower case the part behind its last dot.
[[nodiscard]] std::string file_name(const std::string& path);
[[nodiscard]] std::string extension(const std::string& path);
[[nodiscard]] std::string folder(const std::string& path);  // with its slash; empty where there is none

}  // namespace crofton::assets
