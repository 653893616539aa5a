// SPDX-License-Identifier: MIT
// The order of pairs in lists of contacts.
#pragma once
#include <crofton/world/answers.hpp>
#include <cstddef>

namespace crofton::world {

inline constexpr std::size_t kPairsATask = 16;

[[nodiscard]] inline bool is_before(const ObjectPair& a, const ObjectPair& b) {
    if (a.first.object.index != b.first.object.index) return a.first.object.index < b.first.object.index;
    return a.second.object.index < b.second.object.index;
}

[[nodiscard]] inline bool are_same(const ObjectPair& a, const ObjectPair& b) {
    return a.first.object == b.first.object && a.second.object == b.second.object;
}

}  // namespace crofton::world
