// SPDX-License-Identifier: MIT
// No contact pushes a shape into the neighbour of the triangle that it touches, whatever the shape reaches.
#include <doctest/doctest.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/geometry/closest_points.hpp>
#include <vector>

#include "surfaces.hpp"

using namespace crofton;
using namespace crofton::convex;
using namespace crofton::testing;

namespace {

enum class Verdict { belongs, into_neighbor, near_limit };

// The rule of contact_manifolds, over all triangles of the surface.
Verdict rule(const Surface& s, std::size_t touched, const glm::dvec3& n) {
    constexpr double kSine = 1e-3;
    const auto corners = [&](std::size_t i) {
        const Shape t = s.triangle(i);
        return std::array<glm::dvec3, 3>{t.vertex(0), t.vertex(1), t.vertex(2)};
    };
    bool is_near_limit = false;
    const auto exceeds_sine = [&](double sine) {
        is_near_limit = is_near_limit || std::abs(sine - kSine) < 1e-6;
        return sine > kSine;
    };
    const auto is_above = [&](const glm::dvec3& p, const glm::dvec3& q) {
        return p != q && exceeds_sine(glm::dot(n, glm::normalize(p - q)));
    };
    const std::array<glm::dvec3, 3> own = corners(touched);
    const glm::dvec3 face = glm::normalize(glm::cross(own[1] - own[0], own[2] - own[0]));
    if (!exceeds_sine(glm::length(glm::cross(n, face)))) return Verdict::belongs;
    std::vector<glm::dvec3> order(own.begin(), own.end()), farthest;
    std::sort(order.begin(), order.end(), [&](const auto& p, const auto& q) { return glm::dot(n, p - q) > 0.0; });
    for (const glm::dvec3& p : order)
        if (std::none_of(farthest.begin(), farthest.end(), [&](const auto& v) { return is_above(v, p); }))
            farthest.push_back(p);
    bool rises = false;
    for (std::size_t i = 0; i < s.size() && farthest.size() < 3; ++i) {
        const std::array<glm::dvec3, 3> t = corners(i);
        const bool shares = std::all_of(farthest.begin(), farthest.end(), [&](const glm::dvec3& v) {
            return std::find(t.begin(), t.end(), v) != t.end();
        });
        if (!shares) continue;
        for (const glm::dvec3& p : t)
            for (const glm::dvec3& v : farthest) rises |= is_above(p, v);
    }
    if (is_near_limit) return Verdict::near_limit;
    return rises ? Verdict::into_neighbor : Verdict::belongs;
}

std::size_t deepest_triangle(const Manifold& m) {
    const auto is_less_deep = [](const ContactPoint& p, const ContactPoint& q) { return p.depth < q.depth; };
    return std::max_element(m.points, m.points + m.count, is_less_deep)->part_a.triangle;
}

}  // namespace

