// SPDX-License-Identifier: MIT
// Whether indices are consecutive, so that the elements they name are contiguous.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

namespace crofton {

// indices[i] is indices[0] + i for all i.
[[nodiscard]] inline bool are_consecutive(std::span<const std::uint32_t> indices) {
    std::uint32_t differing = 0;  // without a branch a number: vectors do it
    for (std::size_t i = 0; i < indices.size(); ++i)
        differing |= indices[i] ^ (indices[0] + static_cast<std::uint32_t>(i));
    return differing == 0;
}

}  // namespace crofton
