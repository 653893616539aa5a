// SPDX-License-Identifier: MIT
#include "mesh_clusters.hpp"

#include <utility>

namespace crofton::world {

Result<void> MeshClusters::set(scene::MeshId mesh, const TriangleMesh& triangles, bool one_sided) {
    auto cut = depth::ClusteredMesh::cut(triangles.positions, triangles.indices);
    if (!cut) return tl::unexpected(cut.error());
    // Revision 0 is no mesh's: update() looks at it once more, and finds it as it is.
    set(mesh, {std::move(*cut), 0, true, one_sided, true});
    return {};
}

void MeshClusters::set(scene::MeshId mesh, Mesh cut) {
    if (mesh >= meshes_.size()) meshes_.resize(mesh + std::size_t{1});
    meshes_[mesh] = std::move(cut);
}

void MeshClusters::clear(scene::MeshId mesh) {
    if (mesh < meshes_.size()) meshes_[mesh] = {};
}

void MeshClusters::update(const scene::Scene& scene) {
    for (scene::MeshId id = 0; id < meshes_.size(); ++id) {
        Mesh& mesh = meshes_[id];
        if (!mesh.wanted || scene.is_mesh_removed(id)) continue;
        const std::uint64_t revision = scene.mesh_revision(id);
        if (mesh.revision == revision) continue;
        const bool is_new = std::exchange(mesh.revision, revision) == 0;
        if (is_new && mesh.usable) continue;
        auto cut = depth::ClusteredMesh::cut(scene.mesh(id).positions, scene.mesh(id).indices);
        mesh.usable = cut.has_value();
        if (cut) mesh.cut = std::move(*cut);
    }
}

}  // namespace crofton::world
