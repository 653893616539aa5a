// SPDX-License-Identifier: MIT
// Moving convex shapes: what a cast proves is looked at in many moments; and rays at meshes against every triangle.
#include <crofton/collide/narrow_phase.hpp>
#include <crofton/convex/query.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <oracle/impacts.hpp>

#include "convex_shapes.hpp"

namespace {

using namespace crofton;
using fuzz::demand;

convex::Motion motion(fuzz::Shapes& in) {
    convex::Motion motion;
    motion.velocity = in.below(4) ? in.grid_point() : glm::dvec3(0.0);
    if (in.flag()) motion.spin = 0.25 * in.direction();
    if (in.flag()) motion.pivot = glm::dvec3(in.grid());
    return motion;
}

void check_cast(fuzz::Shapes& in) {
    fuzz::ConvexShapes shapes(in);
    const convex::Shape a = shapes.shape(), b = shapes.shape();
    const RigidTransform pose_a = in.pose();
    RigidTransform pose_b = shapes.touching(a, pose_a, b);
    if (in.below(4) != 0) pose_b.translation += in.direction();
    const convex::Motion motion_a = motion(in), motion_b = motion(in);
    convex::CastOptions options;
    options.duration = 0.125 + in.byte() / 64.0;
    options.tolerance = std::ldexp(1.0, -4 - static_cast<int>(in.below(20)));
    options.max_steps = 60;
    const auto impact = convex::cast({a, pose_a}, motion_a, {b, pose_b}, motion_b, options);
    demand(impact.has_value(), "a cast");
    demand(impact->time >= 0.0 && impact->time <= options.duration, "the time of an impact");
    const double size = a.core_radius() + b.core_radius() + a.radius() + b.radius() + glm::length(pose_a.translation) +
                        glm::length(pose_b.translation) + 100.0;
    const auto at = [&](double time) {
        const RigidTransform now_a = convex::moved(pose_a, motion_a, time),
                             now_b = convex::moved(pose_b, motion_b, time);
        return convex::penetration({a, now_a}, {b, now_b}).lower;
    };
    if (impact->result != convex::CastResult::hit || impact->time > 0.0)
        for (int i = 0; i < 8; ++i)
            demand(at(impact->time * i / 8.0) <= 1e-7 * size, "shapes touch before the time of a cast");
    if (impact->result == convex::CastResult::miss)
        demand(impact->normal == glm::dvec3(0.0) && impact->distance == 0.0 && impact->time == options.duration,
               "the fields of a miss");
    if (impact->result != convex::CastResult::hit) return;
    const RigidTransform now_a = convex::moved(pose_a, motion_a, impact->time),
                         now_b = convex::moved(pose_b, motion_b, impact->time);
    const auto is_hard = [](const convex::Shape& shape) {
        return shape.kind() == convex::Kind::cylinder || shape.kind() == convex::Kind::cone;
    };
    const double rounding = is_hard(a) || is_hard(b) ? 1e-7 : 1e-9;
    demand(convex::distance({a, now_a}, {b, now_b}).lower <= options.tolerance + rounding * size,
           "shapes that have hit");
    demand(impact->distance < options.tolerance + rounding * size, "the distance of a hit");
    // If the shapes overlap, the depth is within 1e-5 of the size, and so are the deepest points.
    if (impact->distance > 0.0)
        demand(oracle::fault_of_contact({a, now_a}, {b, now_b}, *impact, rounding * size).empty(),
               "the points and the normal of a hit");
    else
        demand(impact->time > 0.0 ||
                   convex::penetration({a, now_a}, {b, now_b}).upper >= -impact->distance - rounding * size,
               "the depth of an overlap");
    options.ignore_initial_overlaps = true;
    const auto later = convex::cast({a, pose_a}, motion_a, {b, pose_b}, motion_b, options);
    demand(later.has_value() && (later->result == convex::CastResult::miss || later->time > 0.0),
           "a cast that leaves out what overlaps from the start");
}

Triangle triangle_of(const TriangleMesh& mesh, std::uint32_t t) {
    const auto corner = [&](std::uint32_t v) { return glm::dvec3(mesh.positions[mesh.indices[3 * t + v]]); };
    return {corner(0), corner(1), corner(2)};
}

void check_rays(fuzz::Shapes& in) {
    const TriangleMesh triangles = in.flag() ? in.solid() : in.mesh(12, 24);
    const auto mesh = mesh::MeshTree::build(triangles, {.rays = in.flag()});
    demand(mesh.has_value(), "a mesh");
    for (int i = 0; i < 6; ++i) {
        const auto corner = [&] {
            return glm::dvec3(triangles.positions[triangles.indices[in.byte() % triangles.indices.size()]]);
        };
        const glm::dvec3 p = corner(), q = corner();
        const Ray ray = in.flag() ? in.ray_through(p) : in.ray_through(0.5 * (p + q));
        std::optional<mesh::TriangleHit> first;
        for (std::uint32_t t = 0; t < triangles.triangle_count(); ++t) {
            if (const auto at = mesh::raycast(ray, triangle_of(triangles, t)); at && (!first || *at < first->t))
                first = {*at, t};
        }
        const auto hit = mesh::raycast(ray, *mesh);
        demand(hit.has_value() == first.has_value() && mesh::hits_any(ray, *mesh) == first.has_value(), "a ray hits");
        if (hit) demand(hit->t == first->t && hit->triangle == first->triangle, "the first triangle on a ray");
    }
}

}  // namespace

CROFTON_FUZZ(in) {
    if (in.below(4) < 3)
        check_cast(in);
    else
        check_rays(in);
}
