// SPDX-License-Identifier: MIT
#include "pvs_cells.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
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
    if (!text) return text.error();
    std::istringstream lines(*text);
    std::vector<Aabb> boxes;
    std::vector<pvs::ConvexCell> convex;
    bool all_boxes = true;
    std::string line;
    for (int number = 1; std::getline(lines, line); ++number) {
        if (line.empty() || line[0] == '#') continue;
        std::istringstream values(line);
        std::vector<double> numbers;
        for (double value = 0.0; values >> value;) numbers.push_back(value);
        const std::size_t corners = numbers.size() / 3;
        const bool box = numbers.size() == 6;
        if (!values.eof() || numbers.size() % 3 != 0 || !(box || (corners >= 4 && corners <= 8)))
            return fail(ErrorCode::parse, kNoItem,
                        path + ": line " + std::to_string(number) +
                            " is neither six numbers, a box, nor four to eight corners of three numbers each");
        const auto point = [&](std::size_t i) {
            return glm::dvec3(numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]);
        };
        boxes.push_back({point(0), point(1)});
        all_boxes = all_boxes && box;
        auto& cell = convex.emplace_back();
        for (std::size_t i = 0; i < 8; ++i)
            cell.corners[i] = box ? glm::dvec3(point(i & 1).x, point(i >> 1 & 1).y, point(i >> 2).z)
                                  : point(std::min(i, corners - 1));
    }
    auto cells = all_boxes ? pvs::Cells::boxes(boxes) : pvs::Cells::convex(convex);
    if (!cells) return fail(cells.error().code, cells.error().item, path + ": " + cells.error().message);
    return cells;
}

constexpr double kThinnest = 0.01;  // metres

using Ring = std::vector<glm::dvec2>;  // a convex polygon, (x, z)

// Returns the part of a ring where dot(normal, x) ≥ least.
Ring clipped(const Ring& ring, const glm::dvec2& normal, double least) {
    Ring kept;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const glm::dvec2 &a = ring[i], &b = ring[(i + 1) % ring.size()];
        const double from = glm::dot(normal, a) - least, to = glm::dot(normal, b) - least;
        if (from >= 0.0) kept.push_back(a);
        if ((from < 0.0) != (to < 0.0)) kept.push_back(a + from / (from - to) * (b - a));
    }
    return kept;
}

// Returns the part of a room that is at least `inset` from its walls.
Ring inner_ring(const assets::Room& room, double inset) {
    const bool is_triangle = room.corners[3] == room.corners[2];
    Ring ring(room.corners.begin(), room.corners.end() - (is_triangle ? 1 : 0));
    for (std::size_t k = 0; k < 4; ++k) {
        if (!room.is_wall[k]) continue;
        const glm::dvec2 &p = room.corners[k], along = glm::normalize(room.corners[(k + 1) % 4] - p);
        const glm::dvec2 inward(along.y, -along.x);
        ring = clipped(ring, inward, glm::dot(inward, p) + inset);
    }
    return ring;
}

// Halves a ring until no piece is longer than `size` in x or z. Pieces go to `pieces`.
void cut_to_size(const Ring& ring, double size, std::vector<Ring>& pieces) {
    if (ring.size() < 3) return;
    glm::dvec2 low = ring[0], high = ring[0];
    for (const glm::dvec2& p : ring) low = glm::min(low, p), high = glm::max(high, p);
    const glm::dvec2 extent = high - low;
    if (extent.x <= size && extent.y <= size) {
        pieces.push_back(ring);
        return;
    }
    const glm::dvec2 normal = extent.x > extent.y ? glm::dvec2(1.0, 0.0) : glm::dvec2(0.0, 1.0);
    const double middle = glm::dot(normal, 0.5 * (low + high));
    cut_to_size(clipped(ring, normal, middle), size, pieces);
    cut_to_size(clipped(ring, -normal, -middle), size, pieces);
}

// Prisms of up to four sides that fill the ring, but for those that are too thin to stand in.
void add_prisms(const Ring& ring, double low, double high, std::vector<pvs::ConvexCell>& cells) {
    for (std::size_t first = 1; first + 1 < ring.size(); first += 2) {
        const std::size_t last = std::min(first + 2, ring.size() - 1);
        const glm::dvec2 corners[4] = {ring[0], ring[first], ring[first + 1], ring[last]};
        const glm::dvec2 diagonal = corners[2] - corners[0];
        const auto side = [&](const glm::dvec2& p) {
            return std::abs(diagonal.x * (p.y - corners[0].y) - diagonal.y * (p.x - corners[0].x));
        };
        if (side(corners[1]) + side(corners[3]) <= kThinnest * glm::length(diagonal)) continue;
        pvs::ConvexCell cell;
        for (std::size_t k = 0; k < 8; ++k) cell.corners[k] = {corners[k % 4].x, k < 4 ? low : high, corners[k % 4].y};
        cells.push_back(cell);
    }
}

Result<pvs::Cells> cells_of_rooms(const assets::SceneSource& source, const RoomOptions& options) {
    if (source.rooms.empty())
        return fail(ErrorCode::unsupported, kNoItem,
                    "--cells rooms: " + source.name + " has no sectors; take a grid, or a file of cells");
    std::vector<pvs::ConvexCell> cells;
    std::vector<Ring> pieces;
    for (const assets::Room& room : source.rooms) {
        const double low = room.floor + (room.has_floor ? options.inset : 0.0),
                     high = room.ceiling - (room.has_ceiling ? options.inset : 0.0);
        if (high - low <= kThinnest) continue;
        pieces.clear();
        cut_to_size(inner_ring(room, options.inset), options.size, pieces);
        for (const Ring& piece : pieces) add_prisms(piece, low, high, cells);
    }
    if (cells.empty())
        return fail(ErrorCode::empty, kNoItem,
                    "--cells rooms: no room is larger than twice the near radius; choose a smaller --near");
    return pvs::Cells::convex(cells);
}

}  // namespace

Result<pvs::Cells> cells_from(const std::string& text, const Aabb& eyes, const assets::SceneSource& source,
                              const RoomOptions& rooms, const assets::ReadLimits& limits) {
    if (text == "rooms") return cells_of_rooms(source, rooms);
    if (const auto counts = grid_from(text)) return pvs::Cells::grid(eyes, *counts);
    std::error_code error;
    if (!std::filesystem::exists(text, error))
        return fail(ErrorCode::invalid_argument, kNoItem,
                    "--cells " + text + ": there is no such file; a grid is three numbers, as 64x2x64; or take rooms");
    return cells_of_file(text, limits);
}

std::optional<glm::uvec3> grid_from(const std::string& text) {
    glm::uvec3 counts(0);
    const char* at = text.c_str();
    if (take_number(at, counts.x) && take(at, 'x') && take_number(at, counts.y) && take(at, 'x') &&
        take_number(at, counts.z) && *at == '\0')
        return counts;
    return std::nullopt;
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
