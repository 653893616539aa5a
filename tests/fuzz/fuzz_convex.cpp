// SPDX-License-Identifier: MIT
// Two convex bodies that nearly touch: yes or no against exact integers; distances, depths and contacts by what was
// proven of them.
#include <crofton/convex/query.hpp>
#include <oracle/exact_convex.hpp>

#include "bodies.hpp"

namespace {

using namespace crofton;
using namespace crofton::convex;
using fuzz::demand;

void check_meeting(const Placed& a, const Placed& b, double size, PairCache& cache) {
    const bool meet = intersects(a, b);
    demand(intersects(b, a) == meet, "meeting is symmetric");
    const Distance d = distance(a, b);
    demand((d.distance == 0.0) == meet, "a distance of 0");
    demand(d.lower <= d.upper && d.lower <= d.distance && d.distance <= d.upper, "bounds of a distance");
    const Penetration p = penetration(a, b);
    demand(p.overlapping == meet && p.lower <= p.upper, "bounds of a depth");
    demand(intersects(a, b, &cache) == meet, "the answer of a pair that remembers");
    if (a.body.is_polytope() && b.body.is_polytope()) {
        const RigidTransform near_a{a.pose.rotation, glm::dvec3(0.0)};
        const RigidTransform near_b{b.pose.rotation, b.pose.translation - a.pose.translation};
        const Penetration guess = penetration({a.body, near_a}, {b.body, near_b});
        demand(meet == oracle::meet(oracle::exact_polytope(a), oracle::exact_polytope(b), {d.normal},
                                    a.pose.translation, {0.5 * (guess.on_a + guess.on_b)}),
               "two polytopes meet");
        demand(d.upper - d.lower <= 1e-9 * size, "a distance that is not proven well enough");
        demand(p.upper - p.lower <= 1e-9 * size, "a depth that is not proven well enough");
    }
    const Manifold m = contact_manifold(a, b, {}, &cache);
    demand(meet ? m.count >= 1 && m.count <= 4 : m.count == 0, "points of contact");
    for (int i = 0; i < m.count; ++i)
        demand(std::isfinite(glm::dot(m.points[i].position, glm::dvec3(1.0))) &&
                   m.points[i].depth <= m.depth + 1e-6 * size,
               "the deepest point");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzz::Shapes in(data, size);
    fuzz::Bodies bodies(in);
    const Body a = bodies.body(), b = bodies.body();
    const RigidTransform pose_a = in.pose();
    RigidTransform pose_b = bodies.touching(a, pose_a, b);
    PairCache cache;
    for (int frame = 0; frame < 3; ++frame) {
        const double extent =
            a.reach() + b.reach() + a.radius() + b.radius() + glm::length(pose_b.translation - pose_a.translation);
        check_meeting({a, pose_a}, {b, pose_b}, extent, cache);
        pose_b.translation += in.nudge();
    }
    return 0;
}
