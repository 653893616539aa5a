// SPDX-License-Identifier: MIT
#include "manifold_points.hpp"

#include <algorithm>
#include <glm/geometric.hpp>

namespace crofton::collide {

void reduce(Manifold& manifold) {
    if (manifold.count <= 4) return;
    const ContactPoint(&points)[8] = manifold.points;
    const auto first_largest = [&](auto value) {
        int best = 0;
        for (int i = 1; i < manifold.count; ++i)
            if (value(i) > value(best)) best = i;
        return best;
    };
    int kept[4];
    kept[0] = first_largest([&](int i) { return points[i].depth; });
    const glm::dvec3 from = points[kept[0]].position;
    kept[1] = first_largest([&](int i) {
        const glm::dvec3 way = points[i].position - from;
        return glm::dot(way, way);
    });
    const glm::dvec3 across = glm::cross(manifold.normal, points[kept[1]].position - from);
    const auto area = [&](int i) { return glm::dot(across, points[i].position - from); };
    kept[2] = first_largest(area);
    kept[3] = first_largest([&](int i) { return -area(i); });
    std::sort(kept, kept + 4);
    const int count = static_cast<int>(std::unique(kept, kept + 4) - kept);
    for (int i = 0; i < count; ++i) manifold.points[i] = manifold.points[kept[i]];
    manifold.count = count;
}

void set_depth(Manifold& manifold) {
    manifold.depth = 0.0;
    for (int i = 0; i < manifold.count; ++i) manifold.depth = std::max(manifold.depth, manifold.points[i].depth);
}

}  // namespace crofton::collide
