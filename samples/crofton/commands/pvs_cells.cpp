// SPDX-License-Identifier: MIT
#include "pvs_cells.hpp"

#include <cstdlib>
#include <sstream>
#include <vector>

#include "assets/file.hpp"

namespace crofton::cli {
namespace {

// A whole number without sign at the text's begin, which moves behind it.
bool take_number(const char*& text, std::uint32_t& number) {
    std::uint64_t value = 0;
    const char* begin = text;
    for (; *text >= '0' && *text <= '9' && text - begin < 10; ++text)
        value = 10 * value + static_cast<std::uint64_t>(*text - '0');
    number = static_cast<std::uint32_t>(value);
    return text != begin && value <= 0xffffffffu;
}

bool take(const char*& text, char c) {
    return *text == c && (++text, true);
}

Result<pvs::Cells> cells_of_file(const std::string& path, const assets::ReadLimits& limits) {
    const auto text = assets::read_file(path, limits.bytes);
    if (!text) return tl::unexpected(text.error());
    std::istringstream lines(*text);
    std::vector<Aabb> boxes;
    std::string line;
    for (int number = 1; std::getline(lines, line); ++number) {
        if (line.empty() || line[0] == '#') continue;
        std::istringstream values(line);
        Aabb box;
        std::string rest;
        values >> box.min.x >> box.min.y >> box.min.z >> box.max.x >> box.max.y >> box.max.z;
        if (!values || values >> rest)
            return fail(ErrorCode::parse, kNoItem, path + ": line " + std::to_string(number) + " is not six numbers");
        boxes.push_back(box);
    }
    auto cells = pvs::Cells::boxes(boxes);
    if (!cells) return fail(cells.error().code, cells.error().item, path + ": " + cells.error().message);
    return cells;
}

}  // namespace

Result<pvs::Cells> cells_from(const std::string& text, const Aabb& eyes, const assets::ReadLimits& limits) {
    glm::uvec3 counts(0);
    const char* at = text.c_str();
    if (take_number(at, counts.x) && take(at, 'x') && take_number(at, counts.y) && take(at, 'x') &&
        take_number(at, counts.z) && *at == '\0')
        return pvs::Cells::grid(eyes, counts);
    return cells_of_file(text, limits);
}

Result<pvs::Shard> shard_from(const std::string& text) {
    pvs::Shard shard;
    if (text.empty()) return shard;
    const char* at = text.c_str();
    if (take_number(at, shard.index) && take(at, '/') && take_number(at, shard.count) && *at == '\0' &&
        shard.index < shard.count)
        return shard;
    return fail(ErrorCode::invalid_argument, kNoItem, "--shard: " + text + " is not i/n with 0 <= i < n");
}

Result<void> read_numbers(const char* option, const std::string& text, std::span<double> numbers) {
    const char* at = text.c_str();
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        char* end = nullptr;
        numbers[i] = std::strtod(at, &end);
        const bool last = i + 1 == numbers.size();
        if (end == at || *end != (last ? '\0' : ','))
            return fail(ErrorCode::invalid_argument, kNoItem,
                        std::string(option) + ": " + text + " is not " + std::to_string(numbers.size()) +
                            " numbers with commas between them");
        at = end + 1;
    }
    return {};
}

}  // namespace crofton::cli
