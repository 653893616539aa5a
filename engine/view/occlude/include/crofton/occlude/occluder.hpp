// SPDX-License-Identifier: MIT
// Occluders that you place or that are found in meshes, and how much each hides.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/mesh.hpp>
#include <crofton/geometry/transform.hpp>
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <span>

namespace crofton::occlude {

// Occluders and their transforms: boxes, convex bodies, surfaces and closed meshes.

using ShapeId = std::uint32_t;
using OccluderId = std::uint32_t;

// The sides from which a surface hides objects behind it: from the front only, or from either side. Triangles are
// counter-clockwise seen from the front, as for a renderer that culls back faces.
enum class Sides : std::uint8_t { front, both };

// A set of shapes, and of occluders, which are shapes at a transform.
//
// An occluder must be opaque and lie within what you draw; then the picture hides what the occluder hides. Of a body
// only the front counts, as far as it lies beyond the near plane: an eye inside sees through it. Const functions may
// run on any number of threads at once; the others need exclusive access to the set.
class OccluderSet {
  public:
    OccluderSet();
    ~OccluderSet();
    OccluderSet(OccluderSet&&) noexcept;
    OccluderSet& operator=(OccluderSet&&) noexcept;

    // These functions add shapes, in their own coordinates. Errors leave the set unchanged: non_finite and out_of_range
    // (item: the point, or the item of validate(TriangleMesh)); degenerate (flat, or no triangle with an area);
    // invalid_argument (open: item is a triangle at the hole; inside out).

    // Adds the convex hull of the points; flat sets are refused. Besides boxes, hulls cost least to draw.
    [[nodiscard]] Result<ShapeId> add_convex(std::span<const glm::vec3> points);
    // Adds a closed mesh of positive volume, of any number of closed pieces. Closed means that each edge has as many
    // triangles along it as against it, where equal positions count as one vertex.
    [[nodiscard]] Result<ShapeId> add_mesh(const TriangleMesh& mesh);
    // Adds any triangles, such as a triangulated polygon, a terrain or a wall. They may be open and need not be in one
    // plane. A T-junction counts as a gap, which costs a row of covered pixels.
    [[nodiscard]] Result<ShapeId> add_surface(const TriangleMesh& surface, Sides sides);

    // Adds a box as an occluder. Errors: as validate(Obb), and degenerate for a half extent of 0.
    [[nodiscard]] Result<OccluderId> place(const Obb& box);
    // Adds a shape at a transform as an occluder. A reflection turns no shape inside out. Errors: as validate; a shape
    // that does not exist; degenerate for a linear part of determinant 0.
    [[nodiscard]] Result<OccluderId> place(ShapeId shape, const Transform& transform);
    // Moves an occluder. Errors, which leave it unchanged: as above; invalid_argument if it is of the other kind.
    [[nodiscard]] Result<void> move(OccluderId occluder, const Obb& box);
    [[nodiscard]] Result<void> move(OccluderId occluder, const Transform& transform);
    // Enables or disables an occluder. A disabled one hides nothing. All are enabled at first.
    [[nodiscard]] Result<void> set_enabled(OccluderId occluder, bool enabled);

    // Remove an occluder or a shape. Ids are reused, latest first. Errors: not in the set (out_of_range); a shape that
    // occluders use (invalid_argument).
    [[nodiscard]] Result<void> remove(OccluderId occluder);
    [[nodiscard]] Result<void> remove_shape(ShapeId shape);

    [[nodiscard]] std::size_t size() const;         // ids are below it, removed ones included
    [[nodiscard]] std::size_t shape_count() const;  // likewise
    void clear();                                   // occluders and shapes; keeps the memory

