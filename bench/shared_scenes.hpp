// SPDX-License-Identifier: MIT
// The boxes of real scenes, side by side, as many times as are wanted.
#pragma once
#include <crofton/geometry/box.hpp>
#include <cstddef>
#include <vector>

namespace crofton::bench {

// `count` boxes of the shared data's scenes: a forest and a level of a game, each scaled to one square, in turns on a
// grid over the cube of side ∛count, at about half its height. Empty, with a message, if no scene can be read.
[[nodiscard]] std::vector<Obb> shared_boxes(std::size_t count);

}  // namespace crofton::bench
