// SPDX-License-Identifier: MIT
// Finds the smallest of sixteen rotated rectangles around points: shared by the kernel and its callers.
#pragma once
#include <cstddef>

namespace crofton::mesh {

inline constexpr std::size_t kAngles = 16;

struct alignas(64) Angles {
    float cosine[kAngles], sine[kAngles];
};

// The angle at which the rectangle around the points (u[i], v[i]) has the least perimeter, the first of equals. No
// operation is fused: the same on every machine.
[[nodiscard]] std::size_t least_rectangle(const float* u, const float* v, std::size_t count, const Angles& angles);

}  // namespace crofton::mesh
