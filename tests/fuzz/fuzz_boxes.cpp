// SPDX-License-Identifier: MIT
// Pairs of boxes that touch or nearly do, and boxes beside triangles and half-spaces: against exact integers and
// rationals.
#include <crofton/collide/narrow_phase.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <oracle/exact_boxes.hpp>
#include <oracle/exact_frustum.hpp>
#include <oracle/exact_triangles.hpp>

#include "shapes.hpp"

namespace {

using namespace crofton;
using fuzz::demand;

double size_of(const Obb& a, const Obb& b) {
    double size = glm::length(b.center - a.center);
    for (int k = 0; k < 3; ++k) size += double(a.half_extents[k]) + double(b.half_extents[k]);
    return size;
}

void check_pair(fuzz::Shapes& in) {
    const Obb a = in.box(), b = in.box_near(a);
    const bool meet = oracle::boxes_meet_by_integers(a, b);
    demand(collide::intersects(a, b) == meet && collide::intersects(b, a) == meet, "two boxes meet");
    const int hint = static_cast<int>(in.below(17)) - 1;
    demand((collide::separating_axis(a, b, hint) == collide::kNotSeparated) == meet, "a separating axis");
    const collide::Distance distance = collide::distance(a, b);
    demand((distance.distance == 0.0) == meet, "a distance of 0");
    const double size = size_of(a, b);
    const collide::Penetration depth = collide::penetration(a, b);
    demand(depth.depth >= -distance.distance - 1e-9 * size, "a gap that is larger than the distance");
    demand(depth.depth <= 1e-9 * size || meet || distance.distance <= 1e-9 * size, "depth of boxes that are apart");
    const collide::Manifold manifold = collide::contact_manifold(a, b);
    demand((manifold.count > 0) == meet && manifold.count <= 4, "points of contact");
    for (int i = 0; i < manifold.count; ++i) demand(manifold.points[i].depth >= 0.0, "a point's depth");

    // Moved by more than the depth along its axis, they are apart.
    if (meet && depth.depth < 1e6) {
        Obb away = b;
        away.center += (depth.depth + 1e-9 + 1e-6 * (size + glm::length(b.center))) * depth.axis;
        demand(!oracle::boxes_meet_by_integers(a, away), "the depth parts them");
    }
}

void check_batch(fuzz::Shapes& in) {
    const std::vector<Obb> a = in.boxes(20);
    std::vector<Obb> b;
    std::vector<IdPair> pairs;
    for (const Obb& box : a) {
        b.push_back(in.box_near(box));
        pairs.push_back({static_cast<std::uint32_t>(in.below(static_cast<unsigned>(a.size()))),
                         static_cast<std::uint32_t>(in.below(static_cast<unsigned>(a.size())))});
    }
    std::vector<std::uint8_t> hits(a.size()), packed(a.size()), paired(a.size());
    collide::intersects(a, b, hits);
    collide::PackedBoxes of_a, of_b;
    const glm::dvec3 origin = in.point();
    of_a.pack(a, origin);
    of_b.pack(b, origin);
    collide::intersects(of_a, of_b, packed);
    collide::intersects(std::span<const Obb>(a), pairs, paired);
    for (std::size_t i = 0; i < a.size(); ++i) {
        const bool meet = collide::intersects(a[i], b[i]);
        demand((hits[i] != 0) == meet, "a batch of boxes");
        demand((packed[i] != 0) == meet, "packed boxes");
        demand((paired[i] != 0) == collide::intersects(a[pairs[i].first], a[pairs[i].second]), "pairs of a list");
    }
}

// Whether some point a + u (b − a) + v (c − a) of the triangle is between the box's faces, by eliminating u and v.
bool box_meets_triangle(const Obb& box, const Triangle& triangle) {
    std::vector<oracle::Inequality> rows;
    const auto volume_row = [&](int k, int side) {
        // |dot(n, x − center)| ≤ h |dot(n, axis_k)| with n across the two other axes.
        const oracle::Vec3q n =
            oracle::cross(oracle::rational(box.axes[(k + 1) % 3]), oracle::rational(box.axes[(k + 2) % 3]));
        const oracle::Rational projected_radius =
            abs(oracle::dot(n, oracle::rational(box.axes[k]))) * oracle::Rational(double(box.half_extents[k]));
        const auto at = [&](const glm::dvec3& p) {
            return oracle::Rational(side *
                                    oracle::dot(n, oracle::minus(oracle::rational(p), oracle::rational(box.center))));
        };
        const oracle::Rational fa = at(triangle[0]);
        rows.push_back({at(triangle[1]) - fa, at(triangle[2]) - fa, fa + projected_radius});
    };
    for (int k = 0; k < 3; ++k)
        for (const int side : {-1, 1}) volume_row(k, side);
    rows.push_back({1, 0, 0});
    rows.push_back({0, 1, 0});
    rows.push_back({-1, -1, 1});
    return oracle::is_feasible(rows);
}

void check_triangle(fuzz::Shapes& in) {
    const Obb box = in.box();
    Triangle triangle = in.triangle();
    if (in.flag()) {
        const glm::dvec3 shift = in.point_of(box) + in.nudge() - triangle[0];
        for (glm::dvec3& p : triangle) p += shift;
    }
    demand(collide::intersects(box, triangle) == box_meets_triangle(box, triangle), "a box and a triangle");
    const Frustum frustum = in.frustum();
    demand(intersects(frustum, triangle[0], triangle[1], triangle[2]) ==
               oracle::meets(frustum, triangle[0], triangle[1], triangle[2]),
           "a view and a triangle");
}

void check_point_and_half_space(fuzz::Shapes& in) {
    const Obb box = in.box();
    const glm::dvec3 p = in.point_of(box) + in.nudge();
    Obb point;
    point.center = p;
    demand(contains(box, p) == oracle::boxes_meet_by_integers(box, point), "a point in a box");
    Plane plane;
    plane.normal = in.direction();
    plane.offset = in.flag() ? -glm::dot(plane.normal, p) : in.coordinate();
    Frustum half_space;
    half_space.planes[0] = plane;
    half_space.plane_count = 1;
    demand(collide::intersects(box, plane) == !oracle::is_rejected_by_a_plane(half_space, box), "a half-space");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzz::Shapes in(data, size);
    switch (in.below(5)) {
        case 0:
            check_batch(in);
            break;
        case 1:
            check_triangle(in);
            break;
        case 2:
            check_point_and_half_space(in);
            break;
        default:
            check_pair(in);
    }
    return 0;
}
