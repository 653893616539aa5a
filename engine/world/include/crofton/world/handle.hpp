// SPDX-License-Identifier: MIT
// Names of things in a World: an index that is used again, and a generation that tells its users apart.
#pragma once
#include <compare>
#include <crofton/core/requirements.hpp>
#include <cstdint>

namespace crofton {

inline constexpr std::uint32_t kNoIndex = ~std::uint32_t{0};

// Indices are dense: below the largest number of things that lived at once, so that they may index the caller's own
// arrays. A handle whose thing has been removed is stale: calls that take it fail with ErrorCode::stale_handle. A
// generation comes back after 2^32 removals of one index.
template <class Tag>
struct Handle {
    std::uint32_t index = kNoIndex;
    std::uint32_t generation = 0;

    [[nodiscard]] bool is_null() const { return index == kNoIndex; }
    auto operator<=>(const Handle&) const = default;
};

using ObjectHandle = Handle<struct ObjectTag>;
using NodeHandle = Handle<struct NodeTag>;
using MeshHandle = Handle<struct MeshTag>;

}  // namespace crofton
