// SPDX-License-Identifier: MIT
// Whether two boxes are the same, bit for bit: distinguishes a box that has moved from one that was set to the same
// value.
#pragma once
#include <crofton/geometry/box.hpp>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace crofton {

[[nodiscard]] inline bool have_same_bits(const Obb& a, const Obb& b) {
    static_assert(sizeof(Obb) == 72);
    // Word by word: copies of whole boxes would go through the stack, and their loads wait for the stores.
    const auto differing = [&](std::size_t word) {
        std::uint64_t left, right;
        std::memcpy(&left, reinterpret_cast<const std::byte*>(&a) + 8 * word, 8);
        std::memcpy(&right, reinterpret_cast<const std::byte*>(&b) + 8 * word, 8);
        return left ^ right;
    };
    if ((differing(0) | differing(1) | differing(2)) != 0) return false;  // the centre: most that move
    return (differing(3) | differing(4) | differing(5) | differing(6) | differing(7) | differing(8)) == 0;
}

}  // namespace crofton