TEST_SUITE("convex/inner_edge") {
    TEST_CASE("a capsule that dips into a triangle beside a diagonal that it does not reach is pushed along the face") {
        Surface s;
        s.mesh.positions = {{-2, 0, -2}, {2, 0, -2}, {2, 0, 2}, {-2, 0, 2}};
        s.mesh.indices = {0, 2, 1, 0, 3, 2};
        s.build();
        const Shape capsule = Shape::capsule(0.6f, 0.3f).value();
        // The axis leans to the diagonal, and the capsule ends before it: to leave sideways takes 0.61. Rolled so that
        // the diagonal is within its box, of which a corner points there.
        const double sine = std::sin(0.45), cosine = std::cos(0.45), half = std::sqrt(0.5);
        const glm::dvec3 axis{sine * half, cosine, -sine * half}, side{half, 0.0, half}, back = glm::cross(side, axis);
        const RigidTransform pose{glm::dmat3(half * (side + back), axis, half * (back - side)),
                                  glm::dvec3(0.66, -0.18, 0.3)};
        const Manifold m = contact_manifold({s.shape(), {}}, {capsule, pose});
        REQUIRE(m.count > 0);
        CHECK(std::abs(m.normal.y) == doctest::Approx(1.0));
        CHECK(m.depth == doctest::Approx(0.6 * cosine + 0.3 - 0.18));
    }
    TEST_CASE("the deepest contact of any shape, however deep, belongs to the surface") {
        RandomShapes random(4602);
        int judged = 0;
        Manifolds found;
        for (int round = 0; round < 150; ++round) {
            const double rough = round % 3 == 0 ? 0.0 : random.number(0.0, 0.5);
            const Surface s =
                round % 4 == 3 ? tangle(random, 6, 4)
                               : ground(random, 3, 1.0, [&](double, double) { return rough * random.number(-1, 1); });
            for (int i = 0; i < 60; ++i) {
                const Shape body = i % 2 == 0 ? any_shape(random) : Shape::capsule(1.0f, 0.2f).value();
                const RigidTransform pose{
                    random.rotation(),
                    1.5 * glm::dvec3(random.number(-1, 1), random.number(-0.7, 0.7), random.number(-1, 1))};
                contact_manifolds({s.shape(), {}}, {body, pose}, {}, found);
                for (const Manifold& m : found.all()) {
                    const Verdict verdict = rule(s, deepest_triangle(m), m.normal);
                    CHECK(verdict != Verdict::into_neighbor);
                    judged += verdict == Verdict::belongs;
                }
            }
        }
        CHECK(judged > 5000);
    }
    TEST_CASE("a ball has a contact for each of many triangles whose touch belongs to the surface, and for no other") {
        RandomShapes random(4911);
        int judged = 0, left_out = 0;
        Manifolds found;
        for (int round = 0; round < 40; ++round) {
            const double rough = round % 4 == 0 ? 0.0 : random.number(0.0, 0.2);
            const Surface s =
                round % 8 == 7 ? tangle(random, 7, 20)
                               : ground(random, 10, 0.2, [&](double, double) { return rough * random.number(-1, 1); });
            for (int i = 0; i < 40; ++i) {
                const float radius = static_cast<float>(random.number(0.3, 1.0));
                glm::dvec3 center(random.number(-1, 1), random.number(-0.2, 1.0), random.number(-1, 1));
                if (i % 4 == 0)  // deep beside a vertex
                    center = glm::dvec3(s.mesh.positions[static_cast<std::size_t>(random.index(7))]) +
                             0.3 * random.direction();
                contact_manifolds({s.shape(Sides::front), {}},
                                  {Shape::sphere(radius).value(), {glm::dmat3(1.0), center}}, {}, found);
                for (const Manifold& m : found.all())
                    CHECK(rule(s, deepest_triangle(m), m.normal) != Verdict::into_neighbor);
                for (std::size_t t = 0; t < s.size(); ++t) {
                    const Shape triangle = s.triangle(t);
                    const std::array<glm::dvec3, 3> corner{triangle.vertex(0), triangle.vertex(1), triangle.vertex(2)};
                    const glm::dvec3 face = glm::normalize(glm::cross(corner[1] - corner[0], corner[2] - corner[0]));
                    const glm::dvec3 way = center - closest_on_triangle(center, corner);
                    const double distance = glm::length(way), depth = static_cast<double>(radius) - distance;
                    if (depth < 1e-3 || distance < 1e-3 || glm::dot(face, way) < 1e-2 * distance) continue;
                    const glm::dvec3 n = way / distance;
                    const Verdict verdict = rule(s, t, n);
                    left_out += verdict == Verdict::into_neighbor;
                    if (verdict != Verdict::belongs) continue;
                    ++judged;
                    const double cosine = std::cos(0.1);  // points of one manifold differ by 5 degrees at most
                    CHECK(std::any_of(found.all().begin(), found.all().end(), [&](const Manifold& m) {
                        return glm::dot(m.normal, n) > cosine && m.depth > depth - 1e-6;
                    }));
                }
            }
        }
        CHECK(judged > 2000);
        CHECK(left_out > 20000);
    }
}
