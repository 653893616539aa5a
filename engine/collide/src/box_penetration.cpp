#include "box_penetration.hpp"

#include <algorithm>
#include <cmath>
#include <crofton/collide/convex_query.hpp>
#include <glm/geometric.hpp>

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

// With N the normals of a, M those of b: N_l · b_j and M_l · a_i serve the faces and, as (a_i × b_j) · a_{i+1} =
// −N_{i+2} · b_j and so on, the edges.
BoxOverlap overlap_of(const BoxPairInDouble& pair) {
    BoxOverlap overlap;
    double product[2][3][3];  // [side][l][j]: |normal l of this side · axis j of the other|
    overlap.least = 1e300;
    for (int side = 0; side < 2; ++side)
        for (int l = 0; l < 3; ++l) {
            const glm::dvec3& n = pair.normals[side][l];
            double reach = pair.half[side][l] * std::abs(glm::dot(n, pair.axes[side][l]));
            for (int j = 0; j < 3; ++j) {
                product[side][l][j] = std::abs(glm::dot(n, pair.axes[1 - side][j]));
                reach += pair.half[1 - side][j] * product[side][l][j];
            }
            AxisOverlap& face = overlap.faces[3 * side + l];
            face = {n, reach - std::abs(glm::dot(n, pair.offset)), glm::dot(n, n), 3 * side + l};
            overlap.least = std::min(overlap.least, face.scaled_depth);
        }
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            const int i1 = next(i), i2 = next(i1), j1 = next(j), j2 = next(j1);
            const glm::dvec3 n = glm::cross(pair.axes[0][i], pair.axes[1][j]);
            const double reach = pair.half[0][i1] * product[0][i2][j] + pair.half[0][i2] * product[0][i1][j] +
                                 (pair.half[1][j1] * product[1][j2][i] + pair.half[1][j2] * product[1][j1][i]);
            const AxisOverlap edge{n, reach - std::abs(glm::dot(n, pair.offset)), glm::dot(n, n), 6 + 3 * i + j};
            overlap.least = std::min(overlap.least, edge.scaled_depth);
            if (edge.squared_length > kLeastSquaredSine &&
                (overlap.edge.number == kNotSeparated || edge.is_less_than(overlap.edge)))
                overlap.edge = edge;
        }
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
    const BoxOverlap overlap = overlap_of(pair);
    const AxisOverlap& least = least_of(overlap);
    const glm::dvec3 axis = least.axis / std::sqrt(least.squared_length);
    return {least.depth(), glm::dot(axis, pair.offset) < 0.0 ? -axis : axis};
}

}  // namespace crofton::collide
