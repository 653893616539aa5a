// SPDX-License-Identifier: MIT
// Pairs of boxes that touch or nearly do, and boxes beside triangles and half-spaces: against exact integers and
// rationals.
#include <crofton/collide/bound_contacts.hpp>
#include <crofton/collide/narrow_phase.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <oracle/exact_boxes.hpp>
#include <oracle/quick_frustum.hpp>

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
    const bool meet = oracle::boxes_meet(a, b);
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
        demand(!oracle::boxes_meet(a, away), "the depth parts them");
    }
}

void check_batch(fuzz::Shapes& in) {
    const std::vector<Obb> a = in.boxes(6);
    std::vector<Obb> b;
    std::vector<IdPair> pairs;
    for (const Obb& box : a) {
        b.push_back(in.box_near(box));
        pairs.push_back({static_cast<std::uint32_t>(in.below(static_cast<unsigned>(a.size()))),
                         static_cast<std::uint32_t>(in.below(static_cast<unsigned>(a.size())))});
    }
    std::vector<std::uint8_t> hits(a.size()), paired(a.size());
    collide::intersects(a, b, hits);
    collide::intersects(std::span<const Obb>(a), pairs, paired);
    for (std::size_t i = 0; i < a.size(); ++i) {
        const bool meet = collide::intersects(a[i], b[i]);
        demand((hits[i] != 0) == meet, "a batch of boxes");
        demand((paired[i] != 0) == collide::intersects(a[pairs[i].first], a[pairs[i].second]), "pairs of a list");
    }
}

// Whether some point a + u (b − a) + v (c − a) of the triangle is between the box's faces.
bool box_meets_triangle(const Obb& box, const Triangle& triangle) {
    const auto rows_of = [&]<class Number>() {
        using oracle::vector_of;
        auto rows = oracle::quick::rows_of_triangle<Number>();
        for (int k = 0; k < 3; ++k) {
            // |dot(n, x − center)| ≤ h |dot(n, axis_k)| with n across the two other axes.
            const auto n =
                oracle::cross(vector_of<Number>(box.axes[(k + 1) % 3]), vector_of<Number>(box.axes[(k + 2) % 3]));
            const Number projected_radius =
                abs(oracle::dot(n, vector_of<Number>(box.axes[k]))) * Number(double(box.half_extents[k]));
            Number at[3];
            for (std::size_t i = 0; i < 3; ++i)
                at[i] = oracle::dot(n, oracle::minus(vector_of<Number>(triangle[i]), vector_of<Number>(box.center)));
            const Number u = at[1] - at[0], v = at[2] - at[0], zero(0.0);
            rows.push_back({{u, v, zero}, Number(projected_radius + at[0])});
            rows.push_back({{Number(-u), Number(-v), zero}, Number(projected_radius - at[0])});
        }
        return rows;
    };
    if (const auto proof = oracle::proven_feasible<oracle::Rational>(rows_of)) return *proof;
    std::vector<oracle::Inequality> system;
    for (const auto& row : rows_of.template operator()<oracle::Rational>())
        system.push_back({row.normal[0], row.normal[1], row.normal[2], row.offset});
    return oracle::is_feasible(system);
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
               oracle::quick::meets(frustum, triangle[0], triangle[1], triangle[2]),
           "a view and a triangle");
}

void check_point_and_half_space(fuzz::Shapes& in) {
    const Obb box = in.box();
    const glm::dvec3 p = in.point_of(box) + in.nudge();
    Obb point;
    point.center = p;
    demand(contains(box, p) == oracle::boxes_meet(box, point), "a point in a box");
    Plane plane;
    plane.normal = in.direction();
    plane.offset = in.flag() ? -glm::dot(plane.normal, p) : in.coordinate();
    Frustum half_space;
    half_space.planes[0] = plane;
    half_space.plane_count = 1;
    demand(collide::intersects(box, plane) == !oracle::quick::is_rejected_by_a_plane(half_space, box), "a half-space");
}

}  // namespace

CROFTON_FUZZ(in) {
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
}
