// SPDX-License-Identifier: MIT
// Ranges checked, merged and laid out for the GPU.
#pragma once
#include <array>
#include <crofton/core/memory.hpp>
#include <crofton/render/rasterizer.hpp>

namespace crofton::render {

// Says which faces are drawn, and where the others are dropped. The values are the shaders' `faces`.
enum class Faces : std::uint32_t { both, front_by_shader, front_by_culling };
inline constexpr std::array kAllFaces{Faces::both, Faces::front_by_shader, Faces::front_by_culling};

// One draw after merging.
struct MergedDraw {
    std::uint32_t first_index, index_count, transform;
    Faces faces;
    bool is_copy = false;  // of indices that join_short_draws() has copied
};

// Appends to `draws` in the order given, which decides between surfaces of equal depth, joining a range to the one
// before where it continues it with the same transform and faces. Errors: item = the first range that is not whole
// triangles, or refers beyond indices or transforms.
[[nodiscard]] Result<void> merge_ranges(std::span<const DrawRange> ranges, std::size_t index_count,
                                        std::size_t transform_count, Vector<MergedDraw>& draws);

// Replaces short draws in a row that share transform and faces by one draw of at most `most_indices`, whose indices are
// copied to `copies`. Triangles keep their order.
void join_short_draws(std::span<const std::uint32_t> indices, std::uint32_t most_indices, Vector<MergedDraw>& draws,
                      Vector<std::uint32_t>& copies);

}  // namespace crofton::render
