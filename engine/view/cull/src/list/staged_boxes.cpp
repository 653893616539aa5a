// SPDX-License-Identifier: MIT
// Updates of MovingBoxes in pieces.
#include <algorithm>
#include <bit>
#include <crofton/core/consecutive.hpp>
#include <crofton/cull/bound_set.hpp>
#include <crofton/cull/list_layout.hpp>

#include "list/box_writer.hpp"

namespace crofton::cull {
namespace {

// Sets the entries' bits.
void mark(std::span<std::uint64_t> bits, std::span<const std::uint32_t> entries, bool in_order) {
    if (!in_order) {
        for (const std::uint32_t entry : entries) bits[entry / 64] |= std::uint64_t{1} << entry % 64;
        return;
    }
    for (std::size_t entry = entries.empty() ? 0 : entries[0], left = entries.size(); left > 0;) {
        const std::size_t here = std::min(left, 64 - entry % 64);
        bits[entry / 64] |= ~std::uint64_t{0} >> (64 - here) << entry % 64;
        entry += here;
        left -= here;
    }
}

}  // namespace

// Gives the next set the frames of the present one, and extents that start at zero.
void MovingBoxes::begin_staging() {
    const BoxSet& shown = sets_[now_];
    BoxSet& next = sets_[1 - now_];
    next.resize(size());
    for (std::size_t c = 0; c < next.chunks_.size(); ++c) {
        next.chunks_[c] = shown.chunks_[c];
        next.chunks_[c].largest_radius = 0;
        next.chunks_[c].l1_radius = 0.0f;
        for (std::int32_t& extent : next.chunks_[c].extent) extent = 0;
    }
    staged_.assign((size() + 63) / 64, 0);
    for (std::uint8_t& shapes : shapes_) shapes &= kShapesWritten;
}

std::size_t MovingBoxes::stage(std::span<const std::uint32_t> entries, const Obb* first, std::size_t stride,
                               const Obb* before, std::uint8_t* differs) {
    if (entries.empty()) return 0;
    if (staged_.empty()) begin_staging();
    BoxSet& next = sets_[1 - now_];
    shapes_.resize(before != nullptr ? (size() + 15) / 16 : 0, 0);
    const bool in_order = are_consecutive(entries);
    const std::size_t count =
        write_strided_boxes(first, stride, entries, in_order, next.chunks_.data(), next.rows_.data(),
                            next.records_.data(), before, shapes_.data(), differs);
    mark(staged_, entries.first(count), in_order);
    return count;
}

void MovingBoxes::finish(std::span<const ItemId> items, std::span<const Obb> boxes, Executor& executor) {
    CROFTON_ASSERT(items.size() == boxes.size(), "finish needs as many boxes as items");
    if (staged_.empty()) begin_staging();
    BoxSet& next = sets_[1 - now_];
    const std::size_t laid_out = next.chunks_.size();
    staged_.resize((boxes.size() + 63) / 64, 0);
    if (!shapes_.empty()) shapes_.resize((boxes.size() + 15) / 16, 0);
    next.resize(boxes.size());
    executor.parallel_for(next.chunks_.size(), 1, [&](std::size_t begin, std::size_t end, unsigned) {
        for (std::size_t c = begin; c < end; ++c)
            if (c < laid_out)
                finish_chunk(c, boxes);
            else
                assign_chunk(c, boxes);
    });
    staged_.clear();
    now_ = 1 - now_;
    items_ = items;
    boxes_ = boxes;
}

void MovingBoxes::finish_chunk(std::size_t c, std::span<const Obb> boxes) {
    BoxSet& next = sets_[1 - now_];
    const std::size_t begin = c * kChunk, end = std::min(begin + kChunk, boxes.size());
    std::uint32_t missing[kChunk];
    std::size_t count = 0;
    for (std::size_t w = begin / 64; w * 64 < end; ++w) {
        std::uint64_t word = ~staged_[w];
        if (end - w * 64 < 64) word &= (std::uint64_t{1} << (end - w * 64)) - 1;
        for (; word; word &= word - 1)
            missing[count++] = static_cast<std::uint32_t>(64 * w) + static_cast<std::uint32_t>(std::countr_zero(word));
    }
    for (std::size_t block = begin / 16; block < std::min((end + 15) / 16, shapes_.size()); ++block) {
        const bool is_staged = (staged_[block / 4] >> (block % 4 * 16) & 0xffff) == 0xffff;
        shapes_[block] = is_staged && (shapes_[block] & kShapesStay) != 0 ? kShapesWritten : 0;
    }
    ListChunk& chunk = next.chunks_[c];
    if (4 * count > end - begin) {
        (void)next.fill_chunk(c, boxes);
    } else {
        std::uint32_t rejected[kWriteBatch];
        for (std::size_t done = 0; done < count; done += kWriteBatch) {
            const std::size_t batch = std::min(kWriteBatch, count - done);
            const std::size_t rejected_count = write_boxes(boxes.data(), missing + done, batch, next.chunks_.data(),
                                                           next.rows_.data(), next.records_.data(), rejected);
            for (std::size_t i = 0; i < rejected_count; ++i) next.write(rejected[i], boxes[rejected[i]]);
        }
        chunk.out_of_frame = 0;
        for (std::size_t i = begin; i < end && chunk.largest_radius == kUnboundedRadius; ++i)
            chunk.out_of_frame += next.rows_[i / 16].zr[i % 16] >> 16 == kUnboundedRadius;
    }
    if (BoxSet::wants_new_frame(chunk)) assign_chunk(c, boxes);
}

// In a new frame, so that nothing of the other set's can be kept the next time.
void MovingBoxes::assign_chunk(std::size_t c, std::span<const Obb> boxes) {
    sets_[1 - now_].assign_chunk(c, boxes);
    const std::size_t begin = std::min(c * kChunk / 16, shapes_.size()), end = (c + 1) * kChunk / 16;
    std::fill(shapes_.begin() + static_cast<std::ptrdiff_t>(begin),
              shapes_.begin() + static_cast<std::ptrdiff_t>(std::min(end, shapes_.size())), std::uint8_t{0});
}

}  // namespace crofton::cull
