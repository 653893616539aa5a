// SPDX-License-Identifier: MIT
// A crowd of boxes of many sizes, turned every way.
#pragma once
#include <cmath>
#include <crofton/geometry/box.hpp>
#include <oracle/near_misses.hpp>
#include <vector>

namespace crofton::oracle {

struct Crowd {
    std::vector<Obb> boxes;
    std::vector<std::uint32_t> layers;
};

inline Obb random_box(NearMisses& random, const glm::dvec3& middle, double spread) {
    Obb box;
    box.center = middle + spread * random.vector(-1, 1);
    const glm::dvec3 axis = random.direction();
    const double angle = random.number(0.0, 6.2);
    box.axes = glm::mat3(glm::mat3_cast(glm::dquat(std::cos(angle / 2), std::sin(angle / 2) * axis)));
    for (int k = 0; k < 3; ++k)
        box.half_extents[k] = float(std::exp(random.number(-3.0, random.index(50) ? 0.0 : 3.0)));
    return box;
}

inline Crowd random_crowd(std::size_t count, double offset, std::uint64_t seed) {
    NearMisses random(seed);
    Crowd crowd;
    for (std::size_t i = 0; i < count; ++i) {
        crowd.boxes.push_back(random_box(random, offset * glm::dvec3(1.0, -0.7, 0.3), 40.0));
        crowd.layers.push_back(1u << random.index(4) | 1u << random.index(4));
    }
    return crowd;
}

}  // namespace crofton::oracle
