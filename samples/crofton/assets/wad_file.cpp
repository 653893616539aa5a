// SPDX-License-Identifier: MIT
#include "assets/wad_file.hpp"

#include <algorithm>
#include <array>

#include "assets/udmf.hpp"

namespace crofton::assets {
namespace {

constexpr std::size_t kHeaderSize = 12, kEntrySize = 16, kNameSize = 8;

struct Lump {
    std::string name;
    std::size_t offset = 0, size = 0;
};

std::uint32_t u16(std::string_view bytes, std::size_t at) {
    return static_cast<unsigned char>(bytes[at]) | static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[at + 1]))
                                                       << 8;
}
int i16(std::string_view bytes, std::size_t at) {
    return static_cast<std::int16_t>(u16(bytes, at));
}
std::size_t u32(std::string_view bytes, std::size_t at) {
    return u16(bytes, at) | std::size_t{u16(bytes, at + 2)} << 16;
}

// Up to eight letters, upper case, without what is no letter or sign.
std::string text(std::string_view bytes, std::size_t at) {
    std::string result;
    for (std::size_t i = 0; i < kNameSize && bytes[at + i] != '\0'; ++i) {
        const char c = bytes[at + i];
        result += c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : (c > ' ' && c <= '~' ? c : '?');
    }
    return result;
}

Result<std::vector<Lump>> read_directory(std::string_view wad) {
    if (wad.size() < kHeaderSize || (wad.substr(0, 4) != "IWAD" && wad.substr(0, 4) != "PWAD"))
        return fail(ErrorCode::parse, kNoItem, "not a WAD file: it does not begin with IWAD or PWAD");
    const std::size_t count = u32(wad, 4), offset = u32(wad, 8);
    if (offset > wad.size() || count > (wad.size() - offset) / kEntrySize)
        return fail(ErrorCode::parse, kNoItem,
                    "damaged: the directory of " + std::to_string(count) + " lumps ends beyond the file");
    std::vector<Lump> lumps(count);
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t at = offset + kEntrySize * i;
        lumps[i] = {text(wad, at + 8), u32(wad, at), u32(wad, at + 4)};
    }
    return lumps;
}

constexpr std::array<std::string_view, 12> kLevelLumps = {"THINGS", "LINEDEFS", "SIDEDEFS", "VERTEXES",
                                                          "SEGS",   "SSECTORS", "NODES",    "SECTORS",
                                                          "REJECT", "BLOCKMAP", "BEHAVIOR", "SCRIPTS"};

bool is_level_lump(const std::string& name) {
    return std::find(kLevelLumps.begin(), kLevelLumps.end(), name) != kLevelLumps.end();
}

bool is_udmf(const std::vector<Lump>& lumps, std::size_t level) {
    return level + 1 < lumps.size() && lumps[level + 1].name == "TEXTMAP";
}

// A level begins with a lump of its name, followed by its data. One of text ends at the lump ENDMAP; what lies between
// may look like levels.
std::vector<std::size_t> level_begins(const std::vector<Lump>& lumps) {
    std::vector<std::size_t> result;
    for (std::size_t i = 0; i + 1 < lumps.size(); ++i) {
        if (is_udmf(lumps, i)) {
            result.push_back(i);
            const auto end = std::find_if(lumps.begin() + static_cast<std::ptrdiff_t>(i), lumps.end(),
                                          [](const Lump& lump) { return lump.name == "ENDMAP"; });
            i = end == lumps.end() ? i + 1 : static_cast<std::size_t>(end - lumps.begin());
        } else if (!is_level_lump(lumps[i].name) && is_level_lump(lumps[i + 1].name)) {
            result.push_back(i);
        }
    }
    return result;
}

Result<std::string_view> contents(std::string_view wad, const std::vector<Lump>& lumps, std::size_t i) {
    if (lumps[i].offset > wad.size() || lumps[i].size > wad.size() - lumps[i].offset)
        return fail(ErrorCode::parse, i, lumps[i].name + ": ends beyond the file");
    return wad.substr(lumps[i].offset, lumps[i].size);
}

// Hexen's levels have scripts, and lines of another layout.
bool has_scripts(const std::vector<Lump>& lumps, std::size_t level) {
    for (std::size_t i = level + 1; i < lumps.size() && is_level_lump(lumps[i].name); ++i)
        if (lumps[i].name == "BEHAVIOR") return true;
    return false;
}

