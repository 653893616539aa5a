// SPDX-License-Identifier: MIT
// The container of a .crofton file: a header, a table of sections, and a checksum for each.
#include <crofton/bake/container.hpp>

#include <algorithm>
#include <crofton/bake/checksum.hpp>
#include <crofton/core/error.hpp>
#include <crofton/core/recovery.hpp>
#include <string_view>

namespace crofton::bake {
namespace {

constexpr std::size_t aligned(std::size_t size) {
    return (size + kAlignment - 1) / kAlignment * kAlignment;
}

Error damaged(std::initializer_list<MessagePart> what, std::uint64_t item = kNoItem) {
    return fail(ErrorCode::parse, item, what);
}

std::string_view name_of(const Section& section) {
    const char* end = std::find(section.name, section.name + sizeof section.name, '\0');
    return {section.name, static_cast<std::size_t>(end - section.name)};
}

bool all_zero(std::span<const std::byte> bytes) {
    return std::all_of(bytes.begin(), bytes.end(), [](std::byte byte) { return byte == std::byte{0}; });
}

std::uint64_t checksum_of(Header header, std::span<const Section> table) {
    header.table_checksum = 0;
    const std::uint64_t sums[] = {checksum(std::as_bytes(std::span(&header, 1))), checksum(std::as_bytes(table))};
    return checksum(std::as_bytes(std::span(sums)));
}

Result<void> check_header(const Header& header, std::size_t size) {
    if (std::memcmp(header.magic, Header().magic, sizeof header.magic) != 0)
        return damaged({"not a .crofton file (its first eight bytes are others)"});
    if (header.byte_order != Header().byte_order)
        return fail(ErrorCode::unsupported, kNoItem, "the file's byte order is not this machine's");
    if (header.version != kVersion)
        return fail(
            ErrorCode::unsupported, kNoItem,
            {"the file is of version ", header.version, ", this library reads version ", kVersion, ": bake it again"});
    if (header.file_size != size)
        return damaged(
            {"the file has ", size, " bytes, its header says ", header.file_size, ": cut off or appended to"});
    if (header.section_count > kMaxSections || sizeof(Header) + header.section_count * sizeof(Section) > size)
        return damaged({"the header's section count is out of range"});
    return {};
}

// Sections follow one another; everything between them is padding.
Result<void> check_places(std::span<const std::byte> file, std::span<const Section> sections) {
    std::size_t end = sizeof(Header) + sections.size_bytes();
    for (std::size_t i = 0; i < sections.size(); ++i) {
        const Section& section = sections[i];
        const std::size_t begin = aligned(end);
        if (section.offset != begin || begin > file.size() || section.size > file.size() - begin)
            return damaged({"section '", name_of(section), "' lies outside its place in the file"}, i);
        if (section.element_size == 0 || section.size % section.element_size != 0)
            return damaged({"section '", name_of(section), "' does not hold whole elements"}, i);
        if (!all_zero(file.subspan(end, begin - end)))
            return damaged({"section '", name_of(section), "': padding before it"}, i);
        end = begin + section.size;
    }
    if (file.size() != aligned(end) || !all_zero(file.subspan(end))) return damaged({"bytes after the last section"});
    return {};
}

}  // namespace

void Writer::add_bytes(std::string_view name, std::span<const std::byte> bytes, std::size_t element_size,
                       std::uint32_t version) {
    Section section;
    CROFTON_ASSERT(name.size() <= sizeof section.name && sections_.size() < kMaxSections,
                   "a short name and few sections");
    std::memcpy(section.name, name.data(), std::min(name.size(), sizeof section.name));
    section.size = bytes.size();
    section.element_size = static_cast<std::uint32_t>(element_size);
    section.version = version;
    section.checksum = checksum(bytes);
    sections_.push_back(section);
    contents_.emplace_back(bytes.begin(), bytes.end());
}

void Writer::copy(const Section& section, std::span<const std::byte> file) {
    add_bytes(name_of(section), file.subspan(section.offset, section.size), section.element_size, section.version);
}

Vector<std::byte> Writer::finish() {
    std::size_t end = sizeof(Header) + sections_.size() * sizeof(Section);
    for (Section& section : sections_) {
        section.offset = aligned(end);
        end = section.offset + section.size;
    }
    Header header;
    header.file_size = aligned(end);
    header.section_count = static_cast<std::uint32_t>(sections_.size());
    header.table_checksum = checksum_of(header, sections_);
    Vector<std::byte> file(header.file_size);
    std::memcpy(file.data(), &header, sizeof header);
    if (!sections_.empty())
        std::memcpy(file.data() + sizeof header, sections_.data(), sections_.size() * sizeof(Section));
    for (std::size_t i = 0; i < sections_.size(); ++i)
        if (!contents_[i].empty())
            std::memcpy(file.data() + sections_[i].offset, contents_[i].data(), contents_[i].size());
    return file;
}

Result<Reader> Reader::open(std::span<const std::byte> file, Executor& executor, detail::StopSignal* stop) {
    return detail::recover([&]() -> Result<Reader> {
        CROFTON_ASSERT(reinterpret_cast<std::uintptr_t>(file.data()) % kAlignment == 0,
                       "the bytes start at a multiple of 64");
        if (file.size() < sizeof(Header)) return damaged({"too short for a .crofton file"});
        Header header;
        std::memcpy(&header, file.data(), sizeof header);
        if (const auto good = check_header(header, file.size()); !good) return good.error();
        Reader reader;
        reader.file_ = file;
        reader.sections_ = {reinterpret_cast<const Section*>(file.data() + sizeof(Header)), header.section_count};
        if (header.table_checksum != checksum_of(header, reader.sections_))
            return damaged({"the header or the table of sections is damaged (its checksum differs)"});
        if (const auto good = check_places(file, reader.sections_); !good) return good.error();
        for (std::size_t i = 0; i < reader.sections_.size(); ++i) {
            const Section& section = reader.sections_[i];
            if (stop != nullptr &&
                stop->is_raised(0.5 * static_cast<double>(section.offset) / static_cast<double>(file.size())))
                return detail::cancelled("container");
            if (checksum(file.subspan(section.offset, section.size), executor) != section.checksum)
                return damaged({"section '", name_of(section), "' is damaged (its checksum differs)"}, i);
        }
        return reader;
    });
}

bool Reader::has(std::string_view name) const {
    return std::any_of(sections_.begin(), sections_.end(), [&](const Section& s) { return name_of(s) == name; });
}

Result<std::span<const std::byte>> Reader::find(std::string_view name, std::size_t element_size,
                                                std::uint32_t version) const {
    for (const Section& section : sections_) {
        if (name_of(section) != name) continue;
        if (section.version != version)
            return fail(ErrorCode::unsupported, kNoItem,
                        {"section '", name, "' is of version ", section.version, ", this library reads version ",
                         version, ": bake it again"});
        if (section.element_size != element_size) return damaged({"section '", name, "' has elements of another size"});
        return file_.subspan(section.offset, section.size);
    }
    return damaged({"section '", name, "' is missing: is this a file of another kind?"});
}

}  // namespace crofton::bake
