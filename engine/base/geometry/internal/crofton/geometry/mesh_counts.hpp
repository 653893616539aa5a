// SPDX-License-Identifier: MIT
// The size of a mesh, checked before anything of it is read or copied.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/core/version.hpp>
#include <cstdint>

namespace crofton::detail {

// 32 bits number the vertices and the triangles.
[[nodiscard]] inline Result<void> check_mesh_counts(std::uint64_t vertices, std::uint64_t indices) {
    constexpr std::uint64_t kMost = ~std::uint32_t{0};
    if (vertices > kMost)
        return fail(ErrorCode::out_of_range, kNoItem, {"mesh: ", vertices, " vertices are more than 2^32 - 1"});
    if (indices > 3 * kMost)
        return fail(ErrorCode::out_of_range, kNoItem, {"mesh: ", indices, " indices are more than 3 * (2^32 - 1)"});
    return {};
}

}  // namespace crofton::detail
