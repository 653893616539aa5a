// SPDX-License-Identifier: MIT
#include "draw_list.hpp"

namespace crofton::render {
namespace {

// Indices. Lavapipe takes 0.2 us of a processor for a draw, longer than it takes to copy so many indices.
constexpr std::uint32_t kShortDraw = 3 * 64;

Faces faces_of(const DrawRange& range) {
    if (!range.one_sided) return Faces::both;
    return range.unclipped ? Faces::front_by_culling : Faces::front_by_shader;
}

}  // namespace

Result<void> merge_ranges(std::span<const DrawRange> ranges, std::size_t index_count, std::size_t transform_count,
                          Vector<MergedDraw>& draws) {
    for (std::size_t i = 0; i < ranges.size(); ++i) {
        const DrawRange& range = ranges[i];
        const std::uint64_t end = std::uint64_t{range.first_index} + range.index_count;
        if (end > index_count) return fail(ErrorCode::out_of_range, i, "a draw range ends beyond the index buffer");
        if (range.index_count % 3 != 0)
            return fail(ErrorCode::invalid_argument, i, "a draw range is not whole triangles");
        if (range.transform >= transform_count)
            return fail(ErrorCode::out_of_range, i, "a draw range refers to a transform that is not there");
    }
    const std::size_t first_draw = draws.size();
    for (const DrawRange& range : ranges) {
        if (range.index_count == 0) continue;
        const Faces faces = faces_of(range);
        if (draws.size() > first_draw) {
            MergedDraw& last = draws.back();
            if (last.faces == faces && last.transform == range.transform &&
                last.first_index + last.index_count == range.first_index) {
                last.index_count += range.index_count;
                continue;
            }
        }
        draws.push_back({range.first_index, range.index_count, range.transform, faces});
    }
    return {};
}

void join_short_draws(std::span<const std::uint32_t> indices, std::uint32_t most_indices, Vector<MergedDraw>& draws,
                      Vector<std::uint32_t>& copies) {
    copies.clear();
    std::size_t kept = 0;
    bool joins = false;  // the last one that is kept may take more
    for (std::size_t i = 0; i < draws.size(); ++i) {
        const MergedDraw draw = draws[i];
        const bool is_short = draw.index_count <= kShortDraw;
        if (is_short) {
            const auto from = indices.subspan(draw.first_index, draw.index_count);
            copies.insert(copies.end(), from.begin(), from.end());
        }
        MergedDraw* const last = joins && is_short ? &draws[kept - 1] : nullptr;
        if (last != nullptr && last->transform == draw.transform && last->faces == draw.faces &&
            last->index_count + draw.index_count <= most_indices) {
            last->index_count += draw.index_count;
            continue;
        }
        draws[kept] = draw;
        if (is_short) draws[kept].first_index = static_cast<std::uint32_t>(copies.size() - draw.index_count);
        draws[kept++].is_copy = joins = is_short;
    }
    draws.resize(kept);
}

}  // namespace crofton::render
