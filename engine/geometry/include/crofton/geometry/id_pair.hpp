// SPDX-License-Identifier: MIT
// Two of many items, by index.
#pragma once
#include <compare>
#include <crofton/core/requirements.hpp>
#include <cstdint>

namespace crofton {

// Indices into the caller's boxes, first < second; ordered by first, then second.
struct IdPair {
    std::uint32_t first = 0, second = 0;
    auto operator<=>(const IdPair&) const = default;
};

}  // namespace crofton
