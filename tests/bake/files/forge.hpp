// SPDX-License-Identifier: MIT
// Baked files changed as a forger would change them: every checksum is right.
#pragma once
#include <doctest/doctest.h>
#include <crofton/bake/checksum.hpp>
#include <crofton/bake/container.hpp>
#include <cstring>
#include <string>
#include <string_view>

namespace crofton::bake_test {

inline void make_sums_right(Vector<std::byte>& file) {
    bake::Header header;
    std::memcpy(&header, file.data(), sizeof header);
    auto* sections = reinterpret_cast<bake::Section*>(file.data() + sizeof header);
    const std::span<const std::byte> bytes(file);
    // A section that leads out of the file has no sum: the reader refuses it by its place.
    for (bake::Section& section : std::span(sections, header.section_count))
        if (section.offset <= bytes.size() && section.size <= bytes.size() - section.offset)
            section.checksum = bake::checksum(bytes.subspan(section.offset, section.size));
    header.table_checksum = 0;
    const std::span<const bake::Section> table(sections, header.section_count);
    const std::uint64_t sums[] = {bake::checksum(std::as_bytes(std::span(&header, 1))),
                                  bake::checksum(std::as_bytes(table))};
    header.table_checksum = bake::checksum(std::as_bytes(std::span(sums)));
    std::memcpy(file.data(), &header, sizeof header);
}

// Changes the table: change(header, sections).
template <class Change>
Vector<std::byte> with_table(Vector<std::byte> file, Change change) {
    auto* header = reinterpret_cast<bake::Header*>(file.data());
    change(*header, reinterpret_cast<bake::Section*>(file.data() + sizeof(bake::Header)));
    make_sums_right(file);
    return file;
}

// Changes element `index` of a section.
template <class T, class Change>
Vector<std::byte> with_element(const Vector<std::byte>& file, std::string_view name, std::size_t index, Change change) {
    return with_table(file, [&](const bake::Header& header, const bake::Section* sections) {
        for (std::uint32_t i = 0; i < header.section_count; ++i) {
            char known[9] = {};
            std::memcpy(known, sections[i].name, 8);
            if (name != known) continue;
            REQUIRE((index + 1) * sizeof(T) <= sections[i].size);
            auto* bytes = const_cast<char*>(reinterpret_cast<const char*>(&header)) + sections[i].offset;
            change(*reinterpret_cast<T*>(bytes + index * sizeof(T)));
            return;
        }
        FAIL("no such section");
    });
}

}  // namespace crofton::bake_test
