// SPDX-License-Identifier: MIT
// The features that contact points name: whether the points are there.
#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>
#include <crofton/convex/query.hpp>
#include <crofton/mesh/mesh_tree.hpp>

#include "random_shapes.hpp"

using namespace crofton;
using namespace crofton::convex;
using namespace crofton::testing;

namespace {

glm::dvec3 placed(const ShapeAtPose& b, int vertex) {
    return b.pose.rotation * b.shape.vertex(vertex) + b.pose.translation;
}

double distance_to_segment(const glm::dvec3& p, const glm::dvec3& from, const glm::dvec3& to) {
    const glm::dvec3 along = to - from;
    const double square = glm::dot(along, along);
    const double t = square > 0.0 ? std::clamp(glm::dot(p - from, along) / square, 0.0, 1.0) : 0.0;
    return glm::length(p - from - t * along);
}

double distance_to_plane(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    const glm::dvec3 n = glm::cross(b - a, c - a);
    return std::abs(glm::dot(p - a, n)) / glm::length(n);
}

// From a point of the core of a hull, box, triangle, capsule or sphere to the feature; to the plane of a face.
double distance_to_feature(const ShapeAtPose& b, const Feature& feature, const glm::dvec3& p) {
    const int i = feature.index;
    if (feature.kind == FeatureKind::vertex) return glm::length(p - placed(b, i));
    if (b.shape.hull() != nullptr) {
        if (feature.kind == FeatureKind::edge) {
            const HullEdge& e = b.shape.hull()->edges()[feature.index];
            return distance_to_segment(p, placed(b, e.vertices[0]), placed(b, e.vertices[1]));
        }
        const glm::dvec3 out = p - placed(b, b.shape.hull()->face_vertices(i)[0]);
        return std::abs(glm::dot(b.pose.rotation * b.shape.hull()->face_normal(i), out));
    }
    if (b.shape.kind() == Kind::box) {
        const int k = feature.kind == FeatureKind::edge ? i / 4 : i / 2, u = 1 << (k + 1) % 3, v = 1 << (k + 2) % 3;
        if (feature.kind == FeatureKind::edge) {
            const int from = ((i & 1) != 0 ? u : 0) + ((i & 2) != 0 ? v : 0);
            return distance_to_segment(p, placed(b, from), placed(b, from + (1 << k)));
        }
        const int from = (i & 1) << k;
        return distance_to_plane(p, placed(b, from), placed(b, from + u), placed(b, from + v));
    }
    if (feature.kind == FeatureKind::edge)
        return distance_to_segment(p, placed(b, i), placed(b, (i + 1) % b.shape.vertex_count()));
    return distance_to_plane(p, placed(b, 0), placed(b, 1), placed(b, 2));
}

// The least of points below a surface, by its rounding or more, more where it is tilted. It is convex along the line.
double distance_below(const ShapeAtPose& b, const Feature& feature, const glm::dvec3& on_surface,
                      const glm::dvec3& out) {
    double low = 0.99 * b.shape.radius(), high = 50.0 * b.shape.radius();
    const auto at_depth = [&](double t) { return distance_to_feature(b, feature, on_surface - t * out); };
    for (int i = 0; i < 100; ++i) {
        const double left = (2.0 * low + high) / 3.0, right = (low + 2.0 * high) / 3.0;
        (at_depth(left) <= at_depth(right) ? high : low) = at_depth(left) <= at_depth(right) ? right : left;
    }
    return at_depth(low);
}

}  // namespace

