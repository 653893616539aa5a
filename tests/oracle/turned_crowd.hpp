// SPDX-License-Identifier: MIT
// Bundles of long boxes, each turned its own way: where a tree's inner bounds do better along other axes.
#pragma once
#include <oracle/random_boxes.hpp>

namespace crofton::oracle {

inline Crowd turned_crowd(std::size_t count, double offset, std::uint64_t seed, double spread = 40.0) {
    NearMisses random(seed);
    Crowd crowd;
    Obb group;
    for (std::size_t i = 0; i < count; ++i) {
        if (i % 200 == 0) group = random_box(random, offset * glm::dvec3(1.0, -0.7, 0.3), spread);
        Obb box = group;
        const double at[3] = {random.number(-0.05, 0.05), random.number(-0.03, 0.03), random.number(-0.03, 0.03)};
        for (int k = 0; k < 3; ++k) box.center += spread * at[k] * glm::dvec3(group.axes[k]);
        box.half_extents = float(spread) * glm::vec3(0.2f, 0.002f, 0.004f);
        crowd.boxes.push_back(box);
        crowd.layers.push_back(1u << random.index(4) | 1u << random.index(4));
    }
    return crowd;
}

}  // namespace crofton::oracle
