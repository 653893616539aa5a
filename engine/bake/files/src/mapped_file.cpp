// SPDX-License-Identifier: MIT
// Maps a file into memory, or reads it where it cannot be mapped.
#include <crofton/bake/baked_scene.hpp>

#include <algorithm>
#include <cerrno>
#include <crofton/core/memory.hpp>
#include <cstdio>
#include <cstring>
#include <utility>

#include "path.hpp"

#if defined(__unix__) || defined(__APPLE__)
#define CROFTON_MMAP 1
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#endif

namespace crofton::bake {
namespace {

constexpr std::size_t kReadAlignment = 64;

struct Bytes {
    std::span<const std::byte> bytes;
    bool mapped = false;
};

Error system_error(const std::string& path, const char* what) {
    return fail(ErrorCode::io, kNoItem, {path, ": ", what, ": ", std::strerror(errno)});
}

Error too_large(const std::string& path, std::uint64_t size, std::uint64_t largest) {
    return fail(ErrorCode::out_of_range, kNoItem,
                {path, ": ", size, " bytes, where the limit is ", largest, " (FileOptions::largest)"});
}

// Memory of the host's, or an error.
Result<std::byte*> room_for(std::size_t size, const std::string& path) {
    auto* memory = static_cast<std::byte*>(detail::try_allocate(size, kReadAlignment));
    if (memory) return memory;
    return fail(ErrorCode::out_of_memory, kNoItem, {path, ": no memory for its ", size, " bytes"});
}

#if defined(CROFTON_MMAP)

struct Descriptor {
    int number;
    ~Descriptor() {
        if (number >= 0) close(number);
    }
};

// A regular file and its size. Opening does not wait for the other end of a pipe.
Result<std::size_t> open_regular(const std::string& path, std::uint64_t largest, Descriptor& file) {
    file.number = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    struct stat status {};
    if (file.number < 0 || fstat(file.number, &status) != 0) return system_error(path, "cannot open");
    if (!S_ISREG(status.st_mode)) return fail(ErrorCode::io, kNoItem, {path, ": not a regular file"});
    const auto size = static_cast<std::uint64_t>(status.st_size);
    if (size > largest) return too_large(path, size, largest);
    return static_cast<std::size_t>(size);
}

Result<Bytes> map(const std::string& path, int file, std::size_t size) {
    int flags = MAP_PRIVATE;
#if defined(MAP_POPULATE)
    flags |= MAP_POPULATE;  // all of it is summed at once anyway: one call instead of a fault per page
#endif
    void* memory = mmap(nullptr, size, PROT_READ, flags, file, 0);
    if (memory == MAP_FAILED) return system_error(path, "cannot map");
    return Bytes{std::span(static_cast<const std::byte*>(memory), size), true};
}

// As many bytes as the file had when it was opened.
Result<Bytes> read(const std::string& path, int file, std::size_t size) {
    const auto memory = room_for(size, path);
    if (!memory) return memory.error();
    std::size_t done = 0;
    ssize_t count = 1;
    while (done < size && count != 0) {
        count = ::read(file, *memory + done, std::min(size - done, std::size_t{1} << 30));
        if (count < 0 && errno != EINTR) break;
        if (count > 0) done += static_cast<std::size_t>(count);
    }
    if (done == size) return Bytes{std::span<const std::byte>(*memory, size), false};
    const auto error = count == 0 ? fail(ErrorCode::io, kNoItem, {path, ": was cut while it was read"})
                                  : system_error(path, "cannot read");
    detail::release(*memory, size, kReadAlignment);
    return error;
}

Result<Bytes> open_bytes(const std::string& path, const FileOptions& options) {
    Descriptor file{-1};
    const auto size = open_regular(path, options.largest, file);
    if (!size) return size.error();
    if (*size == 0) return Bytes{};
    return options.access == FileAccess::map ? map(path, file.number, *size) : read(path, file.number, *size);
}

void unmap(std::span<const std::byte> bytes) {
    munmap(const_cast<std::byte*>(bytes.data()), bytes.size());
}

#else

Result<Bytes> open_bytes(const std::string& path, const FileOptions& options) {
    std::FILE* file = std::fopen(path.c_str(), "rb");
    if (!file) return system_error(path, "cannot open");
    Vector<std::byte> contents;
    std::byte block[1 << 14];
    for (std::size_t count;
         contents.size() <= options.largest && (count = std::fread(block, 1, sizeof block, file)) > 0;)
        contents.insert(contents.end(), block, block + count);
    const bool failed = std::ferror(file) != 0;
    std::fclose(file);
    if (failed) return system_error(path, "cannot read");
    if (contents.size() > options.largest) return too_large(path, contents.size(), options.largest);
    if (contents.empty()) return Bytes{};
    const auto memory = room_for(contents.size(), path);
    if (!memory) return memory.error();
    std::memcpy(*memory, contents.data(), contents.size());
    return Bytes{std::span<const std::byte>(*memory, contents.size()), false};
}

void unmap(std::span<const std::byte>) {}

#endif

}  // namespace

Result<MappedFile> MappedFile::open(const std::string& path, const FileOptions& options) {
    if (auto checked = check_path(path); !checked) return checked.error();
    const auto opened = open_bytes(path, options);
    if (!opened) return opened.error();
    return MappedFile(opened->bytes, opened->mapped);
}

MappedFile::~MappedFile() {
    if (bytes_.empty()) return;
    if (mapped_)
        unmap(bytes_);
    else
        detail::release(const_cast<std::byte*>(bytes_.data()), bytes_.size(), kReadAlignment);
}

MappedFile::MappedFile(MappedFile&& other) noexcept
    : bytes_(std::exchange(other.bytes_, std::span<const std::byte>())), mapped_(other.mapped_) {}

MappedFile& MappedFile::operator=(MappedFile&& other) noexcept {
    std::swap(bytes_, other.bytes_);
    std::swap(mapped_, other.mapped_);
    return *this;
}

}  // namespace crofton::bake
