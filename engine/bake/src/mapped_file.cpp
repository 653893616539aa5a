// SPDX-License-Identifier: MIT
#include <crofton/bake/baked_scene.hpp>

#include <cerrno>
#include <crofton/core/memory.hpp>
#include <cstdio>
#include <cstring>
#include <utility>

#if defined(__unix__) || defined(__APPLE__)
#define CROFTON_MMAP 1
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#endif

namespace crofton::bake {
namespace {

tl::unexpected<Error> system_error(const std::string& path, const char* what) {
    return fail(ErrorCode::io, kNoItem, path + ": " + what + ": " + std::strerror(errno));
}

#if defined(CROFTON_MMAP)

struct Descriptor {
    int number;
    ~Descriptor() {
        if (number >= 0) close(number);
    }
};

Result<std::span<const std::byte>> map(const std::string& path) {
    const Descriptor file{::open(path.c_str(), O_RDONLY | O_CLOEXEC)};
    struct stat status {};
    if (file.number < 0 || fstat(file.number, &status) != 0) return system_error(path, "cannot open");
    if (!S_ISREG(status.st_mode)) return fail(ErrorCode::io, kNoItem, path + ": not a regular file");
    const auto size = static_cast<std::size_t>(status.st_size);
    if (size == 0) return std::span<const std::byte>();
    int flags = MAP_PRIVATE;
#if defined(MAP_POPULATE)
    flags |= MAP_POPULATE;  // all of it is summed at once anyway: one call instead of a fault per page
#endif
    void* memory = mmap(nullptr, size, PROT_READ, flags, file.number, 0);
    if (memory == MAP_FAILED) return system_error(path, "cannot map");
    return std::span(static_cast<const std::byte*>(memory), size);
}

void unmap(std::span<const std::byte> bytes) {
    if (!bytes.empty()) munmap(const_cast<std::byte*>(bytes.data()), bytes.size());
}

#else

Result<std::span<const std::byte>> map(const std::string& path) {
    std::FILE* file = std::fopen(path.c_str(), "rb");
    if (!file) return system_error(path, "cannot open");
    Vector<std::byte> contents;
    std::byte block[1 << 14];
    for (std::size_t count; (count = std::fread(block, 1, sizeof block, file)) > 0;)
        contents.insert(contents.end(), block, block + count);
    const bool failed = std::ferror(file) != 0;
    std::fclose(file);
    if (failed) return system_error(path, "cannot read");
    if (contents.empty()) return std::span<const std::byte>();
    auto* memory = static_cast<std::byte*>(detail::allocate(contents.size(), 64));
    std::memcpy(memory, contents.data(), contents.size());
    return std::span<const std::byte>(memory, contents.size());
}

void unmap(std::span<const std::byte> bytes) {
    detail::release(const_cast<std::byte*>(bytes.data()), bytes.size(), 64);
}

#endif

}  // namespace

Result<MappedFile> MappedFile::open(const std::string& path) {
    const auto bytes = map(path);
    if (!bytes) return tl::unexpected(bytes.error());
    return MappedFile(*bytes);
}

MappedFile::~MappedFile() {
    unmap(bytes_);
}

MappedFile::MappedFile(MappedFile&& other) noexcept
    : bytes_(std::exchange(other.bytes_, std::span<const std::byte>())) {}

MappedFile& MappedFile::operator=(MappedFile&& other) noexcept {
    std::swap(bytes_, other.bytes_);
    return *this;
}

}  // namespace crofton::bake
