// SPDX-License-Identifier: MIT
// No contact pushes a shape into the neighbour of the triangle that it touches, whatever the shape reaches.
#include <doctest/doctest.h>
#include <algorithm>
#include <array>
#include <cmath>
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
                    const ContactPoint* deepest = m.points;
                    for (int k = 1; k < m.count; ++k)
                        if (m.points[k].depth > deepest->depth) deepest = m.points + k;
                    const Verdict verdict = rule(s, deepest->part_a.triangle, m.normal);
                    CHECK(verdict != Verdict::into_neighbor);
                    judged += verdict == Verdict::belongs;
                }
            }
        }
        CHECK(judged > 5000);
    }
}