// The level's lump of that name as records of `record` bytes.
struct Records {
    std::string_view bytes;
    std::size_t count = 0;
};
Result<Records> find_lump(std::string_view wad, const std::vector<Lump>& lumps, std::size_t level,
                          std::string_view name, std::size_t record) {
    for (std::size_t i = level + 1; i < lumps.size() && is_level_lump(lumps[i].name); ++i) {
        if (lumps[i].name != name) continue;
        const auto bytes = contents(wad, lumps, i);
        if (!bytes) return bytes.error();
        if (lumps[i].size % record != 0)
            return fail(ErrorCode::parse, i,
                        std::string(name) + ": its size is no multiple of " + std::to_string(record) + " bytes");
        return Records{*bytes, lumps[i].size / record};
    }
    return fail(ErrorCode::parse, level, std::string(name) + ": missing");
}

Result<void> check(std::uint32_t index, std::size_t count, const char* item, std::size_t number, const char* what) {
    if (index < count) return {};
    return fail(ErrorCode::out_of_range, number,
                std::string(item) + " " + std::to_string(number) + ": " + what + " " + std::to_string(index) + " of " +
                    std::to_string(count));
}

Result<void> check_level(const WadLevel& level) {
    for (std::size_t i = 0; i < level.lines.size(); ++i) {
        const WadLevel::Line& line = level.lines[i];
        for (const std::uint32_t v : {line.from, line.to})
            if (auto good = check(v, level.vertices.size(), "line", i, "vertex"); !good) return good;
        for (const std::uint32_t s : {line.right, line.left})
            if (s != kNoSide)
                if (auto good = check(s, level.sides.size(), "line", i, "side"); !good) return good;
    }
    for (std::size_t i = 0; i < level.sides.size(); ++i)
        if (auto good = check(level.sides[i].sector, level.sectors.size(), "side", i, "sector"); !good) return good;
    return {};
}

Result<WadLevel> read_binary(std::string_view wad, const std::vector<Lump>& lumps, std::size_t begin) {
    WadLevel level;
    const auto side = [](std::uint32_t number) { return number == 0xFFFF ? kNoSide : number; };
    const auto read = [&](std::string_view lump, std::size_t record, auto&& each) -> Result<void> {
        const auto records = find_lump(wad, lumps, begin, lump, record);
        if (!records) return records.error();
        for (std::size_t i = 0; i < records->count; ++i) each(records->bytes.substr(i * record, record));
        return {};
    };
    // Behind its vertices a line has what it does: a word or more of numbers for it.
    const std::size_t line = has_scripts(lumps, begin) ? 16 : 14;
    Result<void> done = read("VERTEXES", 4, [&](std::string_view b) {
        level.vertices.push_back({i16(b, 0), i16(b, 2)});
    });
    if (done)
        done = read("LINEDEFS", line, [&](std::string_view b) {
            level.lines.push_back({u16(b, 0), u16(b, 2), side(u16(b, line - 4)), side(u16(b, line - 2))});
        });
    if (done)
        done = read("SIDEDEFS", 30, [&](std::string_view b) {
            level.sides.push_back({u16(b, 28), text(b, 4), text(b, 12), text(b, 20)});
        });
    if (done)
        done = read("SECTORS", 26, [&](std::string_view b) {
            level.sectors.push_back({i16(b, 0), i16(b, 2), std::clamp(i16(b, 20), 0, 255), text(b, 4), text(b, 12)});
        });
    if (!done) return done.error();
    return level;
}

Result<WadLevel> read_text(std::string_view wad, const std::vector<Lump>& lumps, std::size_t begin) {
    const auto text = contents(wad, lumps, begin + 1);
    if (!text) return text.error();
    return read_udmf(*text);
}

}  // namespace

Result<std::vector<std::string>> list_levels(std::string_view wad) {
    const auto lumps = read_directory(wad);
    if (!lumps) return lumps.error();
    std::vector<std::string> names;
    for (const std::size_t i : level_begins(*lumps)) names.push_back((*lumps)[i].name);
    if (names.empty()) return fail(ErrorCode::empty, kNoItem, "holds no level");
    return names;
}

Result<WadLevel> read_level(std::string_view wad, const std::string& name) {
    const auto names = list_levels(wad);
    if (!names) return names.error();
    const auto lumps = read_directory(wad);
    std::string wanted = name.empty() ? names->front() : name;
    for (char& c : wanted)
        if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
    const auto begins = level_begins(*lumps);
    const auto begin =
        std::find_if(begins.begin(), begins.end(), [&](std::size_t i) { return (*lumps)[i].name == wanted; });
    if (begin == begins.end()) {
        std::string known;
        for (const std::string& level : *names) known += " " + level;
        return fail(ErrorCode::invalid_argument, kNoItem, "no level '" + name + "'; there are:" + known);
    }
    auto level = is_udmf(*lumps, *begin) ? read_text(wad, *lumps, *begin) : read_binary(wad, *lumps, *begin);
    if (!level) return fail(level.error().code, level.error().item, wanted + ": " + level.error().message);
    level->name = wanted;
    if (auto good = check_level(*level); !good) return good.error();
    return level;
}

}  // namespace crofton::assets
