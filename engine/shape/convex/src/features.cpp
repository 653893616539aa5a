// SPDX-License-Identifier: MIT
#include "features.hpp"

#include <algorithm>
#include <cmath>

#include "pair.hpp"

namespace crofton::convex {
namespace {

constexpr double kHalf = 0.70710678118654752;
constexpr double kEighths[8][2] = {{1, 0},  {kHalf, kHalf},   {0, 1},  {-kHalf, kHalf},
                                   {-1, 0}, {-kHalf, -kHalf}, {0, -1}, {kHalf, -kHalf}};

struct Frame {
    const glm::dmat3& rotation;
    glm::dvec3 translation;
    [[nodiscard]] glm::dvec3 operator()(const glm::dvec3& p) const { return rotation * p + translation; }
};

void add(Patch& patch, const glm::dvec3& point, int vertex, int edge) {
    patch.point[patch.count] = point;
    patch.vertex[patch.count] = static_cast<std::uint16_t>(vertex);
    patch.edge[patch.count++] = static_cast<std::uint16_t>(edge);
}

void add_only(Patch& patch, const glm::dvec3& point, int vertex, int edge) {
    patch.self = {FeatureKind::vertex, static_cast<std::uint16_t>(vertex)};
    add(patch, point, vertex, edge);
}

// Of the rims of a cylinder or cone: 0 to 7 below, 8 to 15 above.
glm::dvec3 rim_point(const Shape& shape, int vertex) {
    const double radius = shape.half_extents().x, height = shape.half_extents().y;
    const double(&at)[2] = kEighths[vertex & 7];
    return {radius * at[0], vertex < 8 ? -height : height, radius * at[1]};
}

void disc(const Shape& shape, const Frame& place, bool upper, Patch& patch) {
    const double height = shape.half_extents().y;
    if (shape.half_extents().x == 0.0)
        return add_only(patch, place({0.0, upper ? height : -height, 0.0}), upper ? 17 : 16, 16);
    patch.self = {FeatureKind::face, static_cast<std::uint16_t>(upper ? 1 : 0)};
    patch.normal = upper ? place.rotation[1] : -place.rotation[1];
    for (int k = 0; k < 8; ++k) {
        const int at = (upper ? 8 : 0) + (upper ? (8 - k) % 8 : k);  // from x towards z is clockwise seen from above
        add(patch, place(rim_point(shape, at)), at, upper ? 8 + (at + 7) % 8 : at);
    }
}

// Discs where they look along the direction, else the line of the side that is farthest out.
void round_patch(const Shape& shape, const Frame& place, const glm::dvec3& local, Patch& patch) {
    const double radius = shape.half_extents().x, height = shape.half_extents().y;
    const double across = std::sqrt(local.x * local.x + local.z * local.z);
    const bool cone = shape.kind() == Kind::cone;
    // The side's normal has the components (2 h, r) / length across and along the axis; a cylinder's (1, 0).
    const double length = std::sqrt(4.0 * height * height + radius * radius);
    const double side = !cone ? across : length > 0.0 ? (2.0 * height * across + radius * local.y) / length : 0.0;
    const double cap = cone ? -local.y : std::abs(local.y);
    const bool flat = height == 0.0;  // a disc, seen from either side
    if (flat ? std::abs(local.y) >= across : cap >= side || !(across > 0.0)) {
        if (!cone || flat || local.y < 0.0) return disc(shape, place, local.y > 0.0, patch);
        return add_only(patch, place({0.0, height, 0.0}), 17, 16);
    }
    const glm::dvec3 rim(radius * (local.x / across), 0.0, radius * (local.z / across));
    if (flat) return add_only(patch, place(rim), 16, 16);
    patch.self = {FeatureKind::edge, 16};
    add(patch, place({rim.x, -height, rim.z}), 16, 16);
    add(patch, place(cone ? glm::dvec3(0.0, height, 0.0) : glm::dvec3(rim.x, height, rim.z)), 17, 16);
}

}  // namespace

glm::dvec3 turned_normal(const glm::dmat3& r, const glm::dvec3& n) {
    return glm::normalize(n.x * glm::cross(r[1], r[2]) + n.y * glm::cross(r[2], r[0]) + n.z * glm::cross(r[0], r[1]));
}

glm::dvec3 triangle_normal(const glm::dmat3& rotation, const Triangle& corners) {
    const glm::dvec3 n = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
    return n == glm::dvec3(0.0) ? n : turned_normal(rotation, n);
}

bool is_narrow(const glm::dvec3* points, int count) {
    glm::dvec3 area(0.0), before = points[1] - points[0];
    double longest2 = glm::dot(before, before);
    for (int k = 2; k < count; ++k) {
        const glm::dvec3 way = points[k] - points[0], side = way - before;
        area += glm::cross(before, way);
        longest2 = std::max({longest2, glm::dot(way, way), glm::dot(side, side)});
        before = way;
    }
    return !(glm::length(area) > 1e-6 * longest2);
}

int face_along(const Shape& shape, const glm::dvec3& d) {
    if (shape.kind() == Kind::box) {
        const glm::dvec3 m = glm::abs(d);
        const int k = m.x >= m.y && m.x >= m.z ? 0 : m.y >= m.z ? 1 : 2;
        return 2 * k + (d[k] > 0.0 ? 1 : 0);
    }
    if (shape.vertex_count() == 3) return 0;
    if (shape.kind() != Kind::hull) return -1;
    double along = 0.0;
    const Hull& hull = *shape.hull();
    return farthest_of(hull.normal_column(0), hull.normal_column(1), hull.normal_column(2), hull.padded_face_count(), d,
                       along);
}

void corners_of_face(const ShapeAtPose& placed, int face, const glm::dvec3& origin, Patch& patch) {
    const Shape& shape = placed.shape;
    const Frame place{placed.pose.rotation, placed.pose.translation - origin};
    patch.count = 0;
    patch.of = &placed;
    patch.self = {FeatureKind::face, static_cast<std::uint16_t>(face)};
    if (shape.kind() == Kind::box) {
        const auto& corners = kBoxFaces[face];
        const glm::dvec3& half = shape.half_extents();
        const int u = (face / 2 + 1) % 3, v = (face / 2 + 2) % 3;
        if (half[u] == 0.0 && half[v] == 0.0) return add_only(patch, place(shape.vertex(corners[0])), corners[0], 0);
        if (half[u] == 0.0 || half[v] == 0.0) {
            const int low = corners[0], high = low | 1 << (half[u] > 0.0 ? u : v);
            patch.self = {FeatureKind::edge, box_edge(low, high)};
            add(patch, place(shape.vertex(low)), low, patch.self.index);
            return add(patch, place(shape.vertex(high)), high, patch.self.index);
        }
        for (int k = 0; k < 4; ++k)
            add(patch, place(shape.vertex(corners[k])), corners[k], box_edge(corners[k], corners[(k + 1) % 4]));
    } else if (shape.kind() == Kind::hull) {
        const auto vertices = shape.hull()->face_vertices(face), edges = shape.hull()->face_edges(face);
        for (std::size_t k = 0; k < vertices.size(); ++k)
            add(patch, place(shape.vertex(vertices[k])), vertices[k], edges[k]);
    } else {
        for (int k = 0; k < 3; ++k) add(patch, place(shape.vertex(k)), k, k);
    }
}

void patch_of_face(const ShapeAtPose& placed, int face, const glm::dvec3& origin, Patch& patch) {
    const Shape& shape = placed.shape;
    const glm::dmat3& rotation = placed.pose.rotation;
    corners_of_face(placed, face, origin, patch);
    if (shape.kind() == Kind::box) {
        glm::dvec3 outward(0.0);
        outward[face / 2] = (face & 1) != 0 ? 1.0 : -1.0;
        patch.normal = turned_normal(rotation, outward);
    } else if (shape.kind() == Kind::hull ? shape.hull()->is_narrow_face(face) : is_narrow(patch.point, 3)) {
        patch.normal = glm::dvec3(0.0);
    } else {
        patch.normal = shape.kind() == Kind::hull
                           ? turned_normal(rotation, shape.hull()->face_normal(face))
                           : triangle_normal(rotation, {shape.vertex(0), shape.vertex(1), shape.vertex(2)});
    }
}

void patch_along(const ShapeAtPose& placed, const glm::dvec3& direction, const glm::dvec3& origin, Patch& patch) {
    const Shape& shape = placed.shape;
    const glm::dvec3 local = Pair::local(placed.pose.rotation, direction);
    if (const int face = face_along(shape, local); face >= 0) {
        patch_of_face(placed, face, origin, patch);
        if (patch.count < 3) patch.normal = direction;
        if (shape.vertex_count() == 3 && glm::dot(patch.normal, direction) < 0.0) {  // from behind
            std::swap(patch.point[1], patch.point[2]);
            std::swap(patch.vertex[1], patch.vertex[2]);
            std::swap(patch.edge[0], patch.edge[2]);
            patch.normal = -patch.normal;
        }
        return;
    }
    const Frame place{placed.pose.rotation, placed.pose.translation - origin};
    patch.count = 0;
    patch.of = &placed;
    patch.normal = direction;
    if (!shape.has_polytope_core()) return round_patch(shape, place, local, patch);
    if (shape.vertex_count() == 2 && shape.vertex(0) == shape.vertex(1))
        return add_only(patch, place(shape.vertex(0)), local.y > 0.0 ? 1 : 0, 0);
    for (int k = 0; k < shape.vertex_count(); ++k) add(patch, place(shape.vertex(k)), k, 0);
    patch.self = {patch.count == 1 ? FeatureKind::vertex : FeatureKind::edge, 0};
}

glm::dvec3 exact_edge(const Patch& patch, int k) {
    const int next = k + 1 < patch.count ? k + 1 : 0;
    if (patch.of == nullptr) return patch.point[next] - patch.point[k];
    const Shape& shape = patch.of->shape;
    const auto local = [&](int i) {
        return shape.has_polytope_core() ? shape.vertex(patch.vertex[i]) : rim_point(shape, patch.vertex[i]);
    };
    return patch.of->pose.rotation * (local(next) - local(k));
}

Feature feature_of(const Shape& shape, const int* vertices, int count) {
    int distinct[4], found = 0;
    for (int i = 0; i < count; ++i)
        if (std::find(distinct, distinct + found, vertices[i]) == distinct + found) distinct[found++] = vertices[i];
    if (found == 1) return {FeatureKind::vertex, static_cast<std::uint16_t>(distinct[0])};
    if (shape.kind() == Kind::hull) {
        const auto edges = shape.hull()->edges();
        for (std::size_t e = 0; found == 2 && e < edges.size(); ++e)
            if ((edges[e].vertices[0] == distinct[0] && edges[e].vertices[1] == distinct[1]) ||
                (edges[e].vertices[0] == distinct[1] && edges[e].vertices[1] == distinct[0]))
                return {FeatureKind::edge, static_cast<std::uint16_t>(e)};
        for (int f = 0; f < shape.hull()->face_count(); ++f) {
            const auto loop = shape.hull()->face_vertices(f);
            if (std::all_of(distinct, distinct + found,
                            [&](int v) { return std::find(loop.begin(), loop.end(), v) != loop.end(); }))
                return {FeatureKind::face, static_cast<std::uint16_t>(f)};
        }
    } else if (shape.kind() == Kind::box) {
        const int differing = distinct[0] ^ distinct[1];
        if (found == 2 && (differing & (differing - 1)) == 0)
            return {FeatureKind::edge, box_edge(distinct[0], distinct[1])};
        for (int f = 0; f < 6; ++f)
            if (std::all_of(distinct, distinct + found, [&](int v) { return (v >> (f / 2) & 1) == (f & 1); }))
                return {FeatureKind::face, static_cast<std::uint16_t>(f)};
    } else if (found == 2) {
        const int low = std::min(distinct[0], distinct[1]);
        return {FeatureKind::edge, static_cast<std::uint16_t>(low + std::max(distinct[0], distinct[1]) == 2 ? 2 : low)};
    }
    return {FeatureKind::face, 0};
}

}  // namespace crofton::convex
