// SPDX-License-Identifier: MIT
// A hierarchy of oriented boxes over the triangles of one mesh, for collision and ray queries. A node has sixteen
// boxes.
#pragma once
#include <array>
#include <crofton/core/error.hpp>
#include <crofton/core/executor.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/mesh.hpp>
#include <cstdint>
#include <span>

namespace crofton::mesh {

struct MeshParts;

// The orientation of the nodes' boxes. Boxes of smaller perimeter are hit less often (docs/notes/collide.md, "Meshes").
enum class MeshBoxes : std::uint8_t {
    principal_axes,   // of their vertices; the quickest to build
    small_perimeter,  // turned from there about each axis to about the best angle: within a few per cent of the least
    least_perimeter,  // the best that fit::fit_obb finds
};

struct MeshTreeOptions {
    MeshBoxes boxes = MeshBoxes::small_perimeter;
    // For meshes that deform. refit() needs 20 more bytes per triangle, and 12 per vertex that shares another's
    // position.
    bool refittable = false;
    bool rays = false;  // for meshes that many rays are cast at: build() calls prepare_rays()
};

// A connected piece of a mesh: triangles that share vertices, by index or by equal position.
struct MeshPiece {
    glm::vec3 vertex{0.0f};  // of the piece's lowest triangle
    // True if every edge belongs to an even number of the piece's triangles, where vertices of equal position count as
    // one. Then all lines from a point cross the piece equally often, modulo two, so it has an inside. An open piece
    // contains nothing.
    bool closed = false;
};

// The hierarchy of a mesh. Every node except the root has at least eight children. It has no more levels than
// sixteen-way splits need: log16 of the number of leaves, rounded up.
class MeshTree {
  public:
    MeshTree();  // without triangles
    ~MeshTree();
    MeshTree(const MeshTree& other);
    MeshTree& operator=(const MeshTree& other);
    MeshTree(MeshTree&& other) noexcept;  // leaves a tree without triangles
    MeshTree& operator=(MeshTree&& other) noexcept;

    // Builds the tree.
    //
    // A triangle with a vertex that is NaN, infinite or beyond 1e12, or with an index out of range, is left out and
    // listed in rejected(); the others are not affected. Errors: no valid triangle; an index count that is not a
    // multiple of three; 2^28 triangles or more. The same tree with any executor; a thread that works takes four bytes
    // per vertex while it does.
    [[nodiscard]] static Result<MeshTree> build(const TriangleMesh& mesh, const MeshTreeOptions& options = {},
                                                Executor& executor = serial_executor());

    // Moves the vertices: `positions` are those of the mesh that the tree was built from, in its order.
    //
    // Triangles stay in their leaves; boxes turn with three of their vertices and get new bounds. The result depends
    // only on the build and on `positions`, not on earlier refits. Boxes grow as neighbouring triangles move apart:
    // rebuild when queries slow down. A piece is open while vertices are apart whose equal positions closed it or
    // connected it. Containment then tests its parts one by one. Allocates nothing.
    //
    // Errors, which leave the tree unchanged: a tree that is not refittable; another number of positions; a vertex of a
    // triangle that is NaN, infinite or beyond 1e12.
    [[nodiscard]] Result<void> refit(std::span<const glm::vec3> positions);

    // Builds a hierarchy of aligned boxes for rays. It takes a tenth more memory and about a quarter less time a ray;
    // without it, rays use the oriented boxes, with the same bits as answers. A second call does nothing. Error: out of
    // memory; the tree is unchanged.
    Result<void> prepare_rays();

    [[nodiscard]] std::span<const std::uint32_t> rejected() const { return rejected_; }  // triangles, ascending
    [[nodiscard]] std::size_t triangle_count() const { return triangle_count_; }         // rejected ones not counted
    [[nodiscard]] std::span<const MeshPiece> pieces() const { return pieces_; }          // by their lowest triangles
    // Returns the largest magnitude of any coordinate. Rounding errors in the mesh's frame scale with it.
    [[nodiscard]] float extent() const { return extent_; }

    // Returns nodes and leaves, for the engine's own queries.
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
