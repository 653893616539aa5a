// Two boxes as the separating-axis tests want them: six edges with their half lengths, in double.
#pragma once
#include <crofton/geometry/obb.hpp>
#include <glm/geometric.hpp>

namespace crofton::collide {

struct BoxPair {
    BoxPair(const Obb& a, const Obb& b);

    glm::dvec3 center_a, center_b;
    glm::dvec3 offset;     // center_b − center_a, rounded
    glm::dvec3 magnitude;  // |offset| + Σ half |edge|: what the error bounds scale with
    glm::dvec3 edge[6];    // axes of a, then of b: exact
    double half[6];
};

}  // namespace crofton::collide
