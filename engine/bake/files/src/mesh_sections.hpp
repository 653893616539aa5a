// SPDX-License-Identifier: MIT
// Properties of meshes besides their arrays: looks and clusters. Both are optional in a file.
#pragma once
#include <crofton/bake/baked_scene.hpp>
#include <crofton/bake/container.hpp>
#include <mutex>
#include <optional>
#include <span>

namespace crofton::bake {

// Section `looks`: a byte a mesh, of these bits.
[[nodiscard]] MeshLook look_of(std::uint8_t bits);
// Requires at most mesh_count looks.
void add_looks(std::span<const MeshLook> looks, std::size_t mesh_count, Writer& writer);
// Empty where the file has none. Errors: not one a mesh; bits that are not known (item = mesh).
[[nodiscard]] Result<std::span<const std::uint8_t>> read_looks(const Reader& reader, std::size_t mesh_count);

// The clusters of a scene's meshes as files have them, each cut when it is first asked for. Any thread.
class SharedClusters {
  public:
    explicit SharedClusters(std::size_t mesh_count) : once_(mesh_count), serialised_(mesh_count) {}
    // Returns nothing for a mesh that cannot be cut.
    [[nodiscard]] const Vector<std::byte>& of(scene::MeshId mesh, const TriangleMesh& triangles);

  private:
    Vector<std::once_flag> once_;
    Vector<Vector<std::byte>> serialised_;
};

// Clusters of another scene, of which this one has some meshes.
struct KnownClusters {
    SharedClusters* shared = nullptr;          // nullptr: each mesh is cut
    std::span<const scene::MeshId> mesh_of{};  // by this scene's mesh: that of the other
};

// Section `clusters`: ClusteredMesh::serialise of one mesh after another, in words of 4 bytes; `cluends`: where each
// ends. Nothing for a mesh that cannot be cut.
void add_clusters(const scene::Scene& scene, const KnownClusters& known, Writer& writer, Executor& executor);
// Empty where the file has none. Errors: clusters of another version (unsupported); as ClusteredMesh::deserialise; ends
// that do not ascend to the section's; other triangle counts than the meshes' (item = mesh).
[[nodiscard]] Result<Vector<std::optional<depth::ClusteredMesh>>> read_clusters(const Reader& reader,
                                                                                std::span<const MeshRecord> meshes);

// As bake::bake().
[[nodiscard]] Result<Vector<std::byte>> bake(const scene::Scene& scene, Executor& executor, const BakeOptions& options,
                                             const KnownClusters& known);

}  // namespace crofton::bake
