#include <algorithm>
#include <bit>
#include <cmath>
#include <crofton/core/assert.hpp>
#include <crofton/cull/bound_set.hpp>

#include "box_constraints.hpp"
#include "records.hpp"

namespace crofton::cull {
namespace {

// A radius of 4096 to 8192 quanta for a typical bound leaves room for others that are larger, and lets the centres'
// extent choose the quantum wherever the chunk is wider than some ten bounds.
constexpr double kTypicalRadius = 4096.0;
// So many strays more than when a chunk was laid out, and it is laid out anew.
constexpr std::uint32_t kTooManyStrays = kChunk / 16;

void clear_row(RowBlock& block, std::size_t lane) {
    block.xy[lane] = 0;
    block.zr[lane] = kUnboundedRadius << 16;
}

bool is_stray(const RowBlock& block, std::size_t lane) {
    return block.zr[lane] >> 16 == kUnboundedRadius;
}

// False if the row must say nothing.
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
void BoundSet<Bound>::assign(std::span<const Bound> bounds, Executor& executor) {
    size_ = bounds.size();
    rows_.resize((size_ + 63) / 64 * 4);  // whole words of verdicts
    records_.resize(size_);
    chunks_.resize((size_ + kChunk - 1) / kChunk);
    executor.parallel_for(chunks_.size(), 1, [&](std::size_t begin, std::size_t end, unsigned) {
        for (std::size_t c = begin; c < end; ++c) assign_chunk(c, bounds);
    });
    for (std::size_t i = size_; i < rows_.size() * 16; ++i) clear_row(rows_[i / 16], i % 16);
}

template <class Bound>
void BoundSet<Bound>::assign_chunk(std::size_t c, std::span<const Bound> bounds) {
    const std::size_t first = c * kChunk, last = std::min(size_, first + kChunk);
    ListChunk& chunk = chunks_[c];
    chunk = {};
    Aabb centers;
    double exponents = 0.0;
    std::size_t usable = 0;
    for (std::size_t i = first; i < last; ++i) {
        clear_row(rows_[i / 16], i % 16);
        if (!is_usable(bounds[i])) continue;
        const Sphere ball = ball_around(bounds[i]);
        centers.include(ball.center);
        exponents += std::ilogb(std::max(ball.radius, 1e-30));
        ++usable;
    }
    double extent = 1e-30;
    for (int j = 0; usable > 0 && j < 3; ++j) {
        chunk.origin[j] = centers.center()[j];
        extent = std::max({extent, centers.max[j] - chunk.origin[j], chunk.origin[j] - centers.min[j]});
    }
    const double typical = usable > 0 ? std::exp2(std::floor(exponents / static_cast<double>(usable))) : 0.0;
    const double quantum = std::max(extent * 1.0001 / kMaxRowCoordinate, typical / kTypicalRadius);
    chunk.quantum = std::exp2(std::ilogb(quantum) + 1);
    chunk.strays = static_cast<std::uint32_t>(last - first);
    for (std::size_t i = first; i < last; ++i) write(i, bounds[i]);
    chunk.accepted_strays = chunk.strays;
}

template <class Bound>
void BoundSet<Bound>::update(std::span<const std::uint32_t> items, std::span<const Bound> bounds) {
    CROFTON_ASSERT(bounds.size() == size_, "update needs all bounds of the set");
    for (const std::uint32_t i : items) {
        write(i, bounds[i]);
        const ListChunk& chunk = chunks_[i / kChunk];
        if (chunk.strays >= chunk.accepted_strays + kTooManyStrays) assign_chunk(i / kChunk, bounds);
    }
}

template <class Bound>
void BoundSet<Bound>::write(std::size_t i, const Bound& bound) {
    RowBlock& block = rows_[i / 16];
    ListChunk& chunk = chunks_[i / kChunk];
    if (is_stray(block, i % 16)) --chunk.strays;
    bool bounded = false;
    if (is_usable(bound)) {
        const Sphere ball = ball_around(bound);
        const glm::dvec3 offset = ball.center - glm::dvec3(chunk.origin[0], chunk.origin[1], chunk.origin[2]);
        records_[i] = record_of(bound, offset);
        const double reach = std::fabs(offset.x) + std::fabs(offset.y) + std::fabs(offset.z);
        chunk.reach = std::max(chunk.reach, static_cast<float>(reach * (1.0 + 0x1p-20)));
        bounded = write_row(block, i % 16, offset, ball.radius, chunk);
    } else {
        records_[i] = undecidable_record<Record>();
    }
    if (bounded) return;
    clear_row(block, i % 16);
    chunk.largest_radius = kUnboundedRadius;
    ++chunk.strays;
}

template class BoundSet<Obb>;
template class BoundSet<Aabb>;
template class BoundSet<Sphere>;

}  // namespace crofton::cull
