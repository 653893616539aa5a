// SPDX-License-Identifier: MIT
#include "box_penetration.hpp"

#include <algorithm>
#include <cmath>
#include <crofton/collide/convex_query.hpp>
#include <glm/geometric.hpp>

#include "float_pair.hpp"
#include "pair_columns.hpp"

namespace crofton::collide {
namespace {

// Products of edges that are shorter are noise as directions.
constexpr double kLeastSquaredSine = 1e-12;

constexpr int next(int k) {
    return k == 2 ? 0 : k + 1;
}

}  // namespace

BoxPairInDouble::BoxPairInDouble(const Obb& first, const Obb& second) : offset(second.center - first.center) {
    size = std::abs(offset.x) + std::abs(offset.y) + std::abs(offset.z);
    for (int side = 0; side < 2; ++side) {
        const Obb& box = side == 0 ? first : second;
        for (int k = 0; k < 3; ++k) {
            axes[side][k] = glm::dvec3(box.axes[k]);
            half[side][k] = static_cast<double>(box.half_extents[k]);
            size += half[side][k];
        }
        for (int k = 0; k < 3; ++k) normals[side][k] = glm::cross(axes[side][next(k)], axes[side][next(next(k))]);
    }
}

BoxOverlap overlap_of(const Obb& a, const Obb& b, const BoxPairInDouble& pair) {
    AxisMeasures measures;
    measure_axes(columns_of(FloatBox(a), FloatBox(b), pair.offset), measures);
    BoxOverlap overlap;
    overlap.error_bound = 0x1p-49 * measures.size + 1e-300;
    double widest = -1e300;
    for (int face = 0; face < 6; ++face) {
        const int side = face / 3, k = face % 3;
        const double gap = measures.gap[side][k];
        widest = std::max(widest, gap);
        overlap.faces[face] = {pair.normals[side][k], -gap, measures.squared_length[side][k], face};
    }
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            const int group = 2 + (j - i + 3) % 3;
            const AxisOverlap edge{{}, -measures.gap[group][i], measures.squared_length[group][i], 6 + 3 * i + j};
            widest = std::max(widest, measures.gap[group][i]);
            if (edge.squared_length > kLeastSquaredSine &&
                (overlap.edge.number == kNotSeparated || edge.is_less_than(overlap.edge)))
                overlap.edge = edge;
        }
    if (const int edge = overlap.edge.number - 6; edge >= 0)
        overlap.edge.axis = glm::cross(pair.axes[0][edge / 3], pair.axes[1][edge % 3]);
    overlap.least = -widest;
    return overlap;
}

const AxisOverlap& least_of(const BoxOverlap& overlap) {
    const AxisOverlap* least = &overlap.faces[0];
    for (const AxisOverlap& face : overlap.faces)
        if (face.is_less_than(*least)) least = &face;
    if (overlap.edge.number != kNotSeparated && overlap.edge.is_less_than(*least)) least = &overlap.edge;
    return *least;
}

Penetration penetration(const Obb& a, const Obb& b) {
    const BoxPairInDouble pair(a, b);
    const BoxOverlap overlap = overlap_of(a, b, pair);
    const AxisOverlap& least = least_of(overlap);
    const glm::dvec3 axis = least.axis / std::sqrt(least.squared_length);
    return {least.depth(), glm::dot(axis, pair.offset) < 0.0 ? -axis : axis};
}

}  // namespace crofton::collide
