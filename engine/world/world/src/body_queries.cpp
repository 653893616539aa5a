// SPDX-License-Identifier: MIT
// Any body against all objects.
#include <algorithm>
#include <cmath>
#include <crofton/convex/query.hpp>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>

#include "world_state.hpp"

namespace crofton {
namespace {

// Around a body, and some more.
Aabb bounds_of(const convex::Body& body, const RigidTransform& pose) {
    const glm::dvec3 half = body.bounds().half_extents();
    glm::dvec3 half_size(0.0);
    for (int k = 0; k < 3; ++k) half_size += half[k] * glm::abs(pose.rotation[k]);
    const glm::dvec3 offset = body.bounds().center();
    const glm::dvec3 center = pose.rotation * offset + pose.translation;
    // The centre's sums round by 2^-53 of their parts, which may cancel.
    const double parts = std::abs(offset.x) + std::abs(offset.y) + std::abs(offset.z);
    half_size = half_size * (1.0 + 1e-9) + 1e-12 * glm::abs(center) + 1e-14 * (parts + glm::abs(pose.translation));
    return {center - half_size, center + half_size};
}

// All that the body passes in the time: a sphere around its pivot, or the box at both ends.
Aabb swept_bounds(const convex::Body& body, const RigidTransform& pose, const convex::Motion& motion, double time,
                  double tolerance) {
    Aabb bounds = bounds_of(body, pose);
    if (motion.spin != glm::dvec3(0.0)) {
        const glm::dvec3 pivot = pose.rotation * motion.pivot + pose.translation;
        const double half_size =
            glm::length(body.bounds().half_extents()) + glm::length(body.bounds().center() - motion.pivot);
        bounds = {pivot - half_size * (1.0 + 1e-5), pivot + half_size * (1.0 + 1e-5)};
    }
    const glm::dvec3 way = time * motion.velocity;
    bounds.include(Aabb{bounds.min + way, bounds.max + way});
    const glm::dvec3 margin = tolerance + 1e-9 * (glm::abs(bounds.min) + glm::abs(bounds.max));
    return {bounds.min - margin, bounds.max + margin};
}

Result<void> check(const convex::Body& shape, const RigidTransform& pose) {
    if (!shape.is_bounded())
        return fail(ErrorCode::unsupported, kNoItem, "world: a half-space meets nearly all; ask with a bounded body");
    return convex::validate_pose(pose);
}

}  // namespace

World::State::QueryShape World::State::query_shape_of(std::uint32_t id) const {
    const world::Object& object = table.objects[id];
    const Obb& box = index.box(id);
    if (object_bodies.has(id)) return {object_bodies.body(id), object_bodies.pose_of(id, object, box, scene)};
    if (object.kind == BoundKind::sphere)
        return {*convex::Body::sphere(std::min(object.radius, static_cast<double>(convex::kMaxExtent))),
                RigidTransform{glm::dmat3(1.0), box.center}};
    QueryShape stand{*convex::Body::box(glm::min(box.half_extents, glm::vec3(convex::kMaxExtent))), std::nullopt};
    stand.pose = RigidTransform{glm::dmat3(box.axes), box.center};
    glm::dmat3& axes = stand.pose->rotation;
    if (glm::determinant(axes) < 0.0) axes[2] = -axes[2];  // the same box
    if (convex::validate_pose(*stand.pose)) return stand;
    // Axes that are farther from a rotation than poses may be: the box along the nearest axes around it.
    axes[0] = glm::normalize(axes[0]);
    axes[1] = glm::normalize(axes[1] - glm::dot(axes[0], axes[1]) * axes[0]);
    axes[2] = glm::cross(axes[0], axes[1]);
    glm::vec3 half(0.0f);
    for (int k = 0; k < 3; ++k) {
        double along = 0.0;
        for (int j = 0; j < 3; ++j)
            along += static_cast<double>(box.half_extents[j]) * std::abs(glm::dot(axes[k], glm::dvec3(box.axes[j])));
        half[k] = static_cast<float>(std::min(along * (1.0 + 0x1p-22), static_cast<double>(convex::kMaxExtent)));
    }
    stand.body = *convex::Body::box(half);
    return stand;
}

void World::overlap(const convex::Body& shape, const RigidTransform& pose, Vector<ObjectRef>& found,
                    std::uint32_t layers) const {
    found.clear();
    if (!check(shape, pose)) return;
    const State& s = *state_;
    s.visit_near(bounds_of(shape, pose), 0.0, layers, [&](std::uint32_t id) {
        const State::QueryShape stand = s.query_shape_of(id);
        if (stand.pose && convex::intersects({shape, pose}, {stand.body, *stand.pose}))
            found.push_back(s.table.ref(id));
        return 0.0;
    });
    std::sort(found.begin(), found.end(),
              [](const ObjectRef& a, const ObjectRef& b) { return a.object.index < b.object.index; });
}

std::optional<ClosestObject> World::closest(const convex::Body& shape, const RigidTransform& pose, double max_distance,
                                            std::uint32_t layers) const {
    if (!check(shape, pose)) return std::nullopt;
    const State& s = *state_;
    return s.closest(bounds_of(shape, pose), max_distance, layers, [&](std::uint32_t id) {
        const State::QueryShape stand = s.query_shape_of(id);
        if (!stand.pose) return collide::Distance{std::numeric_limits<double>::infinity(), {}, {}};
        const convex::Distance gap = convex::distance({shape, pose}, {stand.body, *stand.pose});
        return collide::Distance{gap.distance, gap.on_a, gap.on_b};
    });
}

Result<std::optional<BodyHit>> World::cast(const convex::Body& shape, const RigidTransform& pose,
                                           const convex::Motion& motion, const convex::CastOptions& options,
                                           std::uint32_t layers) const {
    if (auto good = check(shape, pose); !good) return tl::unexpected(good.error());
    // Bad motions and options are told also where nothing is near.
    static const convex::Body kPoint = *convex::Body::sphere(0.0);
    const RigidTransform far{glm::dmat3(1.0), glm::dvec3(1e15)};
    if (auto good = convex::cast({shape, pose}, motion, {kPoint, far}, {}, options); !good)
        return tl::unexpected(good.error());
    const State& s = *state_;
    std::optional<BodyHit> first;
    convex::CastOptions rest = options;
    const Aabb swept = swept_bounds(shape, pose, motion, options.duration, options.tolerance);
    s.visit_near(swept, 0.0, layers, [&](std::uint32_t id) {
        const State::QueryShape stand = s.query_shape_of(id);
        if (!stand.pose) return 0.0;
        const auto impact = convex::cast({shape, pose}, motion, {stand.body, *stand.pose}, {}, rest);
        if (!impact || impact->result == convex::CastResult::miss) return 0.0;
        if (first && (impact->time > first->time || (impact->time == first->time && id > first->object.index)))
            return 0.0;
        first = BodyHit{s.table.handle(id),
                        s.table.names.users[id],
                        impact->time,
                        impact->normal,
                        impact->on_b,
                        impact->part_b.triangle,
                        impact->result == convex::CastResult::hit,
                        impact->distance};
        rest.early_out = impact->time;
        return 0.0;
    });
    return first;
}

}  // namespace crofton
