// SPDX-License-Identifier: MIT
// Data of a bake, and how parts of it are added up.
#pragma once
#include <crofton/core/memory.hpp>
#include <crofton/lines/lines.hpp>
#include <crofton/pvs/line_plan.hpp>
#include <crofton/pvs/pvs.hpp>
#include <cstdint>
#include <optional>
#include <span>

#include "cell_walk.hpp"

namespace crofton::pvs {

// Blocks [begin, end).
struct BlockRange {
    std::uint64_t begin = 0, end = 0;
};
// Sorted, apart from each other.
class BlockRanges {
  public:
    // Requires ranges that are not empty, sorted and apart. All or, without memory, nothing.
    void add(std::span<const BlockRange> ranges);
    [[nodiscard]] std::uint64_t count() const;
    [[nodiscard]] std::uint64_t count_within(BlockRange range) const;
    // The first blocks of `range` that are not in here, at most `most` of them; empty where all are.
    [[nodiscard]] BlockRange first_gap(BlockRange range, std::uint64_t most) const;
    [[nodiscard]] std::span<const BlockRange> all() const { return ranges_; }

  private:
    [[nodiscard]] std::span<const BlockRange> beyond(std::uint64_t block) const;  // those that end behind it
    Vector<BlockRange> ranges_;
};

[[nodiscard]] inline BlockRange blocks_of(const Shard& shard, std::uint64_t blocks) {
    const auto at = [&](std::uint64_t i) {  // blocks · i / count without overflow
        return blocks / shard.count * i + blocks % shard.count * i / shard.count;
    };
    return {at(shard.index), at(std::uint64_t{shard.index} + 1)};
}

// Results of lines about a cell. Lines are dealt out to twelve classes by number, and those that leave the scene set
// the bit of their class. One or two may have slipped between two triangles; many have found a way out.
enum CellFlag : std::uint16_t { kPassed = 1, kFree = 2, kSolid = 4, kFirstEscape = 16 };
inline constexpr std::uint32_t kEscapeClasses = 12;
inline constexpr int kEscapesOfOpen = 8;

// Identifies a bake: all of its parts have the same.
struct BakeName {
    std::uint64_t fingerprint = 0;  // of the geometry, the cells and the seed
    std::uint64_t cells = 0, blocks = 0;
    std::uint32_t objects = 0, sides = 0;
    double epsilon = 0.0, confidence = 0.0;
    bool operator==(const BakeName&) const = default;
};
static_assert(sizeof(BakeName) == 48);

// The part of a bake that is stored. All of it grows by OR and union.
struct Found {
    BakeName name;
    BlockRanges done;
    Vector<std::uint16_t> flags;  // by cell, of CellFlag
    Vector<std::uint64_t> seen;   // by cell, by object

    [[nodiscard]] std::size_t words() const { return (std::size_t{name.objects} + 63) / 64; }
};
[[nodiscard]] Vector<std::byte> to_bytes(const Found& found);
// Errors (parse): damaged.
[[nodiscard]] Result<Found> found_from(std::span<const std::byte> bytes);
// Requires equal names.
void add(const Found& part, Found& to);

struct Bake::State {
    Cells cells;
    BakeOptions options;
    Vector<Obb> boxes;
    glm::dvec3 origin{0.0};
    TriangleMesh mesh;  // of the geometry, relative to the origin
    Vector<std::uint32_t> object_of;
    std::uint64_t geometry = 0;   // its fingerprint
    Vector<std::uint64_t> baked;  // by object: it has triangles
    double extent = 0.0;          // of coordinates relative to the origin, cells included
    float thin = 0.0f;            // shorter ways than this are rounding's: between two sheets, through a cell's edge
    LinePlan plan;
    std::optional<CellWalk> walk;
    std::optional<lines::LineTracer> tracer;
    Found found;
};

}  // namespace crofton::pvs
