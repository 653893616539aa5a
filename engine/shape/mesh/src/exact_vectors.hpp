// SPDX-License-Identifier: MIT
// Differences of points and their cross products, exactly.
#pragma once
#include <array>
#include <crofton/geometry/expansion.hpp>
#include <cstddef>
#include <glm/vec3.hpp>

namespace crofton::mesh {

using Differences = std::array<Expansion<2>, 3>;

[[nodiscard]] inline Differences differences(const glm::dvec3& a, const glm::dvec3& b) {
    return {exact_difference(a.x, b.x), exact_difference(a.y, b.y), exact_difference(a.z, b.z)};
}

[[nodiscard]] inline std::array<Expansion<16>, 3> cross(const Differences& u, const Differences& v) {
    const auto minor = [&](std::size_t i, std::size_t j) { return u[i] * v[j] - u[j] * v[i]; };
    return {minor(1, 2), minor(2, 0), minor(0, 1)};
}

}  // namespace crofton::mesh
