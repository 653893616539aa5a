// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <glm/geometric.hpp>

#include "pipeline/brute_force.hpp"

using namespace crofton;
using namespace crofton::pipeline;

namespace {

// The cube [-1, 1]^3 as a frustum.
Frustum cube() {
    Frustum frustum;
    for (int axis = 0; axis < 3; ++axis)
        for (const double sign : {1.0, -1.0}) {
            Plane& plane = frustum.planes[frustum.plane_count++];
            plane.normal[axis] = sign;
            plane.offset = 1.0;
        }
    return frustum;
}

Obb box_at(const glm::dvec3& center, float half) {
    Obb box;
    box.center = center;
    box.half_extents = glm::vec3(half);
    return box;
}

}  // namespace

TEST_SUITE("pipeline/brute_force") {
    TEST_CASE("a triangle that touches a plane is unclear, never a verdict") {
        const glm::dvec3 touching[] = {{1.0, 0.0, 0.0}, {2.0, 0.5, 0.0}, {2.0, -0.5, 0.0}};
        CHECK(clip_polygon(cube(), touching).meets == Truth::unclear);
        CHECK(boxes_meet(box_at({0, 0, 0}, 1.0f), box_at({2, 0, 0}, 1.0f)) == Truth::unclear);
    }

    TEST_CASE("a triangle past a corner misses the cube though no plane rejects it") {
        // x + y = 2.2 passes the edge (1, 1) at a distance.
        const glm::dvec3 past[] = {{2.1, 0.1, 0.0}, {0.1, 2.1, 0.0}, {1.2, 1.0, 0.3}};
        CHECK(clip_polygon(cube(), past).meets == Truth::no);
        const glm::dvec3 through[] = {{1.9, 0.0, 0.0}, {0.0, 1.9, 0.0}, {1.2, 1.0, 0.3}};
        CHECK(clip_polygon(cube(), through).meets == Truth::yes);
        CHECK(clip_polygon(cube(), through).contained == Truth::no);
    }

    TEST_CASE("a box around the frustum meets it, one inside is contained, one outside does neither") {
        CHECK(clip_box(cube(), box_at({0, 0, 0}, 5.0f), {0, 0, 0}).meets == Truth::yes);
        CHECK(clip_box(cube(), box_at({0, 0, 0}, 5.0f), {0, 0, 0}).contained == Truth::no);
        CHECK(clip_box(cube(), box_at({0.2, 0, 0}, 0.5f), {0, 0, 0}).contained == Truth::yes);
        CHECK(clip_box(cube(), box_at({3, 0, 0}, 1.0f), {0, 0, 0}).meets == Truth::no);
    }

    TEST_CASE("spheres go by planes alone") {
        CHECK(clip_sphere(cube(), {0, 0, 0}, 0.5).contained == Truth::yes);
        CHECK(clip_sphere(cube(), {1.9, 1.9, 0}, 1.0).meets ==
              Truth::yes);  // 1.27 from the edge, yet no plane rejects it
        CHECK(clip_sphere(cube(), {3.0, 0, 0}, 1.0).meets == Truth::no);
    }

    TEST_CASE("boxes separated only by an edge-edge axis do not overlap") {
        Obb a = box_at({0, 0, 0}, 1.0f), b = box_at({2.3, 2.3, 0}, 1.0f);
        const float s = 0.70710678f;
        b.axes = glm::mat3(glm::vec3(s, s, 0), glm::vec3(-s, s, 0), glm::vec3(0, 0, 1));
        CHECK(boxes_meet(a, b) == Truth::no);  // corner (1, 1) lies 1.84 before b's face, which is at 1.0
        b.center = {1.6, 1.6, 0.0};
        CHECK(boxes_meet(a, b) == Truth::yes);  // 0.85 from the corner to b's centre along its first axis
    }
}
