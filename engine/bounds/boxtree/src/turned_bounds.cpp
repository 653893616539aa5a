// SPDX-License-Identifier: MIT
#include "turned_bounds.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "bounds.hpp"
#include "leaf_extents.hpp"

namespace crofton::boxtree {
namespace {

// The least box along axes around others, all relative to one point.
struct Turned {
    const Axes& axes;
    double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};

    // A centre and half edges.
    void include(const double* center, const double (&edges)[3][3]) {
        for (unsigned k = 0; k < 3; ++k) {
            const double middle = along(axes, k, center);
            double projected_radius = 0.0;
            for (const auto& edge : edges) projected_radius += std::fabs(along(axes, k, edge));
            low[k] = std::min(low[k], middle - projected_radius);
            high[k] = std::max(high[k], middle + projected_radius);
        }
    }
    void include(const double (&middle)[3], const double (&half)[3], const Axes& its_axes) {
        double center[3] = {}, edges[3][3];
        for (unsigned k = 0; k < 3; ++k)
            for (unsigned j = 0; j < 3; ++j) {
                center[j] += middle[k] * its_axes.rows[k][j];
                edges[k][j] = half[k] * its_axes.rows[k][j];
            }
        include(center, edges);
    }
    [[nodiscard]] Aabb at(const double* origin) const {
        return low[0] > high[0] ? Aabb{} : around(axes, origin, low, high, kTurnRounding);
    }
};

}  // namespace

Axes axes_of(const glm::mat3& columns) {
    const glm::dvec3 x = glm::normalize(glm::dvec3(columns[0]));
    glm::dvec3 y = glm::dvec3(columns[1]);
    for (int twice = 0; twice < 2; ++twice) y = glm::normalize(y - glm::dot(y, x) * x);
    const glm::dvec3 rows[3] = {x, y, glm::normalize(glm::cross(x, y))};
    Axes axes;
    for (unsigned k = 0; k < 3; ++k)
        for (unsigned j = 0; j < 3; ++j) axes.rows[k][j] = rows[k][static_cast<int>(j)];
    axes.rounding = are_the_worlds(axes) ? 0.0 : kTurnRounding;
    return axes;
}

bool are_the_worlds(const Axes& axes) {
    for (unsigned k = 0; k < 3; ++k)
        for (unsigned j = 0; j < 3; ++j)
            if (axes.rows[k][j] != Axes{}.rows[k][j]) return false;
    return true;
}

bool are_valid(const Axes& axes) {
    if (axes.rounding != (are_the_worlds(axes) ? 0.0 : kTurnRounding)) return false;
    for (unsigned i = 0; i < 3; ++i)
        for (unsigned j = 0; j <= i; ++j)
            if (!(std::fabs(along(axes, i, axes.rows[j]) - (i == j ? 1.0 : 0.0)) <= 0x1p-49)) return false;
    return true;
}

bool are_alike(const Axes& a, const Axes& b) {
    for (unsigned i = 0; i < 3; ++i) {
        double nearest = 0.0;
        for (unsigned j = 0; j < 3; ++j) nearest = std::max(nearest, std::fabs(along(a, i, b.rows[j])));
        if (nearest < 1.0 - 1.5e-6) return false;
    }
    return true;
}

Aabb bounds_along(const Axes& axes, const Obb& box) {
    if (axes.rounding == 0.0) return aabb_of(box);
    const double nowhere[3] = {}, center[3] = {box.center.x, box.center.y, box.center.z};
    double edges[3][3];
    for (int k = 0; k < 3; ++k)
        for (int j = 0; j < 3; ++j) edges[k][j] = double{box.half_extents[k]} * double{box.axes[k][j]};
    Turned turned{axes};
    turned.include(nowhere, edges);
    return turned.at(center);
}

// A centre is within half a unit of its lane's integers along each of the world's axes, and so is each of three half
// edges. So they are within √3/2 of one along any other. Axes in float, products and sums round by 6 · 2^-24 of the
// sums of sizes of centre and edges. Those are at most √3 times as large as the ends together.
Aabb bounds_along(const Axes& axes, const Leaf& leaf) {
    if (axes.rounding == 0.0) return bounds_of(leaf);
    if (leaf.count == 0) return {};
    LeafExtent extent;
    turned_leaf_extent(leaf, axes, extent);
    double size = 0.0;
    for (unsigned k = 0; k < 3; ++k) size += std::fabs(double{extent.low[k]}) + std::fabs(double{extent.high[k]});
    const double error_bound = 0.88 * (double{leaf.position_unit} + 3.0 * double{leaf.edge_unit}) + 0x1p-18 * size;
    double low[3], high[3];
    for (unsigned k = 0; k < 3; ++k) {
        low[k] = double{extent.low[k]} - error_bound;
        high[k] = double{extent.high[k]} + error_bound;
    }
    return around(axes, leaf.origin, low, high, kTurnRounding);
}

Aabb bounds_along(const Axes& axes, const Aabb& box, const Axes& its_axes) {
    if (box.is_empty()) return {};
    const glm::dvec3 middle = box.center(), half_size = 0.5 * (box.max - box.min);
    const double center[3] = {middle.x, middle.y, middle.z};
    const double half[3] = {half_size.x, half_size.y, half_size.z};
    double origin[3] = {};
    for (unsigned k = 0; k < 3; ++k)
        for (unsigned j = 0; j < 3; ++j) origin[j] += center[k] * its_axes.rows[k][j];
    Turned turned{axes};
    turned.include({0.0, 0.0, 0.0}, half, its_axes);
    return turned.at(origin);
}

}  // namespace crofton::boxtree