  private:
    friend struct OccluderStorage;
    struct Data;
    Owner<Data> data_;
};

// Finding occluders in a mesh: boxes and convex bodies inside it, and large flat parts of its surface, that hide most
// per edge drawn.

enum class OccluderKind : std::uint8_t {
    box,     // inside a closed piece of the mesh
    walled,  // a box behind walls of the mesh, which may be open on some sides
    convex,  // a closed piece of the mesh that is convex itself
    patch,   // connected, flat triangles of the mesh
};

[[nodiscard]] inline Aabb everywhere() {
    constexpr double kEndless = std::numeric_limits<double>::infinity();
    return {glm::dvec3(-kEndless), glm::dvec3(kEndless)};
}

// An occluder found in a mesh, in the mesh's frame.
struct FoundOccluder {
    OccluderKind kind = OccluderKind::box;
    // Kinds box and walled only. Its shape is also in `surface`, with corners rounded to float; both are inside.
    Obb box;
    // Convex bodies and patches: triangles of the mesh, unchanged. Those of a body are closed, counter-clockwise from
    // outside.
    TriangleMesh surface;
    Sides sides = Sides::both;  // of a patch: those of the mesh; bodies hide from all sides
    // Boxes and convex bodies: the bounds of the piece that contains the occluder. From an eye inside these bounds, the
    // occluder may hide objects that are inside and visible. Do not use it for such eyes, nor for eyes that are nearer
    // to the bounds than their near plane is to any point of it. Patches: empty.
    Aabb piece_bounds;
    // The eyes that may use the occluder. Bounded for boxes behind walls that leave a side open, such as houses without
    // a floor. No ray from within these bounds enters by that side.
    Aabb eyes_within = everywhere();
    double mean_shadow = 0.0;  // F/4 of a body; A/2 of a patch, A/4 if it hides only from its front
    double gain = 0.0;         // its addition to the mean shadow of those before it in the list; an estimate
    std::uint32_t edges = 0;   // drawn edges, its cost: 12 for a box, those of its boundary for a patch
};

struct FindOptions {
    Sides sides = Sides::front;           // the sides that you draw
    std::uint32_t max_occluders = 16;     // of the mesh
    std::uint32_t max_edges = 400;        // of all of them together
    std::uint32_t max_boxes_a_piece = 4;  // in a closed piece that is not convex
    // Skips occluders that add less than this share of the mesh's mean shadow.
    double least_gain = 0.02;
    // Patches: the largest distance of a vertex from the plane of the largest triangle, relative to the size of the
    // mesh.
    double flatness = 1e-4;
    // The largest number of triangles of a patch. A patch with a convex outline is drawn as fast as a box, any other
    // triangle by triangle, many times slower. In a town, patches of more triangles take five times as long as all
    // other occluders and hide 1 % of the triangles.
    std::uint32_t max_patch_triangles = 4;
    // 0 for a single mesh. For a level made of many small pieces, the number of triangles per surface at most; 48 is a
    // good number.
    //
    // All triangles of the level then become surfaces. They replace patches, are of that kind, and need not be flat.
    // max_occluders and max_edges do not count them. Walls, floors and ceilings that are near each other form one
    // surface, which loses no pixel where they meet. Triangles are cut where a vertex of another lies on one of their
    // sides along an axis, which covers the same points exactly. This makes up to four times as many triangles; other
    // junctions keep their seams. Each triangle is drawn, slower than boxes: use it for levels in which no boxes are
    // found.
    std::uint32_t level_triangles = 0;
    // Cells along each axis of the grid that is searched for boxes, 4 to 32: a finer grid is slower and finds larger
    // boxes.
    std::uint32_t grid = 24;
};

struct FoundOccluders {
    // In the order in which they were chosen, by gain per edge; then the surfaces of a level.
    Vector<FoundOccluder> occluders;
    double mean_shadow = 0.0;         // of the whole mesh; an estimate, as `covered`
    double covered = 0.0;             // of the occluders together
    std::uint32_t pieces = 0;         // sets of triangles connected by sides; vertices of equal position are one
    std::uint32_t closed_pieces = 0;  // that have an inside
    Vector<std::uint32_t> rejected;   // triangles, ascending: bad indices or coordinates

    [[nodiscard]] double share() const { return mean_shadow > 0.0 ? covered / mean_shadow : 0.0; }
};

// Finds occluders in a mesh. All that an occluder hides is hidden by the mesh, from any eye that piece_bounds and
// eyes_within allow (docs/notes/occluder_finding.md).
//
// Boxes and convex bodies are proved to lie inside the solid that a closed piece bounds: no triangle of the piece meets
// the open body, by separating axes with error bounds or exact predicates, and its centre is inside by an exact count
// of crossings. With Sides::front, a piece is closed if the sides of its triangles cancel, and its inside is where it
// winds round at least once, so that every ray into it meets a front face. With Sides::both, it is closed if every edge
// has an even number of triangles, and its inside is where rays cross it an odd number of times.
//
// Walled boxes lie behind walls across the mesh's own axes that no straight path passes, decided exactly, recesses such
// as set-back windows included. Meshes of more than 100,000 triangles get none. Patches are subsets of the mesh's
// triangles.
//
// A triangle with a vertex that is NaN, infinite or beyond 1e12, or with an index out of range, is left out and listed
// in rejected. The result depends only on the mesh and the options. The choice is greedy, so it is not the best for the
// budget. Errors: an index count that is not a multiple of three; 2^28 triangles or more, 2^26 of a level; no valid
// triangle (empty); an option out of its range.
[[nodiscard]] Result<FoundOccluders> find_occluders(const TriangleMesh& mesh, const FindOptions& options = {});

}  // namespace crofton::occlude
