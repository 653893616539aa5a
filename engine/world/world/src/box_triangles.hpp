// SPDX-License-Identifier: MIT
// A box's surface as triangles.
#pragma once
#include <cstdint>

namespace crofton::world {

// Two triangles a face, counter-clockwise from outside; corner numbers as in corners(box).
inline constexpr std::uint32_t kBoxTriangles[36] = {0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                                                    2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6};

}  // namespace crofton::world
