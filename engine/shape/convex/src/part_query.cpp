// SPDX-License-Identifier: MIT
#include "part_query.hpp"

#include <algorithm>
#include <limits>

#include "body_maker.hpp"
#include "core_query.hpp"
#include "pair.hpp"
#include "triangle_touch.hpp"

namespace crofton::convex {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Bodies of parts and a body this near to them, or nearer, may be told to meet: `Pair::doubt` of any pair of parts. An
// offset between parts is at most twice as large as the size here.
double doubt_of_parts(const BodyAtPose& a, const BodyAtPose& b) {
    const auto has_corners = [](const Body& body) {
        return body.has_polytope_core() || body.kind() == Kind::mesh || body.kind() == Kind::height_field;
    };
    const double size =
        a.body.core_radius() + b.body.core_radius() + glm::length(b.pose.translation - a.pose.translation);
    return 4.0 * (has_corners(a.body) && has_corners(b.body) ? kRoundedDoubt : kRoundDoubt) * size;
}

// Improves `best` by the distances of a's parts from b, nearest first.
void search_nearest(const BodyAtPose& a, const BodyAtPose& b, Distance& best, double& lower) {
    const double doubt = doubt_of_parts(a, b);
    double limit = std::max(best.distance, doubt);
    const auto visit = [&](const Part& part) {
        const BodyAtPose placed{part.body, part.pose};
        Distance d;
        if (b.body.is_convex()) {
            d = near_distance(placed, b, limit);
        } else {
            // The other's nearest part is asked for within the same limit.
            Distance inner;
            inner.distance = limit;
            double inner_lower = kInfinity;
            search_nearest(b, placed, inner, inner_lower);
            d = flipped(inner);
            d.lower = std::min(inner_lower, limit);
        }
        lower = std::min(lower, d.lower);
        if (d.distance < best.distance) {
            best = d;
            best.part_a = part.id;
            limit = std::max(d.distance, doubt);
        }
        return best.distance == 0.0;
    };
    if (is_unbounded(b))
        visit_parts(a, {}, kEverything, visit);
    else
        visit_nearest_parts(a, box_around(b, a.pose), limit, visit);
}

}  // namespace

bool visit_parts_near(const BodyAtPose& a, const BodyAtPose& b, double margin, PartVisitor visit) {
    if (is_unbounded(b)) return visit_parts(a, {}, kEverything, visit);
    return visit_parts(a, box_around(b, a.pose), margin + doubt_of_parts(a, b), visit);
}

bool visit_parts_near(const BodyAtPose& a, const BodyAtPose& b, double margin, PartVisitor convex,
                      TriangleVisitor triangle) {
    if (is_unbounded(b)) return visit_parts(a, {}, kEverything, convex, triangle);
    return visit_parts(a, box_around(b, a.pose), margin + doubt_of_parts(a, b), convex, triangle);
}

// Most triangles near a sphere or a capsule are told in closed form.
bool parts_meet(const BodyAtPose& a, const BodyAtPose& b) {
    const auto visit = [&](const Part& part) { return intersects({part.body, part.pose}, b); };
    if (b.body.kind() != Kind::sphere && b.body.kind() != Kind::capsule) return visit_parts_near(a, b, 0.0, visit);
    return visit_parts_near(a, b, 0.0, visit, [&](const PartSearch& of, const Triangle& corners, std::uint32_t) {
        const glm::dvec3& origin = of.pose.translation;
        Touch touch;
        const Warm warm =
            SegmentTouch(b, origin, of.body->core_radius(), 0.0).ask(placed_triangle(corners, of.pose, origin), touch);
        if (warm != Warm::unknown) return warm == Warm::touching;
        return intersects({BodyMaker::triangle(corners), of.pose}, b);
    });
}

Distance distance_of_parts(const BodyAtPose& a, const BodyAtPose& b) {
    Distance best;
    best.distance = kInfinity;
    double lower = kInfinity;
    search_nearest(a, b, best, lower);
    if (!(best.distance < kInfinity)) return {};  // a pose with NaN
    best.lower = std::min(lower, best.distance);
    return best;
}

Penetration penetration_of_parts(const BodyAtPose& a, const BodyAtPose& b) {
    Penetration deepest;
    visit_parts_near(a, b, 0.0, [&](const Part& part) {
        const Penetration p = penetration({part.body, part.pose}, b);
        if (p.overlapping && (!deepest.overlapping || p.depth > deepest.depth)) {
            const double lower = std::max(deepest.lower, p.lower);
            deepest = p;
            deepest.part_a = part.id;
            deepest.lower = lower;
        }
        return false;
    });
    if (deepest.overlapping) deepest.upper = kInfinity;
    return deepest;
}

void parts_near(const BodyAtPose& body, const BodyAtPose& other, double margin, Vector<Part>& parts) {
    parts.clear();
    if (body.body.is_convex()) return parts.push_back({body.body, body.pose, {}, Sides::both});
    visit_parts_near(body, other, margin, [&](const Part& part) {
        parts.push_back(part);
        return false;
    });
}

}  // namespace crofton::convex
