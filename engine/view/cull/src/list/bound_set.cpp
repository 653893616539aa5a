// SPDX-License-Identifier: MIT
// A list prepared for vectors: chunks with a frame, rows and records of their bounds.
#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <crofton/core/error.hpp>
#include <crofton/cull/bound_set.hpp>
#include <crofton/cull/list_layout.hpp>

#include "exact/box_constraints.hpp"
#include "list/box_writer.hpp"
#include "list/records.hpp"

namespace crofton::cull {
namespace {

// A radius of 4096 to 8192 quanta for a typical bound leaves room for others that are larger. The centres' extent
// chooses the quantum wherever the chunk is wider than some ten bounds.
constexpr double kTypicalRadius = 4096.0;
// A chunk gets a new frame when so many more bounds are out of frame than when the last one was chosen.
constexpr std::uint32_t kMostOutOfFrame = kChunk / 16;

void clear_row(RowBlock& block, std::size_t lane) {
    block.xy[lane] = 0;
    block.zr[lane] = kUnboundedRadius << 16;
}

bool is_out_of_frame(const RowBlock& block, std::size_t lane) {
    return block.zr[lane] >> 16 == kUnboundedRadius;
}

// Writes a row; false, and the row is empty, if the bound is out of frame.
bool write_row(RowBlock& block, std::size_t lane, const glm::dvec3& offset, double radius, ListChunk& chunk) {
    std::int32_t at[3];
    for (int j = 0; j < 3; ++j) {
        const double scaled = std::nearbyint(offset[j] / chunk.quantum);
        if (!(std::fabs(scaled) <= kMaxRowCoordinate)) return false;
        at[j] = static_cast<std::int32_t>(scaled);
    }
    const double size = std::ceil(radius * (1.0 + 0x1p-9) / chunk.quantum) + 1.0;
    if (!(size < kUnboundedRadius)) return false;
    const auto half = [](std::int32_t value) { return static_cast<std::uint32_t>(value) & 0xffffu; };
    const auto whole = static_cast<std::uint32_t>(size);
    block.xy[lane] = half(at[0]) | half(at[1]) << 16;
    block.zr[lane] = half(at[2]) | whole << 16;
    for (int j = 0; j < 3; ++j) chunk.extent[j] = std::max(chunk.extent[j], std::abs(at[j]));
    chunk.largest_radius = std::max(chunk.largest_radius, whole);
    return true;
}

}  // namespace

template <class Bound>
BoundSet<Bound>::BoundSet() = default;
template <class Bound>
BoundSet<Bound>::~BoundSet() = default;
template <class Bound>
BoundSet<Bound>::BoundSet(const BoundSet&) = default;
template <class Bound>
BoundSet<Bound>& BoundSet<Bound>::operator=(const BoundSet&) = default;
template <class Bound>
BoundSet<Bound>::BoundSet(BoundSet&&) noexcept = default;
template <class Bound>
BoundSet<Bound>& BoundSet<Bound>::operator=(BoundSet&&) noexcept = default;

template <class Bound>
std::span<const RowBlock> BoundSet<Bound>::rows() const {
    return rows_;
}
template <class Bound>
std::span<const typename BoundSet<Bound>::Record> BoundSet<Bound>::records() const {
    return records_;
}
template <class Bound>
std::size_t BoundSet<Bound>::size() const {
    return records_.size();
}

template <class Bound>
std::span<const ListChunk> BoundSet<Bound>::chunks() const {
    return chunks_;
}

template <class Bound>
void BoundSet<Bound>::resize(std::size_t size) {
    rows_.resize((size + 63) / 64 * 4);  // whole words of verdicts
    records_.resize(size);
    chunks_.resize((size + kChunk - 1) / kChunk);
    const std::size_t whole = (size + 15) / 16;
    for (std::size_t i = size; i < whole * 16; ++i) clear_row(rows_[i / 16], i % 16);
    for (RowBlock& block : std::span(rows_).subspan(whole)) {
        std::fill_n(block.xy, 16, 0u);
        std::fill_n(block.zr, 16, kUnboundedRadius << 16);
    }
}

template <class Bound>
void BoundSet<Bound>::assign(std::span<const Bound> bounds, Executor& executor) {
    chunks_.clear();
    (void)update(bounds, executor);
}

template <class Bound>
void BoundSet<Bound>::assign_chunk(std::size_t c, std::span<const Bound> bounds) {
    choose_frame(c, bounds);
    (void)fill_chunk(c, bounds);
    chunks_[c].out_of_frame_at_layout = chunks_[c].out_of_frame;
}

template <class Bound>
void BoundSet<Bound>::choose_frame(std::size_t c, std::span<const Bound> bounds) {
    ListChunk& chunk = chunks_[c];
    chunk = {};
    Aabb centers;
    double exponents = 0.0;
    std::size_t usable = 0;
    for (const Bound& bound : bounds.subspan(c * kChunk, std::min(kChunk, size() - c * kChunk))) {
        if (!is_usable(bound)) continue;
        const Sphere sphere = sphere_around(bound);
        centers.include(sphere.center);
        exponents += std::ilogb(std::max(sphere.radius, 1e-30));
        ++usable;
    }
    double extent = 1e-30;
    for (int j = 0; usable > 0 && j < 3; ++j) {
        chunk.origin[j] = centers.center()[j];
        extent = std::max({extent, centers.max[j] - chunk.origin[j], chunk.origin[j] - centers.min[j]});
    }
    const double typical =
        usable > 0 ? std::ldexp(1.0, static_cast<int>(std::floor(exponents / static_cast<double>(usable)))) : 0.0;
    const double quantum = std::max(extent * 1.0001 / kMaxRowCoordinate, typical / kTypicalRadius);
    chunk.quantum = std::ldexp(1.0, std::ilogb(quantum) + 1);
}

// Writes all bounds of a chunk whose frame is chosen. Returns the first invalid one, or size().
template <class Bound>
std::size_t BoundSet<Bound>::fill_chunk(std::size_t c, std::span<const Bound> bounds) {
    std::size_t invalid = size();
    const std::size_t first = c * kChunk, count = std::min(size() - first, kChunk);
    ListChunk& chunk = chunks_[c];
    if constexpr (std::is_same_v<Bound, Obb>) {
        std::uint32_t rejected[kChunk];
        const std::size_t rejected_count =
            write_boxes(&bounds[first], count, chunk, &rows_[first / 16], &records_[first], rejected);
        for (std::size_t n = rejected_count; n-- > 0;) {
            const std::size_t i = first + rejected[n];
            write(i, bounds[i]);
            if (!validate(bounds[i])) invalid = i;
        }
    } else {
        for (std::size_t i = first; i < first + count; ++i) clear_row(rows_[i / 16], i % 16);
        chunk.l1_radius = 0.0f;
        chunk.largest_radius = 0;
        for (std::int32_t& extent : chunk.extent) extent = 0;
        chunk.out_of_frame = static_cast<std::uint32_t>(count);
        for (std::size_t i = first + count; i-- > first;) {
            write(i, bounds[i]);
            if (!is_usable(bounds[i])) invalid = i;
        }
    }
    return invalid;
}

// Whether too many of its bounds are out of frame, or its integers are twice as coarse as they need be.
template <class Bound>
bool BoundSet<Bound>::wants_new_frame(const ListChunk& chunk) {
    if (chunk.out_of_frame >= chunk.out_of_frame_at_layout + kMostOutOfFrame) return true;
    const std::int32_t farthest = std::max({chunk.extent[0], chunk.extent[1], chunk.extent[2]});
    return farthest < kMaxRowCoordinate / 4 && chunk.largest_radius < static_cast<std::uint32_t>(kTypicalRadius) / 4;
}

template <class Bound>
std::size_t BoundSet<Bound>::update(std::span<const Bound> bounds, Executor& executor) {
    const std::size_t laid_out = chunks_.size();
    resize(bounds.size());
    std::atomic<std::size_t> first_invalid = size();
    executor.parallel_for(chunks_.size(), 1, [&](std::size_t begin, std::size_t end, unsigned) {
        for (std::size_t c = begin; c < end; ++c) {
            if (c >= laid_out) choose_frame(c, bounds);
            const std::size_t invalid = fill_chunk(c, bounds);
            std::size_t before = first_invalid;
            while (invalid < before && !first_invalid.compare_exchange_weak(before, invalid)) {
            }
            if (c >= laid_out) chunks_[c].out_of_frame_at_layout = chunks_[c].out_of_frame;
            if (wants_new_frame(chunks_[c])) assign_chunk(c, bounds);
        }
    });
    return first_invalid;
}

template <class Bound>
void BoundSet<Bound>::update(std::span<const std::uint32_t> items, std::span<const Bound> bounds) {
    CROFTON_ASSERT(bounds.size() == size(), "update needs all bounds of the set");
    for (; !items.empty(); items = items.subspan(std::min(items.size(), kWriteBatch))) {
        const std::span<const std::uint32_t> batch = items.first(std::min(items.size(), kWriteBatch));
        if constexpr (std::is_same_v<Bound, Obb>) {
            std::uint32_t rejected[kWriteBatch];
            const std::size_t rejected_count = write_boxes(bounds.data(), batch.data(), batch.size(), chunks_.data(),
                                                           rows_.data(), records_.data(), rejected);
            for (std::size_t i = 0; i < rejected_count; ++i) write(rejected[i], bounds[rejected[i]]);
        } else {
            for (const std::uint32_t i : batch) write(i, bounds[i]);
        }
        for (const std::uint32_t i : batch) {
            const ListChunk& chunk = chunks_[i / kChunk];
            if (chunk.out_of_frame >= chunk.out_of_frame_at_layout + kMostOutOfFrame) assign_chunk(i / kChunk, bounds);
        }
    }
}

template <class Bound>
void BoundSet<Bound>::write(std::size_t i, const Bound& bound) {
    RowBlock& block = rows_[i / 16];
    ListChunk& chunk = chunks_[i / kChunk];
    if (is_out_of_frame(block, i % 16)) --chunk.out_of_frame;
    bool bounded = false;
    if (is_usable(bound)) {
        const Sphere sphere = sphere_around(bound);
        const glm::dvec3 offset = sphere.center - glm::dvec3(chunk.origin[0], chunk.origin[1], chunk.origin[2]);
        records_[i] = record_of(bound, offset);
        const double l1_radius = std::fabs(offset.x) + std::fabs(offset.y) + std::fabs(offset.z);
        chunk.l1_radius = std::max(chunk.l1_radius, static_cast<float>(l1_radius * (1.0 + 0x1p-20)));
        bounded = write_row(block, i % 16, offset, sphere.radius, chunk);
    } else {
        records_[i] = undecidable_record<Record>();
    }
    if (bounded) return;
    clear_row(block, i % 16);
    chunk.largest_radius = kUnboundedRadius;
    ++chunk.out_of_frame;
}

template class BoundSet<Obb>;
template class BoundSet<Aabb>;
template class BoundSet<Sphere>;

}  // namespace crofton::cull
