// A static hierarchy of oriented boxes over the triangles of one mesh, sixteen boxes to a node, for collisions and
// rays.
#pragma once
#include <array>
#include <crofton/core/error.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/obb.hpp>
#include <crofton/geometry/triangle_mesh.hpp>
#include <crofton/mesh/mesh_layout.hpp>
#include <cstdint>
#include <span>

namespace crofton::mesh {

// How the boxes of the nodes are turned: the less perimeter they have, the fewer are met (docs/collide.md, "Meshes").
enum class MeshBoxes : std::uint8_t {
    principal_axes,   // of their vertices; the quickest to build
    small_perimeter,  // turned from there about each axis to about the best angle: within a few per cent of the least
    least_perimeter,  // the best that fit::fit_obb finds
};

struct MeshTreeOptions {
    MeshBoxes boxes = MeshBoxes::small_perimeter;
};

// Every node but the root has at least eight children, and the nodes make no more levels than sixteen-way splits need:
// log16 of the number of leaves, rounded up.
class MeshTree {
  public:
    // A triangle with a vertex that is NaN, infinite or beyond 1e12, or an index out of range, is left out and listed
    // in rejected(); the others are unharmed. Errors: no valid triangle; index count no multiple of three; 2^28
    // triangles or more.
    [[nodiscard]] static Result<MeshTree> build(const TriangleMesh& mesh, const MeshTreeOptions& options = {});

    [[nodiscard]] std::span<const MeshNode> nodes() const { return nodes_; }  // the root is the first
    [[nodiscard]] std::span<const MeshLeaf> leaves() const { return leaves_; }
    [[nodiscard]] const MeshBox& root_box() const { return root_box_; }
    [[nodiscard]] std::span<const std::uint32_t> rejected() const { return rejected_; }  // triangles, ascending
    [[nodiscard]] std::size_t triangle_count() const { return triangle_count_; }         // rejected ones not counted
    // A vertex of each connected piece; triangles are connected where vertices are shared by index or by position.
    [[nodiscard]] std::span<const glm::vec3> pieces() const { return pieces_; }
    // The largest magnitude of any coordinate: rounding errors in the mesh's frame scale with it.
    [[nodiscard]] float extent() const { return extent_; }

  private:
    friend class MeshTreeBuilder;
    Vector<MeshNode> nodes_;
    Vector<MeshLeaf> leaves_;
    Vector<std::uint32_t> rejected_;
    Vector<glm::vec3> pieces_;
    MeshBox root_box_{};
    std::size_t triangle_count_ = 0;
    float extent_ = 0.0f;
};

}  // namespace crofton::mesh
