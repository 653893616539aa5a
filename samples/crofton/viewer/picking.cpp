// SPDX-License-Identifier: MIT
#include "picking.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <map>
#include <utility>

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

// Picks the nearest instance whose triangles the ray meets, among the hits of bounds, which come in order.
template <class InstanceOf, class Raycast>
std::optional<Pick> nearest_of(std::span<const ObjectHit> hits, std::span<const scene::InstanceId> candidates,
                               const Ray& ray, InstanceOf instance_of, Raycast raycast) {
    std::optional<Pick> nearest;
    for (const ObjectHit& hit : hits) {
        if (nearest && hit.t > nearest->distance) break;
        const scene::InstanceId instance = instance_of(hit);
        if (!std::binary_search(candidates.begin(), candidates.end(), instance)) continue;
        const std::optional<mesh::TriangleHit> found = raycast(instance);
        if (!found || (nearest && found->t >= nearest->distance)) continue;
        nearest = Pick{instance, found->triangle, found->t, ray.origin + found->t * ray.direction};
    }
    return nearest;
}

}  // namespace

std::optional<Pick> pick(const World& world, InstanceShapes& shapes, std::span<const scene::InstanceId> candidates,
                         const Camera& camera, const glm::dvec2& cursor) {
    const Ray ray = ray_through(camera, cursor);
    Vector<ObjectHit> hits;
    world.raycast_all(ray, hits, {pipeline::kSeenLayer});
    return nearest_of(
        hits, candidates, ray, [](const ObjectHit& hit) { return static_cast<scene::InstanceId>(hit.user); },
        [&](scene::InstanceId instance) { return shapes.raycast(ray, instance); });
}

std::optional<Pick> pick(const pipeline::RegionPipeline& regions, std::span<const scene::InstanceId> candidates,
                         const Camera& camera, const glm::dvec2& cursor) {
    const Ray ray = ray_through(camera, cursor);
    Vector<ObjectHit> hits;
    regions.stream().world().raycast_all(ray, hits);
    const auto drawables = regions.drawables();
    std::map<scene::MeshId, std::optional<mesh::MeshTree>> trees;  // meshes come and go with regions: of this click
    return nearest_of(
        hits, candidates, ray, [&](const ObjectHit& hit) { return regions.instance_of(hit.object); },
        [&](scene::InstanceId instance) -> std::optional<mesh::TriangleHit> {
            const auto [entry, is_new] = trees.try_emplace(drawables->mesh_of(instance));
            if (is_new)
                if (auto tree = mesh::MeshTree::build(drawables->mesh(entry->first))) entry->second = std::move(*tree);
            if (!entry->second) return std::nullopt;
            return raycast_placed(ray, *entry->second, drawables->world_of(instance));
        });
}

}  // namespace crofton::viewer
