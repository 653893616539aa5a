// Two of many, by index.
#pragma once
#include <compare>
#include <cstdint>

namespace crofton::collide {

// Indices into the caller's boxes, first < second; ordered by first, then second.
struct Pair {
    std::uint32_t first = 0, second = 0;
    auto operator<=>(const Pair&) const = default;
};

}  // namespace crofton::collide
