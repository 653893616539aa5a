// Ranges checked, merged and laid out for the GPU.
#pragma once
#include <crofton/core/memory.hpp>
#include <crofton/render/rasterizer.hpp>

namespace crofton::render {

// One draw after merging.
struct MergedDraw {
    std::uint32_t first_index, index_count, transform;
};

// Appends to `draws`, joining a range to the one before where it continues it with the same transform.
// Errors: item = the first range that is not whole triangles, or refers beyond indices or transforms.
[[nodiscard]] Result<void> merge_ranges(std::span<const DrawRange> ranges, std::size_t index_count,
                                        std::size_t transform_count, Vector<MergedDraw>& draws);

}  // namespace crofton::render
