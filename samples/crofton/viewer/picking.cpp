// SPDX-License-Identifier: MIT
#include "picking.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "pipeline/pipeline.hpp"

namespace crofton::viewer {
namespace {

Ray ray_through(const Camera& camera, const glm::dvec2& cursor) {
    const glm::dmat3 to_world = glm::transpose(world_to_view_rotation(camera));
    if (camera.projection == Projection::orthographic) {
        const double half = 0.5 * camera.height;
        return {camera.position + to_world * glm::dvec3(cursor.x * half * camera.aspect, cursor.y * half, 0.0),
                -to_world[2]};
    }
    const double half = std::tan(0.5 * camera.fov_y);
    return {camera.position,
            glm::normalize(to_world * glm::dvec3(cursor.x * half * camera.aspect, cursor.y * half, -1.0))};
}

}  // namespace

std::optional<Pick> pick(const World& world, InstanceShapes& shapes, std::span<const scene::InstanceId> candidates,
                         const Camera& camera, const glm::dvec2& cursor) {
    Ray ray = ray_through(camera, cursor);
    Vector<ObjectHit> hits;  // of bounds, the nearest first
    world.raycast_all(ray, hits, pipeline::kSeenLayer);
    std::optional<Pick> nearest;
    for (const ObjectHit& hit : hits) {
        if (nearest && hit.t > nearest->distance) break;
        const auto instance = static_cast<scene::InstanceId>(hit.user);
        if (!std::binary_search(candidates.begin(), candidates.end(), instance)) continue;
        const auto found = shapes.raycast(ray, instance);
        if (!found || (nearest && found->t >= nearest->distance)) continue;
        nearest = Pick{instance, found->triangle, found->t, ray.origin + found->t * ray.direction};
    }
    return nearest;
}

}  // namespace crofton::viewer
