// SPDX-License-Identifier: MIT
#include "picking.hpp"

#include <cmath>
#include <crofton/mesh/mesh_query.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

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

std::optional<Pick> pick(const scene::Scene& scene, std::span<const scene::InstanceId> candidates, const Camera& camera,
                         const glm::dvec2& cursor) {
    Ray ray = ray_through(camera, cursor);
    std::optional<Pick> best;
    for (const scene::InstanceId instance : candidates) {
        if (!mesh::raycast(ray, scene.world_boxes()[instance])) continue;
        const TriangleMesh& mesh = scene.mesh(scene.mesh_of(instance));
        const scene::Transform& world = scene.world(scene.node_of(instance));
        const auto point = [&](std::size_t i) {
            return world.linear * glm::dvec3(mesh.positions[mesh.indices[i]]) + world.translation;
        };
        for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
            const auto distance = mesh::raycast(ray, Triangle{point(t), point(t + 1), point(t + 2)});
            if (!distance || (best && *distance >= best->distance)) continue;
            best = {instance, static_cast<std::uint32_t>(t / 3), *distance, ray.origin + *distance * ray.direction};
            ray.max_t = *distance;
        }
    }
    return best;
}

}  // namespace crofton::viewer
