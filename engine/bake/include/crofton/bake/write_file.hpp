// SPDX-License-Identifier: MIT
// Writes a whole file or leaves the old one: what a baked scene must be stored with, as others may have it open.
#pragma once
#include <crofton/core/error.hpp>
#include <cstddef>
#include <span>
#include <string>

namespace crofton::bake {

// Writes `bytes` to PATH.partial, flushes them to the disk, and renames that file to PATH. A full disk, a crash or a
// killed process leaves the old file as it was; a PATH.partial left behind is used up by the next write to PATH. Who
// has the old file open or mapped keeps its contents, since the new file is another inode. Writers of one path wait for
// each other; the last one wins. A link stays a link, permissions stay, and what is no regular file (a pipe, /dev/null)
// is written to directly. Errors name the path and the system's reason.
[[nodiscard]] Result<void> write_file(const std::string& path, std::span<const std::byte> bytes);

}  // namespace crofton::bake
