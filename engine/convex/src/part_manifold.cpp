// SPDX-License-Identifier: MIT
#include "part_manifold.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "clip.hpp"
#include "core_query.hpp"

namespace crofton::convex {
namespace {

// Normals this close are one: 5 degrees.
constexpr double kSameNormal = 0.9962;
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

constexpr std::uint32_t kNoVertex = ~std::uint32_t{0};

bool has_vertex(const Body& triangle, const glm::dvec3& vertex) {
    return triangle.vertex(0) == vertex || triangle.vertex(1) == vertex || triangle.vertex(2) == vertex;
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
        found_.next_.clear();
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
        if (!is_triangle(part)) return contact_manifold(placed, b, all_points_);
        const Manifold m = triangle_manifold(placed, b, all_points_);
        if (m.count == 0) return m;
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

    // Lists the triangles at each vertex: chains of their corners, by a hash of the vertex' place.
    void list_corners() const {
        const std::size_t count = found_.near_.size();
        found_.first_.assign(std::bit_ceil(4 * count), kNoVertex);
        found_.next_.assign(3 * count, kNoVertex);
        for (std::uint32_t i = 0; i < count; ++i) {
            if (!is_triangle(found_.near_[i])) continue;
            for (std::uint32_t k = 0; k < 3; ++k) {
                std::uint32_t& first = found_.first_[slot_of(found_.near_[i].body.vertex(static_cast<int>(k)))];
                found_.next_[3 * i + k] = first;
                first = 3 * i + k;
            }
        }
    }
    [[nodiscard]] std::size_t slot_of(const glm::dvec3& vertex) const {
        std::uint64_t hash = 0;
        for (int k = 0; k < 3; ++k)  // -0 is 0
            hash = (hash ^ std::bit_cast<std::uint64_t>(vertex[k] + 0.0)) * 0x9e3779b97f4a7c15u;
        return static_cast<std::size_t>(hash >> 32) & (found_.first_.size() - 1);
    }

    // Whether a triangle that shares the vertices on which the normal stands rises above them along it.
    [[nodiscard]] bool points_into_neighbor(const Part& part, const PlacedTriangle& t, const glm::dvec3& normal) const {
        const Farthest on = farthest_along(t, normal);
        if (on.count == 3) return false;
        if (found_.next_.empty()) list_corners();
        const glm::dvec3 vertex = part.body.vertex(on.vertex[0]);
        for (std::uint32_t c = found_.first_[slot_of(vertex)]; c != kNoVertex; c = found_.next_[c]) {
            const Part& other = found_.near_[c / 3];
            if (other.body.vertex(static_cast<int>(c % 3)) != vertex || other.id.child != part.id.child) continue;
            if (on.count == 2 && !has_vertex(other.body, part.body.vertex(on.vertex[1]))) continue;
            for (int j = 0; j < 3; ++j) {
                const glm::dvec3 way = part.pose.rotation * (other.body.vertex(j) - vertex);
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
