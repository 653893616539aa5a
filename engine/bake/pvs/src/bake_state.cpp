// SPDX-License-Identifier: MIT
// Parts of a bake: ranges of blocks, states as bytes, their sum.
#include <algorithm>
#include <crofton/bake/container.hpp>
#include <crofton/core/recovery.hpp>

#include "bake_data.hpp"

namespace crofton::pvs {

void BlockRanges::add(std::span<const BlockRange> ranges) {
    Vector<BlockRange> all;
    all.reserve(ranges_.size() + ranges.size());
    const auto append = [&](const BlockRange& range) {
        if (all.empty() || range.begin > all.back().end)
            all.push_back(range);
        else
            all.back().end = (std::max)(all.back().end, range.end);
    };
    auto own = ranges_.begin();
    for (const BlockRange& range : ranges) {
        for (; own != ranges_.end() && own->begin < range.begin; ++own) append(*own);
        append(range);
    }
    std::for_each(own, ranges_.end(), append);
    ranges_ = std::move(all);
}

std::span<const BlockRange> BlockRanges::beyond(std::uint64_t block) const {
    const auto first = std::upper_bound(ranges_.begin(), ranges_.end(), block,
                                        [](std::uint64_t at, const BlockRange& each) { return at < each.end; });
    return std::span(ranges_).subspan(static_cast<std::size_t>(first - ranges_.begin()));
}

std::uint64_t BlockRanges::count() const {
    return count_within({0, ~std::uint64_t{0}});
}

std::uint64_t BlockRanges::count_within(BlockRange range) const {
    std::uint64_t count = 0;
    for (const BlockRange& each : beyond(range.begin)) {
        if (each.begin >= range.end) break;
        count += (std::min)(each.end, range.end) - (std::max)(each.begin, range.begin);
    }
    return count;
}

BlockRange BlockRanges::first_gap(BlockRange range, std::uint64_t most) const {
    BlockRange gap = range;
    for (const BlockRange& each : beyond(range.begin)) {
        if (each.begin > gap.begin) {
            gap.end = (std::min)(gap.end, each.begin);
            break;
        }
        gap.begin = each.end;
    }
    if (gap.begin >= gap.end) return {};
    gap.end = (std::min)(gap.end, gap.begin + most);
    return gap;
}

Vector<std::byte> to_bytes(const Found& found) {
    bake::Writer writer;
    writer.add("pvs_bake", std::span(&found.name, 1));
    writer.add("pvs_done", found.done.all());
    writer.add("pvs_flag", std::span(found.flags));
    writer.add("pvs_seen", std::span(found.seen));
    return writer.finish();
}

Result<Found> found_from(std::span<const std::byte> bytes) {
    const auto damaged = [](const char* what) {
        return fail(ErrorCode::parse, kNoItem, {"state of a pvs bake: ", what});
    };
    const auto reader = bake::Reader::open(bytes);
    if (!reader) return reader.error();
    const auto name = reader->section<BakeName>("pvs_bake");
    const auto done = reader->section<BlockRange>("pvs_done");
    const auto flags = reader->section<std::uint16_t>("pvs_flag");
    const auto seen = reader->section<std::uint64_t>("pvs_seen");
    if (!name) return name.error();
    if (!done) return done.error();
    if (!flags) return flags.error();
    if (!seen) return seen.error();
    if (name->size() != 1) return damaged("it has not one header");
    Found found;
    found.name = name->front();
    if (found.name.cells > std::uint64_t{1} << 24) return damaged("it has more than 2^24 cells");
    if (flags->size() != found.name.cells || seen->size() != found.words() * found.name.cells)
        return damaged("its sections are not as long as its header says");
    std::uint64_t end = 0;
    for (const BlockRange& range : *done) {
        if (range.begin >= range.end || range.end > found.name.blocks || (end != 0 && range.begin <= end))
            return damaged("its ranges of lines do not ascend");
        end = range.end;
    }
    found.done.add(*done);
    found.flags.assign(flags->begin(), flags->end());
    found.seen.assign(seen->begin(), seen->end());
    return found;
}

void add(const Found& part, Found& to) {
    to.done.add(part.done.all());  // all that may fail comes first
    for (std::size_t i = 0; i < to.seen.size(); ++i) to.seen[i] |= part.seen[i];
    for (std::size_t i = 0; i < to.flags.size(); ++i) to.flags[i] |= part.flags[i];
}

Result<Vector<std::byte>> merge_states(std::span<const std::span<const std::byte>> states) {
    return crofton::detail::recover([&]() -> Result<Vector<std::byte>> {
        if (states.empty()) return fail(ErrorCode::empty, kNoItem, "merging parts of a pvs bake: there are none");
        Found sum;
        for (std::size_t i = 0; i < states.size(); ++i) {
            auto part = found_from(states[i]);
            if (!part) return fail(part.error().code, i, part.error().message);
            if (i == 0) {
                sum = std::move(*part);
            } else if (part->name == sum.name) {
                add(*part, sum);
            } else {
                return fail(ErrorCode::invalid_argument, i,
                            "a part of another bake than the first: scene, cells, epsilon, confidence, seed and sides "
                            "must be the same");
            }
        }
        return to_bytes(sum);
    });
}

Result<Vector<std::uint32_t>> missing_shards(std::span<const std::byte> state, std::uint32_t count) {
    return crofton::detail::recover([&]() -> Result<Vector<std::uint32_t>> {
        if (count == 0) return fail(ErrorCode::invalid_argument, kNoItem, "a bake in 0 parts");
        const auto found = found_from(state);
        if (!found) return found.error();
        Vector<std::uint32_t> missing;
        for (std::uint32_t i = 0; i < count; ++i) {
            const BlockRange all = blocks_of({i, count}, found->name.blocks);
            if (found->done.count_within(all) < all.end - all.begin) missing.push_back(i);
        }
        return missing;
    });
}

}  // namespace crofton::pvs
