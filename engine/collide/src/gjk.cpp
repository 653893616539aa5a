// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <crofton/collide/narrow_phase.hpp>
#include <glm/geometric.hpp>

#include <crofton/geometry/closest_points.hpp>

namespace crofton::collide {
namespace {

struct Vertex {
    glm::dvec3 on_a, on_b, difference;  // on_a − on_b
};

const glm::dvec3& farthest(const ConvexShape& body, const glm::dvec3& direction) {
    int best = 0;
    double most = glm::dot(body.points[0], direction);
    for (int i = 1; i < body.point_count; ++i) {
        const double along = glm::dot(body.points[i], direction);
        if (along > most) most = along, best = i;
    }
    return body.points[best];
}

Vertex support(const ConvexShape& a, const ConvexShape& b, const glm::dvec3& direction) {
    const glm::dvec3 &p = farthest(a, direction), &q = farthest(b, -direction);
    return {p, q, p - q};
}

// Points of the difference body with the weights of the point of their hull that is nearest to the origin.
struct Simplex {
    Vertex vertex[4];
    double weight[4] = {1.0, 0.0, 0.0, 0.0};
    int count = 0;
};

struct Nearest {
    double squared = std::numeric_limits<double>::infinity();
    int index[4] = {};
    double weight[4] = {};
    int count = 0;
};

void offer(const Simplex& s, const int* index, const double* weight, int count, Nearest& best) {
    glm::dvec3 point(0.0);
    for (int i = 0; i < count; ++i) point += weight[i] * s.vertex[index[i]].difference;
    const double squared = glm::dot(point, point);
    if (!(squared < best.squared)) return;
    best.squared = squared;
    best.count = count;
    std::copy(index, index + count, best.index);
    std::copy(weight, weight + count, best.weight);
}

// Every face of the simplex by itself, where the foot of the origin's perpendicular falls inside it: at most 15 of
// them, with no case distinctions that rounding could lead astray.
Nearest nearest_of(const Simplex& s) {
    Nearest best;
    const auto d = [&](int i) -> const glm::dvec3& { return s.vertex[i].difference; };
    for (int i = 0; i < s.count; ++i) {
        const double one = 1.0;
        offer(s, &i, &one, 1, best);
        for (int j = i + 1; j < s.count; ++j) {
            const glm::dvec3 u = d(j) - d(i);
            const double t = -glm::dot(d(i), u) / glm::dot(u, u);
            const int pair[2] = {i, j};
            const double weights[2] = {1.0 - t, t};
            if (t > 0.0 && t < 1.0) offer(s, pair, weights, 2, best);
            for (int k = j + 1; k < s.count; ++k) {
                const glm::dvec3 n = glm::cross(u, d(k) - d(i));
                const double whole = glm::dot(n, n);
                const double wi = glm::dot(glm::cross(d(j), d(k)), n) / whole;
                const double wj = glm::dot(glm::cross(d(k), d(i)), n) / whole, wk = 1.0 - wi - wj;
                const int face[3] = {i, j, k};
                const double weights3[3] = {wi, wj, wk};
                if (wi > 0.0 && wj > 0.0 && wk > 0.0) offer(s, face, weights3, 3, best);
            }
        }
    }
    if (s.count == 4) {
        const double whole = glm::dot(glm::cross(d(1) - d(0), d(2) - d(0)), d(3) - d(0));
        const double w[4] = {
            glm::dot(glm::cross(d(1), d(2)), d(3)) / whole, -glm::dot(glm::cross(d(0), d(2)), d(3)) / whole,
            glm::dot(glm::cross(d(0), d(1)), d(3)) / whole, -glm::dot(glm::cross(d(0), d(1)), d(2)) / whole};
        const int all[4] = {0, 1, 2, 3};
        if (w[0] > 0.0 && w[1] > 0.0 && w[2] > 0.0 && w[3] > 0.0) {
            offer(s, all, w, 4, best);
            best.squared = 0.0;
        }
    }
    return best;
}

void reduce(Simplex& s, const Nearest& best) {
    Simplex kept;
    for (int i = 0; i < best.count; ++i) {
        kept.vertex[i] = s.vertex[best.index[i]];
        kept.weight[i] = best.weight[i];
    }
    kept.count = best.count;
    s = kept;
}

}  // namespace

Distance distance(const ConvexShape& a, const ConvexShape& b) {
    Simplex simplex;
    simplex.vertex[simplex.count++] = support(a, b, b.points[0] - a.points[0]);
    double scale = 0.0;
    for (int i = 0; i < a.point_count; ++i)
        scale = std::max(scale, glm::dot(a.points[i] - b.points[0], a.points[i] - b.points[0]));
    Nearest best = nearest_of(simplex);
    // Each round lowers the distance; 64 are far more than the at most 64 vertices of the difference ever took.
    for (int round = 0; round < 64 && best.count < 4 && best.squared > 1e-28 * scale; ++round) {
        glm::dvec3 nearest(0.0);
        for (int i = 0; i < simplex.count; ++i) nearest += simplex.weight[i] * simplex.vertex[i].difference;
        const Vertex next = support(a, b, -nearest);
        // No vertex lies nearer than the plane through `nearest`: optimal up to rounding.
        if (best.squared - glm::dot(nearest, next.difference) <= 1e-13 * best.squared) break;
        bool known = false;
        for (int i = 0; i < simplex.count; ++i) known = known || simplex.vertex[i].difference == next.difference;
        if (known) break;
        Simplex wider = simplex;
        wider.vertex[wider.count++] = next;
        const Nearest improved = nearest_of(wider);
        if (!(improved.squared < best.squared)) break;
        best = improved;
        reduce(wider, best);
        simplex = wider;
    }
    Distance result;
    if (best.count == 4) best.squared = 0.0;
    for (int i = 0; i < simplex.count; ++i) {
        result.on_a += simplex.weight[i] * simplex.vertex[i].on_a;
        result.on_b += simplex.weight[i] * simplex.vertex[i].on_b;
    }
    const double core = best.squared > 1e-28 * scale ? std::sqrt(best.squared) : 0.0;
    result.distance = std::max(0.0, core - a.radius - b.radius);
    if (core > 0.0) {
        const glm::dvec3 direction = (result.on_b - result.on_a) / core;
        // Where the skins overlap, both points are the middle of the overlap.
        const double from_a = result.distance > 0.0 ? a.radius : std::min(core, 0.5 * (core + a.radius - b.radius));
        const double from_b = result.distance > 0.0 ? b.radius : core - from_a;
        result.on_a += from_a * direction;
        result.on_b -= from_b * direction;
    }
    return result;
}

}  // namespace crofton::collide
