// SPDX-License-Identifier: MIT
// A scene's instances as one mesh around an origin of its own.
#include <crofton/bake/checksum.hpp>
#include <crofton/core/recovery.hpp>
#include <crofton/pvs/pvs.hpp>
#include <glm/geometric.hpp>

namespace crofton::pvs {
namespace {

void append(BakeGeometry& geometry, const scene::Scene& scene, scene::InstanceId id) {
    const TriangleMesh& mesh = scene.mesh(scene.mesh_of(id));
    const Transform& world = scene.world(scene.node_of(id));
    const bool mirrored = glm::dot(world.linear[0], glm::cross(world.linear[1], world.linear[2])) < 0.0;
    const auto first = static_cast<std::uint32_t>(geometry.mesh.positions.size());
    for (const glm::vec3& p : mesh.positions)
        geometry.mesh.positions.push_back(glm::vec3(world * glm::dvec3(p) - geometry.origin));
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        for (std::size_t k = 0; k < 3; ++k)
            geometry.mesh.indices.push_back(first + mesh.indices[i + (mirrored ? 2 - k : k)]);
        geometry.object_of.push_back(id);
    }
}

}  // namespace

Result<BakeGeometry> geometry_of(const scene::Scene& scene, std::span<const scene::InstanceId> moving) {
    return crofton::detail::recover([&]() -> Result<BakeGeometry> {
        Vector<std::uint8_t> rests(scene.instance_count(), 1);
        for (const scene::InstanceId id : moving)
            if (id < rests.size()) rests[id] = 0;
        BakeGeometry geometry;
        Aabb bounds;
        std::uint64_t vertices = 0;
        for (scene::InstanceId id = 0; id < rests.size(); ++id) {
            if (scene.is_removed(id) || scene.layer_masks()[id] == 0 || scene.mesh(scene.mesh_of(id)).indices.empty())
                rests[id] = 0;
            geometry.boxes.push_back(scene.world_boxes()[id]);
            if (!rests[id]) continue;
            bounds.include(aabb_of(geometry.boxes[id]));
            vertices += scene.mesh(scene.mesh_of(id)).positions.size();
        }
        if (vertices > 0xffffffffu)
            return fail(ErrorCode::out_of_range, kNoItem, "pvs: the instances have more than 2^32 - 1 vertices");
        if (!bounds.is_empty()) geometry.origin = bounds.center();
        for (scene::InstanceId id = 0; id < rests.size(); ++id)
            if (rests[id]) append(geometry, scene, id);
        if (geometry.object_of.empty())
            return fail(ErrorCode::empty, kNoItem, "pvs: no object rests: there is nothing to be seen");
        return geometry;
    });
}

std::uint64_t fingerprint_of(const BakeGeometry& geometry) {
    const auto sum = [](const auto& elements) { return bake::checksum(std::as_bytes(std::span(elements))); };
    const std::uint64_t sums[] = {sum(geometry.mesh.positions), sum(geometry.mesh.indices), sum(geometry.object_of),
                                  sum(std::span(&geometry.origin, 1))};
    return bake::checksum(std::as_bytes(std::span(sums)));
}

}  // namespace crofton::pvs
