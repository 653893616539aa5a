// Files in memory, and errors that say which file.
#pragma once
#include <crofton/core/error.hpp>
#include <string>

namespace crofton::assets {

// The whole of a file. Errors name the path and the system's reason.
[[nodiscard]] Result<std::string> read_file(const std::string& path);

// The same error with "path: what: " before its message, `what` left out where empty.
[[nodiscard]] tl::unexpected<Error> in_file(const std::string& path, const std::string& what, Error error);

// The name without folders, and in lower case the part behind its last dot.
[[nodiscard]] std::string file_name(const std::string& path);
[[nodiscard]] std::string extension(const std::string& path);
[[nodiscard]] std::string folder(const std::string& path);  // with its slash; empty where there is none

}  // namespace crofton::assets
