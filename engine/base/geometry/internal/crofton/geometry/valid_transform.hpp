// SPDX-License-Identifier: MIT
// A fast check of a transform, without an error message.
#pragma once
#include <crofton/geometry/transform.hpp>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

namespace crofton {

inline constexpr double kLargestTransformEntry = 1e15;  // of a column's length, and of a translation

// Whether validate() passes. One comparison each refuses NaN, infinity and what is too large.
[[nodiscard]] inline bool is_valid(const Transform& transform) {
    const auto is_short = [](const glm::dvec3& v) {
        return glm::dot(v, v) <= kLargestTransformEntry * kLargestTransformEntry;
    };
    return is_short(transform.linear[0]) && is_short(transform.linear[1]) && is_short(transform.linear[2]) &&
           glm::all(glm::lessThanEqual(glm::abs(transform.translation), glm::dvec3(kLargestTransformEntry)));
}

}  // namespace crofton
