// SPDX-License-Identifier: MIT
// What of a mesh hides most per edge drawn: boxes and convex bodies inside it, and large flat parts of its surface.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/mesh.hpp>
#include <crofton/occlude/occluder.hpp>
#include <cstdint>
#include <limits>

namespace crofton::occlude {

enum class OccluderKind : std::uint8_t {
    box,     // inside a closed piece of the mesh
    walled,  // a box behind walls of the mesh, that may be open on some sides
    convex,  // a closed piece of the mesh that is convex itself
    patch,   // triangles of the mesh that hang together and are flat
};

[[nodiscard]] inline Aabb everywhere() {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    return {glm::dvec3(-kInfinity), glm::dvec3(kInfinity)};
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
    // hide what is inside and seen from there: leave it out for such eyes, and for those nearer to them than to any
    // point of their near plane. Patches: empty.
    Aabb piece_bounds;
    // Eyes must be in here. Bounded for boxes behind walls that leave a side open, as houses without a floor do: no ray
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
    // What adds less than this share of the mesh's mean shadow is left out.
    double least_gain = 0.02;
    // Patches: how far from the plane of their largest triangle vertices may lie, relative to the size of the mesh.
    double flatness = 1e-4;
    // Cells along each axis of the grid that boxes are looked for in, 4 to 32: finer is slower and finds larger boxes.
    std::uint32_t grid = 24;
};

struct FoundOccluders {
    // In the order they were chosen: by gain per edge.
    Vector<FoundOccluder> occluders;
    double mean_shadow = 0.0;         // of the whole mesh; an estimate, as `covered`
    double covered = 0.0;             // of the occluders together
    std::uint32_t pieces = 0;         // triangles that hang together by sides; vertices of equal position are one
    std::uint32_t closed_pieces = 0;  // that have an inside
    Vector<std::uint32_t> rejected;   // triangles, ascending: bad indices or coordinates

    [[nodiscard]] double share() const { return mean_shadow > 0.0 ? covered / mean_shadow : 0.0; }
};

// Boxes and convex bodies lie inside the solid that a closed piece bounds, proven: no triangle of the piece meets the
// open body (separating axes with error bounds, or exact predicates), and its centre is inside by an exact count of
// crossings. Sides::front: a piece is closed where the sides of its triangles cancel, and its inside is where it winds
// round at least once, so that every ray into it meets a front face. Sides::both: where every edge has an even number
// of triangles, and its inside is where rays cross it an odd number of times. Walled boxes lie behind walls across the
// mesh's own axes that no straight path passes, recesses such as windows set back included, decided exactly; meshes of
// more than 100,000 triangles get none. Patches are subsets of the mesh's triangles. So all that an occluder hides is
// hidden by the mesh, from any eye that piece_bounds and eyes_within allow (docs/notes/occluder_finding.md).
// A triangle with a vertex that is NaN, infinite or beyond 1e12, or an index out of range, is left out and listed in
// rejected. The result depends on the mesh and the options alone; greedy, so not the best for the budget.
// Errors: an index count that is no multiple of three; 2^28 triangles or more; no valid triangle (empty); an option out
// of its range.
[[nodiscard]] Result<FoundOccluders> find_occluders(const TriangleMesh& mesh, const FindOptions& options = {});

}  // namespace crofton::occlude
