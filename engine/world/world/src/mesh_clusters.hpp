// SPDX-License-Identifier: MIT
// The meshes that views list triangle by triangle.
#pragma once
#include <crofton/core/executor.hpp>
#include <crofton/depth/clustered_mesh.hpp>
#include <crofton/scene/scene.hpp>
#include <crofton/world/inputs.hpp>

namespace crofton::world {

class MeshClusters {
  public:
    struct Mesh {
        depth::ClusteredMesh cut;
        std::uint64_t revision = 0;  // of the scene's mesh that was cut
        bool wanted = false, one_sided = false;
        bool usable = false;  // false: not wanted, or what it deformed into cannot be cut
    };

    // Reads positions of these arrays, and of no others, from now on. Errors: as ClusteredMesh::lend.
    static Result<void> lend(Mesh& cut, const TriangleMesh& triangles);

    // As the description wants it. Errors: as ClusteredMesh::cut.
    [[nodiscard]] static Result<Mesh> cut(const TriangleMesh& triangles, const MeshDescription& description);

    // The mesh is new or another. Its arrays are read in place.
    void set(scene::MeshId mesh, Mesh cut, const scene::Scene& scene);
    void clear(scene::MeshId mesh);
    [[nodiscard]] Mesh take(scene::MeshId mesh);  // the mesh has none then
    // The mesh's positions are about to change: until the next update() views see it as it is.
    void keep_copy(scene::MeshId mesh);
    // Refits the clusters of meshes that have deformed since. Returns whether any has.
    bool update(const scene::Scene& scene, Executor& executor);

    [[nodiscard]] const Mesh* find(scene::MeshId mesh) const {
        return mesh < meshes_.size() && meshes_[mesh].usable ? &meshes_[mesh] : nullptr;
    }

  private:
    Vector<Mesh> meshes_;
    Vector<scene::MeshId> noted_;     // whose copies were kept since the last update
    Vector<scene::MeshId> deformed_;  // scratch
};

}  // namespace crofton::world
