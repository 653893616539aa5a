// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>
#include <crofton/collide/bound_contacts.hpp>
#include <crofton/collide/narrow_phase.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/closest_points.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <vector>

#include "random_boxes.hpp"

using namespace crofton;
using namespace crofton::collide;
using namespace crofton::testing;

namespace {

double half_of(const Obb& box, int k) {
    return double(box.half_extents[k]);
}

// How wide the slab across `direction` between box and segment is, in double around the box's center.
double gap_along(const Obb& box, const glm::dvec3& begin, const glm::dvec3& end, const glm::dvec3& direction) {
    const double length = glm::length(direction);
    if (!(length > 0.0)) return -1e300;
    const glm::dvec3 n = direction / length;
    double along = std::min(glm::dot(n, begin), glm::dot(n, end));
    for (int k = 0; k < 3; ++k) along -= half_of(box, k) * std::abs(glm::dot(n, glm::dvec3(box.axes[k])));
    return along;
}

// The widest slab: across the nearest points, faces, products of edges, and the way without what runs along an edge.
double widest_gap(const Obb& box, const glm::dvec3& begin, const glm::dvec3& end, const glm::dvec3& way) {
    glm::dvec3 axes[4] = {{}, {}, {}, end - begin};
    for (int k = 0; k < 3; ++k) axes[k] = glm::dvec3(box.axes[k]);
    std::vector<glm::dvec3> directions{way};
    for (const glm::dvec3& axis : axes) {
        if (!(glm::dot(axis, axis) > 0.0)) continue;
        glm::dvec3 across = way;
        for (int pass = 0; pass < 3; ++pass) across -= glm::dot(across, axis) / glm::dot(axis, axis) * axis;
        directions.push_back(across);
    }
    for (int p = 0; p < 4; ++p)
        for (int q = p + 1; q < 4; ++q) {
            const glm::dvec3 n = glm::cross(axes[p], axes[q]);
            directions.push_back(glm::dot(n, way) < 0.0 ? -n : n);
        }
    double widest = -1e300;
    for (const glm::dvec3& direction : directions) widest = std::max(widest, gap_along(box, begin, end, direction));
    return widest;
}

Obb any_box(std::mt19937_64& random, int trial) {
    Obb box = random_box(random, trial % 9 == 0 ? 1e6 : 1.0);
    if (trial % 3 == 0) box.half_extents[trial % 9 / 3] = 0.0f;
    if (trial % 5 == 0) box.axes[1] *= 1.0f + 3e-5f;  // nearly as far from orthonormal as validate lets pass
    if (trial % 7 == 0) box.axes[0] = -box.axes[0];   // mirrored
    return box;
}

}  // namespace

