// SPDX-License-Identifier: MIT
#include "mesh_clusters.hpp"

#include <glm/common.hpp>
#include <utility>

namespace crofton::world {

namespace {

// Whether the clusters have this mesh's triangles, as far as their number and the largest coordinates tell.
bool fits(const depth::ClusteredMesh& cut, const TriangleMesh& mesh) {
    if (cut.triangle_count() != mesh.triangle_count()) return false;
    glm::vec3 largest(0.0f);
    for (const std::uint32_t i : mesh.indices) largest = (glm::max)(largest, glm::abs(mesh.positions[i]));
    return largest == cut.largest();
}

}  // namespace

Result<MeshClusters::Mesh> MeshClusters::cut(const TriangleMesh& triangles, const MeshDescription& description) {
    if (!description.clusters) return Mesh{};
    if (description.precut != nullptr) {
        if (!fits(*description.precut, triangles))
            return fail(ErrorCode::invalid_argument, kNoItem,
                        "mesh: `precut` is of another mesh; pass the clusters of this one, or nullptr");
        return Mesh{*description.precut, 0, true, description.one_sided, true};
    }
    auto cut = depth::ClusteredMesh::cut(triangles.positions, triangles.indices);
    if (!cut) return cut.error();
    return Mesh{std::move(*cut), 0, true, description.one_sided, true};
}

void MeshClusters::set(scene::MeshId mesh, Mesh cut, std::uint64_t revision) {
    if (!cut.wanted) return clear(mesh);
    if (mesh >= meshes_.size()) meshes_.resize(mesh + std::size_t{1});
    meshes_[mesh] = std::move(cut);
    meshes_[mesh].revision = revision;
}

void MeshClusters::clear(scene::MeshId mesh) {
    if (mesh < meshes_.size()) meshes_[mesh] = {};
}

MeshClusters::Mesh MeshClusters::take(scene::MeshId mesh) {
    return mesh < meshes_.size() ? std::exchange(meshes_[mesh], Mesh()) : Mesh();
}

bool MeshClusters::update(const scene::Scene& scene) {
    bool changed = false;
    for (scene::MeshId id = 0; id < meshes_.size(); ++id) {
        Mesh& mesh = meshes_[id];
        if (!mesh.wanted || scene.is_mesh_removed(id) || mesh.revision == scene.mesh_revision(id)) continue;
        mesh.revision = scene.mesh_revision(id);
        auto cut = depth::ClusteredMesh::cut(scene.mesh(id).positions, scene.mesh(id).indices);
        mesh.usable = cut.has_value();
        if (cut) mesh.cut = std::move(*cut);
        changed = true;
    }
    return changed;
}

}  // namespace crofton::world
