// SPDX-License-Identifier: MIT
#include "assets/flat_scene.hpp"

#include <glm/geometric.hpp>

#include "assets/file.hpp"

namespace crofton::assets {

std::uint64_t instanced_triangles(const scene::Scene& scene) {
    std::uint64_t sum = 0;
    for (scene::InstanceId i = 0; i < scene.instance_count(); ++i)
        if (!scene.is_removed(i)) sum += scene.mesh(scene.mesh_of(i)).triangle_count();
    return sum;
}

Result<FlatScene> flat_scene(const SceneSource& source, const ReadLimits& limits) {
    const scene::Scene& scene = source.scene;
    if (instanced_triangles(scene) > limits.triangles)
        return in_file(source.name, "its instances have", over_limit("triangles", limits.triangles));
    FlatScene all;
    for (scene::InstanceId i = 0; i < scene.instance_count(); ++i) {
        if (scene.is_removed(i)) continue;
        const scene::MeshId id = scene.mesh_of(i);
        const TriangleMesh& mesh = scene.mesh(id);
        const bool glows = id < source.emission.size() && !source.emission[id].empty();
        const Transform& world = scene.world(scene.node_of(i));
        const bool mirrored = glm::dot(world.linear[0], glm::cross(world.linear[1], world.linear[2])) < 0.0;
        for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
            const auto vertex = [&](std::size_t k) { return mesh.indices[t + (mirrored ? 2 - k : k)]; };
            glm::vec3 p[3];
            for (std::size_t k = 0; k < 3; ++k) p[k] = glm::vec3(world * glm::dvec3(mesh.positions[vertex(k)]));
            const glm::dvec3 origin(p[0]);
            if (!(glm::length(glm::cross(glm::dvec3(p[1]) - origin, glm::dvec3(p[2]) - origin)) > 0.0)) continue;
            for (std::size_t k = 0; k < 3; ++k) {
                all.mesh.indices.push_back(static_cast<std::uint32_t>(all.mesh.positions.size()));
                all.mesh.positions.push_back(p[k]);
                all.mesh.colors.push_back(mesh.colors.empty() ? glm::vec3(0.6f) : mesh.colors[vertex(k)]);
            }
            all.emission.push_back(glows ? source.emission[id][t / 3] : glm::vec3(0.0f));
        }
    }
    return all;
}

}  // namespace crofton::assets
