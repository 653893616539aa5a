// SPDX-License-Identifier: MIT
// Two convex shapes that nearly touch: yes or no against exact integers; distances, depths and contacts by what was
// proven of them.
#include <crofton/convex/query.hpp>
#include <oracle/exact_convex.hpp>

#include "convex_shapes.hpp"

namespace {

using namespace crofton;
using namespace crofton::convex;
using fuzz::demand;

// What the oracle knows. Spheres and capsules without a radius are polytopes, too, of one and two corners.
bool has_triangles(const Shape& shape) {
    return shape.is_polytope() &&
           (shape.kind() == Kind::box || shape.kind() == Kind::triangle || shape.hull() != nullptr);
}

void check_meeting(const ShapeAtPose& a, const ShapeAtPose& b, double size, PairCache& cache) {
    const bool meet = intersects(a, b);
    const Distance d = distance(a, b);
    const Penetration p = penetration(a, b);
    demand(d.lower <= d.upper && d.lower <= d.distance && d.distance <= d.upper, "bounds of a distance");
    demand(p.lower <= p.upper, "bounds of a depth");
    // For round shapes either answer is right if the gap or overlap is little more than rounding.
    const bool exact = has_triangles(a.shape) && has_triangles(b.shape);
    const bool is_clear = exact || d.distance > 1e-7 * size || p.depth > 1e-7 * size;
    if (is_clear) {
        demand(intersects(b, a) == meet, "meeting is symmetric");
        demand((d.distance == 0.0) == meet, "a distance of 0");
        demand(p.overlapping == meet, "a depth of shapes that meet");
        demand(intersects(a, b, &cache) == meet, "the answer of a pair that remembers");
    }
    if (exact) {
        // No common point is guessed: by exact faces alone a flat hull has points outside of it.
        demand(meet == oracle::meet_quickly(a, b, {d.normal}, {}), "two polytopes meet");
        demand(d.upper - d.lower <= 1e-9 * size, "a distance that is not proven well enough");
        demand(p.upper - p.lower <= 1e-9 * size, "a depth that is not proven well enough");
    }
    const Manifold m = contact_manifold(a, b, {}, &cache);
    demand(m.count >= 0 && m.count <= 4, "how many points of contact");
    if (is_clear) demand((m.count > 0) == meet, "points of contact");
    for (int i = 0; i < m.count; ++i)
        demand(std::isfinite(glm::dot(m.points[i].position, glm::dvec3(1.0))) &&
                   m.points[i].depth <= m.depth + 1e-6 * size,
               "the deepest point");
}

}  // namespace

CROFTON_FUZZ(in) {
    fuzz::ConvexShapes shapes(in);
    const Shape a = shapes.shape(), b = shapes.shape();
    const RigidTransform pose_a = in.pose();
    RigidTransform pose_b = shapes.touching(a, pose_a, b);
    PairCache cache;
    for (int frame = 0; frame < 3 && (frame == 0 || in.more()); ++frame) {
        const double extent = a.core_radius() + b.core_radius() + a.radius() + b.radius() +
                              glm::length(pose_b.translation - pose_a.translation);
        check_meeting({a, pose_a}, {b, pose_b}, extent, cache);
        pose_b.translation += in.nudge();
    }
}
