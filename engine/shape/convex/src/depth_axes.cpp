// SPDX-License-Identifier: MIT
// Penetration depth by all separating axes: faces of either shape and products of two edges. Used where the bounds of
// EPA stay apart.
#include <algorithm>
#include <array>
#include <cmath>

#include "epa.hpp"
#include "exact_gjk.hpp"

namespace crofton::convex {
namespace {

// Triangles of a core's surface: of a hull its own, of a box two a side, of a triangle both sides.
Vector<std::array<int, 3>> triangles_of(const Shape& shape) {
    Vector<std::array<int, 3>> result;
    if (shape.kind() == Kind::hull) {
        const auto indices = shape.hull()->triangles();
        for (std::size_t i = 0; i + 2 < indices.size(); i += 3)
            result.push_back({indices[i], indices[i + 1], indices[i + 2]});
    } else if (shape.kind() == Kind::box) {
        result = {{0, 4, 2}, {1, 3, 5}, {0, 1, 4}, {2, 6, 3}, {0, 2, 1}, {4, 5, 6}};
    } else if (shape.vertex_count() == 3) {
        result = {{0, 1, 2}, {0, 2, 1}};
    }
    return result;
}

Vector<std::array<int, 2>> edges_of(const Shape& shape) {
    Vector<std::array<int, 2>> result;
    if (shape.kind() == Kind::box) return {{0, 1}, {0, 2}, {0, 4}};  // its edges have three directions
    if (shape.vertex_count() == 2) return {{0, 1}};
    for (const auto& t : triangles_of(shape))
        for (std::size_t k = 0; k < 3; ++k)
            if (t[k] < t[(k + 1) % 3]) result.push_back({t[k], t[(k + 1) % 3]});
    return result;
}

class Axes {
  public:
    explicit Axes(const Pair& pair) : pair_(pair) {}

    // The deepest axis is among those tried, each off by at most `turn` from the true direction.
    void offer(const glm::dvec3& axis, double turn) {
        const double length = glm::length(axis);
        if (!(length > 0.0)) return;
        const glm::dvec3 unit = axis / length;
        const double extent = pair_.extent(unit);
        if (extent + pair_.error < best.upper) best.upper = extent + pair_.error, best.normal = unit;
        lower = std::min(lower, extent - pair_.error - turn * pair_.size);
    }

    Depth best;
    double lower = HUGE_VAL;

  private:
    const Pair& pair_;
};

// With corners rounded by 4u of the reach, a product of edges e and f is off by 40u · reach · (|e| + |f|); below a
// ten-millionth of the size it is computed exactly.
glm::dvec3 product(const glm::dvec3& e, const glm::dvec3& f, double reach, double& turn) {
    const glm::dvec3 n = glm::cross(e, f);
    const double length = glm::length(n);
    turn = length > 0.0 ? 0x1p-47 * reach * (glm::length(e) + glm::length(f)) / length : HUGE_VAL;
    return n;
}

void offer_faces(const ShapeAtPose& placed, double side, Axes& axes) {
    const Shape& shape = placed.shape;
    const glm::dmat3& rotation = placed.pose.rotation;
    for (const auto& t : triangles_of(shape)) {
        // Edges are turned, not normals: a pose is rigid to 1e-6 alone.
        const glm::dvec3 a = shape.vertex(t[0]), e = rotation * (shape.vertex(t[1]) - a),
                         f = rotation * (shape.vertex(t[2]) - a);
        double turn = 0.0;
        glm::dvec3 n = product(e, f, shape.core_radius(), turn);
        if (turn > 1e-11) {
            n = exact_edge_normal(Pair(placed, placed), t[0], t[1], t[0], t[2]);
            turn = 0x1p-48;
        }
        axes.offer(side * n, turn);
    }
}

}  // namespace

// The difference body's faces lie across normals of either shape's faces and products of their edges, so that the least
// extent is at one of them.
Depth depth_by_axes(const Pair& pair, const Depth& known) {
    Axes axes(pair);
    axes.best = known;
    // One shape may stand at both poses.
    offer_faces({pair.a, pair.pose_a}, 1.0, axes);
    offer_faces({pair.b, pair.pose_b}, -1.0, axes);
    const auto first = edges_of(pair.a), second = edges_of(pair.b);
    for (const auto& e : first)
        for (const auto& f : second) {
            const glm::dvec3 u = pair.pose_a.rotation * (pair.a.vertex(e[1]) - pair.a.vertex(e[0]));
            const glm::dvec3 v = pair.pose_b.rotation * (pair.b.vertex(f[1]) - pair.b.vertex(f[0]));
            double turn = 0.0;
            glm::dvec3 n = product(u, v, pair.a.core_radius() + pair.b.core_radius(), turn);
            if (turn > 1e-11) {
                n = exact_edge_normal(pair, e[0], e[1], f[0], f[1]);
                turn = 0x1p-48;
            }
            axes.offer(n, turn);
            axes.offer(-n, turn);
        }
    if (axes.lower < HUGE_VAL) axes.best.lower = std::max(known.lower, axes.lower);
    return axes.best;
}

}  // namespace crofton::convex
