// SPDX-License-Identifier: MIT
// Occluders: made by hand, or found in meshes; what each is worth.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/mesh.hpp>
#include <crofton/geometry/transform.hpp>
#include <crofton/measure/measure.hpp>
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <span>

namespace crofton::occlude {

// Occluders and their transforms: boxes, convex bodies, surfaces and closed meshes.

using ShapeId = std::uint32_t;
using OccluderId = std::uint32_t;

// From where a surface hides what is behind it: from the front only, or from either side. The front is where its
// triangles are counter-clockwise, as a renderer that culls back faces draws it.
enum class Sides : std::uint8_t { front, both };

// Shapes, each given once, and occluders: shapes in places. An occluder must lie within what is drawn, and must be
// opaque: then what it hides is hidden in the picture. Of a body its front counts alone, as far as it lies beyond the
// near plane: an eye inside of it sees through it. Const functions may run on any number of threads at once; the
// others need the set for themselves.
class OccluderSet {
  public:
    OccluderSet();
    ~OccluderSet();
    OccluderSet(OccluderSet&&) noexcept;
    OccluderSet& operator=(OccluderSet&&) noexcept;

    // Shapes, in their own coordinates. Errors leave the set as it was: non_finite and out_of_range (item: the point,
    // or what validate(TriangleMesh) says); degenerate (flat, or no triangle with an area); invalid_argument (open:
    // item is a triangle at the hole; inside out).

    // The convex hull of the points; flat sets are refused. Costs least to draw, beside boxes.
    [[nodiscard]] Result<ShapeId> add_convex(std::span<const glm::vec3> points);
    // A closed mesh: each edge has as many triangles that go along it as such that go against it, where equal positions
    // are one vertex. Its volume is positive. Any number of closed pieces.
    [[nodiscard]] Result<ShapeId> add_mesh(const TriangleMesh& mesh);
    // Any triangles, open or not, none of which need be in one plane: a polygon as triangulated, a terrain, a wall.
    // A T-junction is a gap to the rule for covered pixels: it costs a row of pixels there.
    [[nodiscard]] Result<ShapeId> add_surface(const TriangleMesh& surface, Sides sides);

    // Occluders. A box, as it is; errors: as validate(Obb), and degenerate for a half extent of 0.
    [[nodiscard]] Result<OccluderId> place(const Obb& box);
    // A shape in a place. Errors: as validate; a shape that is not there; degenerate for a linear part of
    // determinant 0. A reflection turns no shape inside out.
    [[nodiscard]] Result<OccluderId> place(ShapeId shape, const Transform& transform);
    // Moves an occluder. Errors as above leave it where it was; invalid_argument where it is of the other kind.
    [[nodiscard]] Result<void> move(OccluderId occluder, const Obb& box);
    [[nodiscard]] Result<void> move(OccluderId occluder, const Transform& transform);
    // An occluder that is off hides nothing. All are on at first.
    [[nodiscard]] Result<void> set_enabled(OccluderId occluder, bool enabled);

