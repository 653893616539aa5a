// SPDX-License-Identifier: MIT
// The fuzzer's bytes as a file, for readers that take a path.
#pragma once
#include <unistd.h>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace crofton::fuzz {

// One file per process and extension, overwritten by each input.
inline std::string input_file(const char* extension, const std::uint8_t* data, std::size_t size) {
    const std::string path = "/dev/shm/crofton_fuzz_" + std::to_string(getpid()) + "." + extension;
    std::FILE* file = std::fopen(path.c_str(), "wb");
    if (!file || std::fwrite(data, 1, size, file) != size) std::abort();
    std::fclose(file);
    return path;
}

}  // namespace crofton::fuzz
