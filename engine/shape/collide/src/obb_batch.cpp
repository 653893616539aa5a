// SPDX-License-Identifier: MIT
// Overlap of many pairs of boxes, sixteen at a time.
#include <hwy/cache_control.h>
#include <algorithm>
#include <bit>
#include <cmath>
#include <crofton/collide/narrow_phase.hpp>
#include <crofton/core/error.hpp>

#include "block_filter.hpp"
#include "box_lanes.hpp"
#include "careful_axis.hpp"

namespace crofton::collide {
namespace {

constexpr std::uint32_t kAllLanes = (1u << kBoxBlock) - 1u;

// Writes the answers of up to sixteen pairs; `box(side, lane)` gives the boxes of those that are still open.
template <class Boxes>
void finish(const BlockVerdict& verdict, std::size_t count, Boxes box, std::uint8_t* hits,
            BatchStatistics& statistics) {
    const std::uint32_t lanes = count == kBoxBlock ? kAllLanes : (1u << count) - 1u;
    const std::uint32_t decided = verdict.face_a | verdict.face_b | verdict.edges | verdict.hit;
    const auto counted = [&](std::uint32_t bits) { return static_cast<std::uint64_t>(std::popcount(bits & lanes)); };
    statistics.separated_by_face_a += counted(verdict.face_a);
    statistics.separated_by_face_b += counted(verdict.face_b);
    statistics.separated_by_edges += counted(verdict.edges);
    statistics.hits += counted(verdict.hit);
    for (std::size_t lane = 0; lane < count; ++lane) hits[lane] = static_cast<std::uint8_t>(verdict.hit >> lane & 1u);
    for (std::uint32_t open = ~decided & lanes; open != 0; open &= open - 1) {
        const auto lane = static_cast<std::size_t>(std::countr_zero(open));
        const int axis = careful_axis(box(0, lane), box(1, lane));
        ++statistics.refined;
        hits[lane] = axis == kNotSeparated;
        ++(axis == kNotSeparated ? statistics.hits
           : axis < 3            ? statistics.separated_by_face_a
           : axis < 6            ? statistics.separated_by_face_b
                                 : statistics.separated_by_edges);
    }
}

void fetch(const Obb& box) {
    const char* const bytes = reinterpret_cast<const char*>(&box);
    hwy::Prefetch(bytes);
    hwy::Prefetch(bytes + sizeof(Obb) - 1);
}

// Any two boxes by index: blocks of offsets are made on the way. `ahead(i)` is called some time before pair i is read.
template <class Boxes, class Ahead>
BatchStatistics intersect_all(std::size_t count, Boxes box, Ahead ahead, std::span<std::uint8_t> hits) {
    constexpr std::size_t kAhead = 2 * kBoxBlock;
    BatchStatistics statistics;
    BoxBlock a, b;
    for (std::size_t begin = 0; begin < count; begin += kBoxBlock) {
        const std::size_t size = std::min(kBoxBlock, count - begin);
        for (std::size_t lane = 0; lane < kBoxBlock; ++lane) {
            const std::size_t i = begin + std::min(lane, size - 1);
            ahead(std::min(i + kAhead, count - 1));
            const Obb &first = box(0, i), &second = box(1, i);
            put_center(second.center - first.center, lane, b);
            put_shape(first, lane, a);
            put_shape(second, lane, b);
        }
        measure_deviation(a);
        measure_deviation(b);
        finish(
            filter_block(a, b), size, [&](int side, std::size_t lane) -> const Obb& { return box(side, begin + lane); },
            hits.data() + begin, statistics);
    }
    return statistics;
}

}  // namespace

BatchStatistics& BatchStatistics::operator+=(const BatchStatistics& other) {
    separated_by_face_a += other.separated_by_face_a;
    separated_by_face_b += other.separated_by_face_b;
    separated_by_edges += other.separated_by_edges;
    hits += other.hits;
    refined += other.refined;
    return *this;
}

BatchStatistics intersects(std::span<const Obb> a, std::span<const Obb> b, std::span<std::uint8_t> hits) {
    CROFTON_ASSERT(a.size() == b.size() && hits.size() == a.size(), "one answer a pair");
    return intersect_all(
        a.size(), [&](int side, std::size_t i) -> const Obb& { return side == 0 ? a[i] : b[i]; }, [](std::size_t) {},
        hits);
}

BatchStatistics intersects(std::span<const Obb> boxes, std::span<const IdPair> pairs, std::span<std::uint8_t> hits) {
    CROFTON_ASSERT(hits.size() == pairs.size(), "one answer a pair");
    return intersect_all(
        pairs.size(),
        [&](int side, std::size_t i) -> const Obb& { return boxes[side == 0 ? pairs[i].first : pairs[i].second]; },
        [&](std::size_t i) {
            fetch(boxes[pairs[i].first]);
            fetch(boxes[pairs[i].second]);
        },
        hits);
}

}  // namespace crofton::collide
