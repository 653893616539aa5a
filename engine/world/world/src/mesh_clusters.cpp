// SPDX-License-Identifier: MIT
#include "mesh_clusters.hpp"

#include <algorithm>
#include <utility>

#include "require_ok.hpp"

namespace crofton::world {

Result<MeshClusters::Mesh> MeshClusters::cut(const TriangleMesh& triangles, const MeshDescription& description) {
    if (!description.clusters) return Mesh{};
    if (description.precut != nullptr) {
        Mesh given{*description.precut, 0, true, description.one_sided, true};
        if (!lend(given, triangles))
            return fail(ErrorCode::invalid_argument, kNoItem,
                        "mesh: `precut` is of another mesh; pass the clusters of this one, or nullptr");
        return given;
    }
    auto cut = depth::ClusteredMesh::cut(triangles.positions, triangles.indices);
    if (!cut) return cut.error();
    return Mesh{std::move(*cut), 0, true, description.one_sided, true};
}

Result<void> MeshClusters::lend(Mesh& cut, const TriangleMesh& triangles) {
    if (!cut.usable) return {};
    const auto order = cut.cut.triangle_order().empty() ? depth::IndexOrder::permuted : depth::IndexOrder::original;
    return cut.cut.lend(triangles.positions, triangles.indices, order);
}

void MeshClusters::set(scene::MeshId mesh, Mesh cut, const scene::Scene& scene) {
    if (!cut.wanted) return clear(mesh);
    if (mesh >= meshes_.size()) meshes_.resize(mesh + std::size_t{1});
    meshes_[mesh] = std::move(cut);
    meshes_[mesh].revision = scene.mesh_revision(mesh);
    require_ok(lend(meshes_[mesh], scene.mesh(mesh)));
}

void MeshClusters::keep_copy(scene::MeshId mesh) {
    if (mesh >= meshes_.size() || !meshes_[mesh].wanted) return;
    noted_.push_back(mesh);
    meshes_[mesh].cut.keep_copy();
}

void MeshClusters::clear(scene::MeshId mesh) {
    if (mesh < meshes_.size()) meshes_[mesh] = {};
}

MeshClusters::Mesh MeshClusters::take(scene::MeshId mesh) {
    return mesh < meshes_.size() ? std::exchange(meshes_[mesh], Mesh()) : Mesh();
}

bool MeshClusters::update(const scene::Scene& scene, Executor& executor) {
    deformed_.clear();
    std::sort(noted_.begin(), noted_.end());
    for (const scene::MeshId id : noted_) {
        Mesh& mesh = meshes_[id];
        if (!mesh.wanted || scene.is_mesh_removed(id) || mesh.revision == scene.mesh_revision(id)) continue;
        mesh.revision = scene.mesh_revision(id);
        deformed_.push_back(id);
    }
    noted_.clear();
    executor.parallel_for(deformed_.size(), 1, [&](std::size_t begin, std::size_t end, unsigned) {
        for (std::size_t i = begin; i < end; ++i) {
            Mesh& mesh = meshes_[deformed_[i]];
            const TriangleMesh& triangles = scene.mesh(deformed_[i]);
            mesh.usable = mesh.cut.refit_lent(triangles.positions, triangles.indices).has_value();
        }
    });
    return !deformed_.empty();
}

}  // namespace crofton::world
