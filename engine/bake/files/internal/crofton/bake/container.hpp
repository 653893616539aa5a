// SPDX-License-Identifier: MIT
// The outside of a .crofton file: named sections of plain arrays, each with its checksum, to be read where they lie.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/core/executor.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/core/stop_signal.hpp>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>

namespace crofton::bake {

// All numbers little-endian; a machine of another byte order refuses the file. Bytes that are not described are 0.
//   0  Header
//  64  Section × section_count
//      the sections, in the table's order, each at the next multiple of 64
struct Header {
    char magic[8] = {'C', 'R', 'O', 'F', 'T', 'O', 'N', '\x1a'};
    std::uint32_t byte_order = 0x01020304;
    std::uint32_t version = 1;
    std::uint64_t file_size = 0;
    std::uint64_t table_checksum = 0;  // of two: the header's, with 0 here, and the table's
    std::uint32_t section_count = 0;
    std::uint32_t reserved[7] = {};
};
struct Section {
    char name[8] = {};  // padded with 0
    std::uint64_t offset = 0;
    std::uint64_t size = 0;  // bytes, a multiple of element_size
    std::uint64_t checksum = 0;
    std::uint32_t element_size = 1;
    std::uint32_t version = 0;  // of what is in it
};
static_assert(sizeof(Header) == 64 && sizeof(Section) == 40);

inline constexpr std::uint32_t kVersion = 1;          // of the container
inline constexpr std::uint32_t kClustersVersion = 2;  // of its section: changes with ClusteredMesh::serialise
inline constexpr std::size_t kAlignment = 64;
inline constexpr std::uint32_t kMaxSections = 64;

class Writer {
  public:
    // The elements are copied. Requires a new name of at most 8 characters; fewer than kMaxSections sections.
    template <class T>
    void add(std::string_view name, std::span<const T> elements) {
        add_bytes(name, std::as_bytes(elements), sizeof(T), 0);
    }
    // The same for elements of a size that is known only now.
    void add_bytes(std::string_view name, std::span<const std::byte> bytes, std::size_t element_size,
                   std::uint32_t version);
    // Adds a section of another file as it is.
    void copy(const Section& section, std::span<const std::byte> file);
    // The whole file.
    [[nodiscard]] Vector<std::byte> finish();

  private:
    Vector<Section> sections_;
    Vector<Vector<std::byte>> contents_;
};

class Reader {
  public:
    // Checks everything but what the sections mean: magic, byte order, version, sizes, places, checksums, padding.
    // Borrows the bytes, which start at a multiple of 64. Errors say what is wrong, and for sections which one;
    // cancelled, by the signal.
    [[nodiscard]] static Result<Reader> open(std::span<const std::byte> file, Executor& executor = serial_executor(),
                                             detail::StopSignal* stop = nullptr);

    // Errors: no such section, elements of another size (parse); another version (unsupported). T is plain data aligned
    // to 64 bytes at most.
    template <class T>
    [[nodiscard]] Result<std::span<const T>> section(std::string_view name, std::uint32_t version = 0) const {
        const auto bytes = find(name, sizeof(T), version);
        if (!bytes) return bytes.error();
        return std::span(reinterpret_cast<const T*>(bytes->data()), bytes->size() / sizeof(T));
    }
    [[nodiscard]] std::span<const Section> sections() const { return sections_; }
    [[nodiscard]] bool has(std::string_view name) const;

  private:
    [[nodiscard]] Result<std::span<const std::byte>> find(std::string_view name, std::size_t element_size,
                                                          std::uint32_t version) const;
    std::span<const std::byte> file_;
    std::span<const Section> sections_;
};

}  // namespace crofton::bake
