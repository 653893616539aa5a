// SPDX-License-Identifier: MIT
// Bounds at the very edge of their verdict, where only exact signs are right: a filter whose error bound is too small
// is caught here.
#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>
#include <crofton/cull/classify.hpp>
#include <oracle/edges.hpp>
#include <oracle/exact_bounds.hpp>
#include <oracle/exact_frustum.hpp>

using namespace crofton;
using cull::CullMode;
using cull::Verdict;

namespace {

Obb moved(Obb box, const glm::dvec3& by) {
    box.center += by;
    return box;
}
Aabb moved(Aabb box, const glm::dvec3& by) {
    box.min += by;
    box.max += by;
    return box;
}
Sphere moved(Sphere sphere, const glm::dvec3& by) {
    sphere.center += by;
    return sphere;
}

glm::dvec3 center_of(const Obb& box) {
    return box.center;
}
glm::dvec3 center_of(const Aabb& box) {
    return box.center();
}
glm::dvec3 center_of(const Sphere& sphere) {
    return sphere.center;
}

// Where the bound, moving from the frustum's middle outward through where it is, stops being inside, meeting, or
// unrejected by a plane: all three against the oracle.
template <class Bound>
int compare_at_edges(const Frustum& frustum, const Bound& bound) {
    int compared = 0;
    glm::dvec3 middle = frustum.origin;
    const auto corners = *frustum_corners(frustum);
    for (const glm::dvec3& corner : corners) middle += 0.125 * corner;
    const glm::dvec3 way = center_of(bound) - middle;
    const double longest = 20.0;
    const auto at = [&](double s) { return moved(bound, (s - 1.0) * way); };
    // What coordinates hereabouts are rounded to, as a part of the way.
    const glm::dvec3 size = glm::abs(center_of(bound));
    const double step = oracle::rounding_step(std::max({size.x, size.y, size.z})) / glm::length(way);
    const auto compare = [&](auto holds) {
        if (holds(at(0.0)) == holds(at(longest))) return;
        const bool first = holds(at(0.0));
        const double edge = oracle::edge_between(0.0, longest, [&](double s) { return holds(at(s)) == first; }).first;
        for (int k = -4; k <= 4; ++k) {
            const Bound candidate = at(edge + 0.3 * k * step);
            const Verdict expected = oracle::classify(frustum, candidate);
            CHECK(cull::classify(frustum, candidate) == expected);
            const bool rejected = oracle::is_rejected_by_a_plane(frustum, candidate);
            CHECK((cull::classify(frustum, candidate, CullMode::conservative) == Verdict::outside) == rejected);
            ++compared;
        }
    };
    compare([&](const Bound& b) { return cull::classify(frustum, b) == Verdict::outside; });
    compare([&](const Bound& b) { return cull::classify(frustum, b) == Verdict::inside; });
    compare([&](const Bound& b) { return cull::classify(frustum, b, CullMode::conservative) == Verdict::outside; });
    return compared;
}

}  // namespace

TEST_SUITE("cull/edges") {
    TEST_CASE("a bound that moves out of a frustum changes its verdict where the exact oracle says, to the last bit") {
        int boxes = 0, axis_aligned = 0, spheres = 0;
        for (const double offset : {0.0, 1e6}) {
            oracle::NearMisses cases(11, offset);
            for (int trial = 0; trial < 24; ++trial) {
                const Frustum frustum = *frustum_of(cases.camera());
                boxes += compare_at_edges(frustum, cases.box(frustum, 1e-3, 1.0));
                // About as small as the rounding, at the frustum's edges and corners.
                Obb tiny = cases.box(frustum);
                tiny.center = cases.surface_point(frustum, *frustum_corners(frustum));
                tiny.half_extents *= float(std::pow(10.0, cases.number(-17.0, -5.0)));
                boxes += compare_at_edges(frustum, tiny);
                axis_aligned += compare_at_edges(frustum, oracle::near_aabb(cases, frustum));
                spheres += compare_at_edges(frustum, oracle::near_sphere(cases, frustum));
            }
        }
        CHECK(boxes > 500);
        CHECK(axis_aligned > 500);
        CHECK(spheres > 500);
    }
}
