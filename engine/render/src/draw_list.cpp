// SPDX-License-Identifier: MIT
#include "draw_list.hpp"

namespace crofton::render {
namespace {

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

}  // namespace crofton::render