TEST_SUITE("convex/features") {
    TEST_CASE("points lie on the features that they name, faces, edges and vertices alike") {
        RandomShapes random(3);
        const auto any_shape = [&](int i) {
            const Shape core = random.polytope(24);
            if (i % 5 == 0) return Shape::rounded(core, random.number(0.0, 0.3)).value();
            if (i % 5 == 1) return Shape::capsule(0.7f, 0.2f).value();
            return core;
        };
        int named[3][3] = {};
        for (int i = 0; i < 1500; ++i) {
            const Shape a = any_shape(i), b = any_shape(i / 5);
            const CasePair where = nearly_touching(random, a, b, -std::pow(10.0, random.number(-6, -1)), 0.0);
            const ShapeAtPose pa{a, where.pose_a}, pb{b, where.pose_b};
            const Manifold m = contact_manifold(pa, pb, {.max_points = 8});
            for (int k = 0; k < m.count; ++k) {
                const ContactPoint& point = m.points[k];
                const glm::dvec3 half = 0.5 * point.depth * m.normal;
                // Hulls' faces are flat to 1e-5 alone.
                double tolerance = 2e-5 * (a.core_radius() + b.core_radius() + glm::length(where.pose_b.translation));
                // Round sides and edges within 2 degrees of parallel have points at their ends, midway between them.
                const bool at_ends = point.on_a.kind != FeatureKind::face && point.on_b.kind != FeatureKind::face &&
                                     (point.on_a.kind == FeatureKind::vertex || point.on_b.kind == FeatureKind::vertex);
                if (at_ends && a.radius() > 0.0 && b.radius() > 0.0)
                    tolerance += 0.036 * std::min(a.core_radius(), b.core_radius());
                CAPTURE(i);
                CHECK(distance_below(pa, point.on_a, point.position + half, m.normal) <= tolerance);
                CHECK(distance_below(pb, point.on_b, point.position - half, -m.normal) <= tolerance);
                ++named[static_cast<int>(point.on_a.kind)][static_cast<int>(point.on_b.kind)];
            }
        }
        CHECK(named[0][2] > 200);
        CHECK(named[1][1] > 200);
        CHECK(named[2][0] > 200);
    }

    TEST_CASE("points of spheres and capsules on a surface's triangle lie on the features that they name") {
        RandomShapes random(9);
        int named[3] = {};
        for (int i = 0; i < 1500; ++i) {
            TriangleMesh mesh;
            for (const glm::vec3& p : random.points(3)) mesh.positions.push_back(p);
            mesh.indices = {0, 1, 2};
            const auto tree = mesh::MeshTree::build(mesh).value();
            const Shape surface = Shape::mesh(tree).value(),
                        triangle = Shape::triangle(mesh.positions[0], mesh.positions[1], mesh.positions[2]).value(),
                        round = i % 2 == 0 ? Shape::sphere(0.3).value() : Shape::capsule(0.7f, 0.2f).value();
            const double depth = std::pow(10.0, random.number(-6, -2));
            CasePair where = nearly_touching(random, triangle, round, -depth, 0.0);
            if (i % 3 != 0) {  // else at a corner, most likely: below its end, the middle of an edge or of the face
                const auto corner = [&](int k) { return where.pose_a.rotation * triangle.vertex(k); };
                const glm::dvec3 edge = corner(1) - corner(0),
                                 normal = glm::normalize(glm::cross(edge, corner(2) - corner(0))),
                                 out = glm::normalize(glm::cross(edge, normal));
                const bool at_edge = i % 3 == 1;
                const glm::dvec3 below = at_edge ? 0.5 * (corner(0) + corner(1))
                                                 : (corner(0) + corner(1) + corner(2)) / 3.0,
                                 up = at_edge ? glm::normalize(out + random.number(-1, 1) * normal) : normal,
                                 side = glm::normalize(glm::cross(up, edge));
                where.pose_b = {glm::dmat3(side, up, glm::cross(side, up)),
                                where.pose_a.translation + below + ((i % 2 == 0 ? 0.3 : 0.9) - depth) * up};
            }
            const ShapeAtPose part{triangle, where.pose_a}, other{round, where.pose_b};
            Manifolds found;
            contact_manifolds({surface, where.pose_a}, other, {.max_points = 8}, found);
            CAPTURE(i);
            for (const Manifold& m : found.all())
                for (int k = 0; k < m.count; ++k) {
                    const ContactPoint& point = m.points[k];
                    const glm::dvec3 half = 0.5 * point.depth * m.normal;
                    CHECK(distance_to_feature(part, point.on_a, point.position + half) <= 1e-8);
                    CHECK(distance_to_feature(other, point.on_b, point.position - half + round.radius() * m.normal) <=
                          1e-8);
                    ++named[static_cast<int>(point.on_a.kind)];
                }
        }
        for (const int count : named) CHECK(count > 100);
    }
}
