// SPDX-License-Identifier: MIT
// A file as memory, without reading it first.
#pragma once
#include <crofton/core/error.hpp>
#include <cstddef>
#include <span>
#include <string>

namespace crofton::bake {

// Read-only. Where files cannot be mapped it is read into memory instead. Do not shorten the file meanwhile.
class MappedFile {
  public:
    // Errors name the path and the system's reason.
    [[nodiscard]] static Result<MappedFile> open(const std::string& path);
    ~MappedFile();
    MappedFile(MappedFile&& other) noexcept;
    MappedFile& operator=(MappedFile&& other) noexcept;

    // Aligned to 64 bytes at least.
    [[nodiscard]] std::span<const std::byte> bytes() const { return bytes_; }

  private:
    explicit MappedFile(std::span<const std::byte> bytes) : bytes_(bytes) {}
    std::span<const std::byte> bytes_;
};

}  // namespace crofton::bake
