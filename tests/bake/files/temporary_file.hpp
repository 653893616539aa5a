// SPDX-License-Identifier: MIT
// A file that is gone after the test.
#pragma once
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <span>
#include <string>

namespace crofton::bake_test {

class TemporaryFile {
  public:
    explicit TemporaryFile(std::span<const std::byte> contents) {
        path_ = (std::filesystem::temp_directory_path() / "crofton-test-XXXXXX").string();
        const int descriptor = mkstemp(path_.data());
        std::FILE* file = fdopen(descriptor, "wb");
        if (!contents.empty()) std::fwrite(contents.data(), 1, contents.size(), file);
        std::fclose(file);
    }
    ~TemporaryFile() { std::filesystem::remove(path_); }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;
    [[nodiscard]] const std::string& path() const { return path_; }

  private:
    std::string path_;
};

}  // namespace crofton::bake_test
