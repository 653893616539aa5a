// SPDX-License-Identifier: MIT
// A hierarchy of oriented boxes over the triangles of one mesh, for collisions and rays. A node has sixteen boxes.
#pragma once
#include <array>
#include <crofton/core/error.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/mesh.hpp>
#include <cstdint>
#include <span>

namespace crofton::mesh {

struct MeshParts;

// How the boxes of the nodes are turned: the less perimeter they have, the fewer are met (docs/notes/collide.md,
// "Meshes").
enum class MeshBoxes : std::uint8_t {
    principal_axes,   // of their vertices; the quickest to build
    small_perimeter,  // turned from there about each axis to about the best angle: within a few per cent of the least
    least_perimeter,  // the best that fit::fit_obb finds
};

struct MeshTreeOptions {
    MeshBoxes boxes = MeshBoxes::small_perimeter;
    // For meshes that deform: refit() needs 20 bytes more a triangle, and 12 a vertex that has another's position.
    bool refittable = false;
    bool rays = false;  // for meshes that many rays are cast at: prepare_rays() at once
};

// Triangles that share vertices, by index or by equal position, make a connected piece.
struct MeshPiece {
    glm::vec3 vertex{0.0f};  // of the piece's lowest triangle
    // Every edge belongs to an even number of the piece's triangles, where vertices of equal position are one. Then all
    // lines from a point cross the piece equally often, modulo two: it has an inside. An open piece contains nothing.
    bool closed = false;
};

// Every node but the root has at least eight children. There are no more levels than sixteen-way splits need: log16 of
// the number of leaves, rounded up.
class MeshTree {
  public:
    MeshTree();  // of no triangles
    ~MeshTree();
    MeshTree(const MeshTree& other);
    MeshTree& operator=(const MeshTree& other);
    MeshTree(MeshTree&& other) noexcept;  // what is moved from is a tree of no triangles
    MeshTree& operator=(MeshTree&& other) noexcept;

    // A triangle with a vertex that is NaN, infinite or beyond 1e12, or an index out of range, is left out and listed
    // in rejected(). The others are unharmed. Errors: no valid triangle; index count no multiple of three; 2^28
    // triangles or more.
    [[nodiscard]] static Result<MeshTree> build(const TriangleMesh& mesh, const MeshTreeOptions& options = {});

    // Moves the vertices: `positions` are those of the mesh that the tree was built from, in its order. Triangles stay
    // in their leaves; boxes turn with three of their vertices and are bounded anew. The result depends on the build
    // and on `positions` alone, not on earlier refits. Boxes widen as neighbours part: rebuild when queries slow down.
    // A piece is open while vertices have parted whose equal positions closed it or held it together. Its parts are
    // then asked one by one whether another mesh contains them. Allocates nothing. Errors, after which the tree is as
    // before: a tree that is not refittable; another number of positions; a vertex of a triangle that is NaN, infinite
    // or beyond 1e12.
    [[nodiscard]] Result<void> refit(std::span<const glm::vec3> positions);

    // A hierarchy of aligned boxes for rays, a tenth more memory: with it a ray takes 7 to 35 % less time. Without it
    // rays go through the oriented boxes; the answers are the same bits. Nothing is done the second time. Error: out of
    // memory; the tree is as before.
    Result<void> prepare_rays();

    [[nodiscard]] std::span<const std::uint32_t> rejected() const { return rejected_; }  // triangles, ascending
    [[nodiscard]] std::size_t triangle_count() const { return triangle_count_; }         // rejected ones not counted
    [[nodiscard]] std::span<const MeshPiece> pieces() const { return pieces_; }          // by their lowest triangles
    // The largest magnitude of any coordinate: rounding errors in the mesh's frame scale with it.
    [[nodiscard]] float extent() const { return extent_; }

    // Nodes and leaves, for the engine's own queries.
    [[nodiscard]] const MeshParts& parts() const;

  private:
    friend class MeshTreeBuilder;
    [[nodiscard]] Result<void> check_positions(std::span<const glm::vec3> positions) const;

    Vector<std::uint32_t> rejected_;
    Vector<MeshPiece> pieces_;
    std::size_t triangle_count_ = 0;
    float extent_ = 0.0f;
    Owner<MeshParts> parts_;  // none without triangles
};

}  // namespace crofton::mesh