TEST_SUITE("collide/capsules") {
    TEST_CASE("boxes and segments: the distance is proven to 1e-12 of the size, and 0 where they meet exactly") {
        std::mt19937_64 random(51);
        int apart = 0, meeting = 0;
        for (int trial = 0; trial < 20000; ++trial) {
            const Obb box = any_box(random, trial);
            glm::dvec3 begin = box.center + 3.0 * random_vector(random), end = begin + 3.0 * random_vector(random);
            if (trial % 4 == 1) end = begin;
            if (trial % 4 == 2) end = begin + 2.0 * glm::dvec3(box.axes[trial % 3]);  // parallel to an edge
            if (trial % 8 == 3) begin = corners(box)[std::size_t(trial / 8 % 8)];     // at a corner, but for rounding
            if (trial % 11 == 0) end = begin + 1e3 * (end - begin);
            const Capsule segment{begin, end, 0.0};
            const Distance d = distance(box, segment);
            const bool meets = intersects(box, Triangle{begin, end, end});
            CAPTURE(trial);
            REQUIRE((d.distance == 0.0) == meets);
            const glm::dvec3 b = begin - box.center, e = end - box.center;
            const double size = half_of(box, 0) + half_of(box, 1) + half_of(box, 2) + glm::length(b) + glm::length(e);
            const double far = glm::length(box.center) * 1e-15;
            if (meets) {
                CHECK(d.on_a == d.on_b);
                ++meeting;
                continue;
            }
            ++apart;
            const glm::dvec3 way = d.on_b - d.on_a;
            CHECK(std::abs(glm::length(way) - d.distance) <= 1e-12 * size + far);
            CHECK(glm::length(d.on_b - closest_on_segment(d.on_b, begin, end)) <= 1e-14 * size + far);
            const glm::dvec3 local = glm::inverse(glm::dmat3(box.axes)) * (d.on_a - box.center);
            for (int k = 0; k < 3; ++k) CHECK(std::abs(local[k]) <= half_of(box, k) + 1e-14 * size + far);
            if (d.distance < 1e-9 * size + 1e3 * far) continue;
            CHECK(d.distance - widest_gap(box, b, e, way) <= 1e-12 * size + 1e3 * far);
        }
        CHECK(apart > 8000);
        CHECK(meeting > 1000);
    }

    TEST_CASE("a radius makes shapes nearer, and points lie on the surfaces") {
        std::mt19937_64 random(52);
        for (int trial = 0; trial < 5000; ++trial) {
            Obb box = any_box(random, trial);
            box.center = {};
            const glm::dvec3 begin = 3.0 * random_vector(random), end = begin + 2.0 * random_vector(random);
            const double radius = 1.5 * std::abs(random_vector(random).x);
            const Distance core = distance(box, Capsule{begin, end, 0.0}),
                           d = distance(box, Capsule{begin, end, radius});
            CHECK(d.distance == doctest::Approx(std::max(0.0, core.distance - radius)).epsilon(1e-12));
            CHECK(intersects(box, Capsule{begin, end, radius}) == (d.distance == 0.0));
            CHECK(glm::length(d.on_b - d.on_a) == doctest::Approx(d.distance).epsilon(1e-9));
            const Sphere sphere{random_vector(random), 0.3};
            const Distance gap = distance(Capsule{begin, end, radius}, sphere);
            const double to_point =
                distance(Obb{sphere.center, glm::mat3(1.0f), glm::vec3(0.0f)}, {begin, end, 0.0}).distance;
            CHECK(gap.distance == doctest::Approx(std::max(0.0, to_point - radius - 0.3)).epsilon(1e-9));
        }
    }

    TEST_CASE("a sphere's contact: moved along the normal by the depth it just touches the box") {
        std::mt19937_64 random(53);
        int inside = 0, met = 0;
        for (int trial = 0; trial < 20000; ++trial) {
            const Obb box = any_box(random, trial);
            Sphere sphere{box.center + 2.0 * random_vector(random), std::abs(random_vector(random).x)};
            if (trial % 6 == 0) sphere.center = corners(box)[std::size_t(trial / 6 % 8)];
            const Manifold m = contact_manifold(box, sphere);
            CAPTURE(trial);
            REQUIRE((m.count > 0) == intersects(box, sphere));
            if (m.count == 0) continue;
            ++met;
            inside += contains(box, sphere.center);
            CHECK(m.points[0].depth == m.depth);
            CHECK(glm::length(m.normal) == doctest::Approx(1.0));
            const double off = 1e-9 * (1.0 + glm::length(box.center));
            CHECK_FALSE(intersects(box, Sphere{sphere.center + (m.depth + off) * m.normal, sphere.radius}));
            if (m.depth > 2.0 * off)
                CHECK(intersects(box, Sphere{sphere.center + (m.depth - off) * m.normal, sphere.radius}));
            // Midway between the surfaces.
            const glm::dvec3 deepest = sphere.center - sphere.radius * m.normal;
            CHECK(glm::length(m.points[0].position - deepest - 0.5 * m.depth * m.normal) <= off);
        }
        CHECK(met > 4000);
        CHECK(inside > 1000);
        const Sphere a{{1e7, 0, 0}, 1.0}, b{{1e7, 1.5, 0}, 1.0};
        CHECK(contact_manifold(a, b).depth == 0.5);
        CHECK(contact_manifold(a, b).normal == glm::dvec3(0, 1, 0));
        CHECK(contact_manifold(a, b).points[0].position == glm::dvec3(1e7, 0.75, 0));
        CHECK(contact_manifold(a, Sphere{{1e7, 2.5, 0}, 1.0}).count == 0);
    }
}
