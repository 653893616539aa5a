// SPDX-License-Identifier: MIT
#include "mesh_clusters.hpp"

#include <utility>

namespace crofton::world {

Result<MeshClusters::Mesh> MeshClusters::cut(const TriangleMesh& triangles, const MeshDescription& description) {
    if (!description.clusters) return Mesh{};
    auto cut = depth::ClusteredMesh::cut(triangles.positions, triangles.indices);
    if (!cut) return tl::unexpected(cut.error());
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

void MeshClusters::update(const scene::Scene& scene) {
    for (scene::MeshId id = 0; id < meshes_.size(); ++id) {
        Mesh& mesh = meshes_[id];
        if (!mesh.wanted || scene.is_mesh_removed(id) || mesh.revision == scene.mesh_revision(id)) continue;
        mesh.revision = scene.mesh_revision(id);
        auto cut = depth::ClusteredMesh::cut(scene.mesh(id).positions, scene.mesh(id).indices);
        mesh.usable = cut.has_value();
        if (cut) mesh.cut = std::move(*cut);
    }
}

}  // namespace crofton::world
