// SPDX-License-Identifier: MIT
#include "part_manifold.hpp"

#include <algorithm>
#include <cmath>

#include "clip.hpp"
#include "core_query.hpp"

namespace crofton::convex {
namespace {

// Normals this close are one: 0.3 degrees.
constexpr double kSameNormal = 1.0 - 1.3e-5;
// A direction is across an edge, and a neighbour not above a vertex, up to this sine.
constexpr double kFlat = 1e-3;

// The vertices of the triangle that are farthest along a direction.
struct Farthest {
    int vertex[3], count = 0;
};
Farthest farthest_along(const PlacedTriangle& t, const glm::dvec3& d) {
    int best = 0;
    for (int k = 1; k < 3; ++k)
        if (glm::dot(d, t.corner[k] - t.corner[best]) > 0.0) best = k;
    Farthest result;
    result.vertex[result.count++] = best;
    for (int k = 0; k < 3; ++k) {
        const glm::dvec3 way = t.corner[k] - t.corner[best];
        if (k != best && glm::dot(d, way) >= -kFlat * glm::length(way)) result.vertex[result.count++] = k;
    }
    return result;
}

bool is_triangle(const Part& part) {
    return part.body.kind() == Kind::triangle;
}

}  // namespace

PlacedTriangle placed_triangle(const Part& part, const glm::dvec3& origin) {
    PlacedTriangle t;
    for (int k = 0; k < 3; ++k)
        t.corner[k] = part.pose.rotation * part.body.vertex(k) + (part.pose.translation - origin);
    const glm::dvec3 n = glm::cross(t.corner[1] - t.corner[0], t.corner[2] - t.corner[0]);
    const double length = glm::length(n);
    t.normal = length > 0.0 ? n / length : glm::dvec3(0.0);
    return t;
}

glm::dvec3 middle_of(const Placed& placed, const glm::dvec3& origin) {
    const Hull* const hull = placed.body.hull();
    const glm::dvec3 middle = hull != nullptr ? hull->mass().center : placed.body.bounds().center();
    return placed.pose.rotation * middle + (placed.pose.translation - origin);
}

bool is_in_front(const Part& part, const Placed& body) {
    const glm::dvec3 origin = part.pose.translation;
    const PlacedTriangle t = placed_triangle(part, origin);
    if (body.body.kind() == Kind::half_space) return true;
    return glm::dot(t.normal, middle_of(body, origin) - t.corner[0]) >= 0.0;
}

class ManifoldFinder {
  public:
    ManifoldFinder(const ManifoldOptions& options, Manifolds& found) : options_(options), found_(found) {
        all_points_ = options;
        all_points_.max_points = 8;
    }

    void run(const Placed& a, const Placed& b, PairCache* cache) {
        found_.all_.clear();
        if (a.body.is_convex() && b.body.is_convex()) {
            const Manifold m = contact_manifold(a, b, options_, cache);
            if (m.count > 0) found_.all_.push_back(m);
            return;
        }
        if (b.body.is_convex()) {
            find(a, b, {}, false);
        } else if (a.body.is_convex()) {
            find(b, a, {}, true);
        } else {
            visit_parts_near(a, b, options_.margin, [&](const Part& part) {
                find(b, {part.body, part.pose}, part.id, true);
                return false;
            });
        }
        finish();
    }

  private:
    // The manifolds of a, which has parts, and b, which is convex; `of_b`: b's part.
    void find(const Placed& a, const Placed& b, const PartId& of_b, bool flip) {
        found_.near_.clear();
        visit_parts_near(a, b, options_.margin, [&](const Part& part) {
            found_.near_.push_back(part);
            return false;
        });
        for (const Part& part : found_.near_) {
            Manifold m = touch(part, b);
            if (m.count == 0) continue;
            for (int i = 0; i < m.count; ++i) {
                m.points[i].part_a = part.id;
                m.points[i].part_b = of_b;
            }
            add(flip ? flipped(m) : m);
        }
    }

    void add(const Manifold& m) {
        for (Manifold& one : found_.all_)
            if (glm::dot(one.normal, m.normal) >= kSameNormal) return merge(one, m, 8);
        found_.all_.push_back(m);
    }

    void finish() {
        for (Manifold& m : found_.all_) merge(m, {}, std::clamp(options_.max_points, 1, 8));
    }

    static void merge(Manifold& into, const Manifold& more, int most) {
        RawPoint points[16];
        int count = 0;
        for (const Manifold* m : {static_cast<const Manifold*>(&into), &more})
            for (int i = 0; i < m->count; ++i) {
                const ContactPoint& p = m->points[i];
                points[count++] = {p.position, p.depth, p.on_a, p.on_b, p.part_a, p.part_b};
            }
        if (more.count > 0 && more.depth > into.depth) into.normal = more.normal;
        thin_out(into, points, count, most);
    }

    [[nodiscard]] Manifold touch(const Part& part, const Placed& b) const {
        const Placed placed{part.body, part.pose};
        const Manifold m = contact_manifold(placed, b, all_points_);
        if (m.count == 0 || !is_triangle(part)) return m;
        const PlacedTriangle t = placed_triangle(part, part.pose.translation);
        const double along = glm::dot(m.normal, t.normal);
        const bool front_only = part.sides == Sides::front;
        if (front_only && along <= 0.0 && !is_in_front(part, b)) return {};
        const bool allowed = !front_only || along > 0.0;
        if (allowed && (std::abs(along) >= 1.0 - 0.5 * kFlat * kFlat || !points_into_neighbor(part, t, m.normal)))
            return m;
        if (t.normal == glm::dvec3(0.0)) return {};
        const bool front = front_only || is_in_front(part, b);
        return manifold_along(placed, b, front ? t.normal : -t.normal, all_points_);
    }

    // Whether a triangle that shares the vertices on which the normal stands rises above them along it.
    [[nodiscard]] bool points_into_neighbor(const Part& part, const PlacedTriangle& t, const glm::dvec3& normal) const {
        const Farthest on = farthest_along(t, normal);
        if (on.count == 3) return false;
        for (const Part& other : found_.near_) {
            if (&other == &part || !is_triangle(other) || other.id.child != part.id.child) continue;
            int shared = 0;
            for (int k = 0; k < on.count; ++k)
                for (int j = 0; j < 3; ++j) shared += other.body.vertex(j) == part.body.vertex(on.vertex[k]) ? 1 : 0;
            if (shared < on.count) continue;
            for (int j = 0; j < 3; ++j) {
                const glm::dvec3 way = part.pose.rotation * (other.body.vertex(j) - part.body.vertex(on.vertex[0]));
                if (glm::dot(normal, way) > kFlat * glm::length(way)) return true;
            }
        }
        return false;
    }

    ManifoldOptions options_, all_points_;
    Manifolds& found_;
};

void contact_manifolds(const Placed& a, const Placed& b, const ManifoldOptions& options, Manifolds& found,
                       PairCache* cache) {
    ManifoldFinder(options, found).run(a, b, cache);
}

Manifold deepest_manifold(const Placed& a, const Placed& b, const ManifoldOptions& options) {
    Manifolds found;
    contact_manifolds(a, b, options, found);
    Manifold deepest;
    for (const Manifold& m : found.all())
        if (deepest.count == 0 || m.depth > deepest.depth) deepest = m;
    return deepest;
}

}  // namespace crofton::convex