    // Ids of what is removed are given out again, latest first. Errors: not in the set (out_of_range); a shape that
    // occluders have (invalid_argument).
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

// What of a mesh hides most per edge drawn: boxes and convex bodies inside it, and large flat parts of its surface.

enum class OccluderKind : std::uint8_t {
    box,     // inside a closed piece of the mesh
    walled,  // a box behind walls of the mesh, that may be open on some sides
    convex,  // a closed piece of the mesh that is convex itself
    patch,   // triangles of the mesh that hang together and are flat
};

[[nodiscard]] inline Aabb everywhere() {
    constexpr double kEndless = std::numeric_limits<double>::infinity();
    return {glm::dvec3(-kEndless), glm::dvec3(kEndless)};
}

// In the mesh's frame.
struct FoundOccluder {
    OccluderKind kind = OccluderKind::box;
    // Kinds box and walled only. Its shape is also in `surface`, with corners rounded to float; both are inside.
    Obb box;
    // Convex bodies and patches: triangles of the mesh, as they are. Bodies: closed, counter-clockwise from outside.
    TriangleMesh surface;
    Sides sides = Sides::both;  // of a patch: those of the mesh. Bodies hide from all around
    // Boxes and convex bodies: the bounds of what the occluder lies in. From an eye in these bounds the occluder may
    // hide what is inside and seen from there. Leave it out for such eyes, and for eyes that are nearer to the bounds
    // than their near plane is to any point of it. Patches: empty.
    Aabb piece_bounds;
    // Eyes must be in here. Bounded for boxes behind walls that leave a side open, as houses without a floor do. No ray
    // from within these bounds enters by that side.
    Aabb eyes_within = everywhere();
    double mean_shadow = 0.0;  // F/4 of a body; A/2 of a patch, A/4 where it hides from its front alone
    double gain = 0.0;         // what it added to the mean shadow of those before it in the list; an estimate
    std::uint32_t edges = 0;   // drawn: its cost. A box has 12, a patch those of its boundary
};

struct FindOptions {
    Sides sides = Sides::front;           // that are drawn
    std::uint32_t max_occluders = 16;     // of the mesh
    std::uint32_t max_edges = 400;        // of all of them together
    std::uint32_t max_boxes_a_piece = 4;  // in a closed piece that is not convex
    // Leaves out occluders that add less than this share of the mesh's mean shadow.
    double least_gain = 0.02;
    // Patches: how far from the plane of their largest triangle vertices may lie, relative to the size of the mesh.
    double flatness = 1e-4;
    // A patch with a convex outline is drawn as fast as a box, any other triangle by triangle, many times as slowly. In a
    // town those of more triangles take five times as long as all other occluders and hide 1 % of the triangles.
    std::uint32_t max_patch_triangles = 4;
    // 0: a mesh of its own. Else a level made of many small pieces: all its triangles become surfaces of so many at
    // most; 48 is a good number. They take the place of patches, are of that kind, and need not be flat. max_occluders
    // and max_edges do not count them. Walls, floors and ceilings that are near each other are one surface: within it
    // no pixel is lost where they meet. Triangles are cut where a vertex of another lies on one of their sides along an
    // axis, which covers the same points exactly. There are up to four times as many then; the rest keep their seams.
    // Each triangle is drawn: slower than boxes, for what has none.
    std::uint32_t level_triangles = 0;
    // Cells along each axis of the grid that boxes are looked for in, 4 to 32: finer is slower and finds larger boxes.
    std::uint32_t grid = 24;
};

struct FoundOccluders {
    // In the order they were chosen: by gain per edge. Then surfaces of a level.
    Vector<FoundOccluder> occluders;
    double mean_shadow = 0.0;         // of the whole mesh; an estimate, as `covered`
    double covered = 0.0;             // of the occluders together
    std::uint32_t pieces = 0;         // triangles that hang together by sides; vertices of equal position are one
    std::uint32_t closed_pieces = 0;  // that have an inside
    Vector<std::uint32_t> rejected;   // triangles, ascending: bad indices or coordinates

    [[nodiscard]] double share() const { return mean_shadow > 0.0 ? covered / mean_shadow : 0.0; }
};

// Boxes and convex bodies are proven to lie inside the solid that a closed piece bounds. No triangle of the piece meets
// the open body, by separating axes with error bounds or exact predicates. Its centre is inside by an exact count of
// crossings. Sides::front: a piece is closed where the sides of its triangles cancel. Its inside is where it winds
// round at least once, so that every ray into it meets a front face. Sides::both: where every edge has an even number
// of triangles, and its inside is where rays cross it an odd number of times. Walled boxes lie behind walls across the
// mesh's own axes that no straight path passes, decided exactly. Recesses such as windows set back are included. Meshes
// of more than 100,000 triangles get none. Patches are subsets of the mesh's triangles. So all that an occluder hides
// is hidden by the mesh, from any eye that piece_bounds and eyes_within allow (docs/notes/occluder_finding.md). A
// triangle with a vertex that is NaN, infinite or beyond 1e12, or an index out of range, is left out and listed in
// rejected. The result depends on the mesh and the options alone; greedy, so not the best for the budget. Errors: an
// index count that is no multiple of three; 2^28 triangles or more, 2^26 of a level; no valid triangle (empty); an
// option out of its range.
[[nodiscard]] Result<FoundOccluders> find_occluders(const TriangleMesh& mesh, const FindOptions& options = {});

// How much an occluder hides from a region of eyes: a measure to rank occluders by, before any view is known.

// From where one looks, and at what.
struct SeenScene {
    Aabb eyes;                         // uniformly distributed in here; may be flat, a segment or a point
    double range = 100.0;              // how far from the eye objects lie
    measure::IntrinsicVolumes object;  // of one object, or the means over all; objects lie and turn uniformly
    std::uint32_t samples = 64;        // of eyes; the same ones in every call
};

// The expected volume of the places in which an object is hidden as a whole by the convex hull of `points`. Times the
// number of objects per volume it is the expected number of hidden objects. The shadow volume of a body K from an eye
// is the union of the rays' parts from K on, up to `range`. It is convex: the hull of K and of K scaled from the eye.
// An object of surface F' and mean curvature M' lies in a convex body (V, F, M) with kinematic measure V − F·M'/4π to
// first order. That is what (1) in theory.md section 2 gives for "meets", with the sign of "contains". What is left out
// is of second order in the object's size. An eye inside the hull sees nothing hidden: 0. Errors: as
// measure::intrinsic_volumes_of_hull; eyes empty or not finite; a range that is not positive and finite; samples of 0.
[[nodiscard]] Result<double> occlusion_worth(std::span<const glm::dvec3> points, const SeenScene& scene);

}  // namespace crofton::occlude
