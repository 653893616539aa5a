// SPDX-License-Identifier: MIT
// Makes the checksums of a .crofton file right, whatever it holds: an adversary would.
#pragma once
#include <crofton/bake/checksum.hpp>
#include <crofton/bake/container.hpp>
#include <cstring>
#include <span>

namespace crofton::fuzz {

inline void mend_checksums(std::span<std::byte> file) {
    bake::Header header;
    if (file.size() < sizeof header) return;
    std::memcpy(&header, file.data(), sizeof header);
    header.file_size = file.size();
    if (header.section_count > bake::kMaxSections ||
        sizeof header + header.section_count * sizeof(bake::Section) > file.size())
        return;
    const std::span table(reinterpret_cast<bake::Section*>(file.data() + sizeof header), header.section_count);
    for (bake::Section& section : table)
        if (section.offset <= file.size() && section.size <= file.size() - section.offset)
            section.checksum = bake::checksum(file.subspan(section.offset, section.size));
    header.table_checksum = 0;
    const std::uint64_t sums[] = {bake::checksum(std::as_bytes(std::span(&header, 1))),
                                  bake::checksum(std::as_bytes(table))};
    header.table_checksum = bake::checksum(std::as_bytes(std::span(sums)));
    std::memcpy(file.data(), &header, sizeof header);
}

}  // namespace crofton::fuzz
