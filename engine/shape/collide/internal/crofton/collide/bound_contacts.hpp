// SPDX-License-Identifier: MIT
// Distances and contacts of objects that are boxes, spheres or meshes in a World.
//
// Boxes are exact parallelepipeds here, whose axes may be off by kMaxAxisDeviation; shapes have poses (crofton/convex).
#pragma once
#include <crofton/collide/narrow_phase.hpp>
#include <span>

namespace crofton::mesh {
class MeshTree;
struct MeshContact;
}  // namespace crofton::mesh

namespace crofton::collide {

struct Distance {
    double distance = 0.0;            // 0 if they overlap
    glm::dvec3 on_a{0.0}, on_b{0.0};  // nearest points; if boxes overlap, a point within 1e-6 of the size of both
};

// Returns the distance of two boxes, for numbers up to kMaxCoordinate.
//
// It is 0 iff intersects(a, b), exactly. Otherwise it is within 1e-12 of the size, which is the sum of the half extents
// and the distance of the centres.
[[nodiscard]] Distance distance(const Obb& a, const Obb& b);
// Returns the distance to a capsule's segment minus the radius; 0 iff intersects(box, capsule). A sphere is a capsule
// whose ends are equal.
[[nodiscard]] Distance distance(const Obb& box, const Capsule& capsule);
// Returns the distance in double, within 1e-15 of the coordinates' size and the radii.
[[nodiscard]] Distance distance(const Capsule& capsule, const Sphere& sphere);

// The depth of an overlap. The shortest motion of b that ends the overlap is depth · axis; the axis has unit length and
// points from a to b.
//
// A negative depth is a gap: the boxes are at least that far apart. It is computed over the separating axes of the two
// boxes, so the depth is exact up to rounding.
struct Penetration {
    double depth = 0.0;
    glm::dvec3 axis{0.0};
};
[[nodiscard]] Penetration penetration(const Obb& a, const Obb& b);

struct Manifold {
    glm::dvec3 normal{0.0};  // unit, from a to b
    double depth = 0.0;      // of the deepest point
    int count = 0;           // 0 if the shapes do not overlap
    ContactPoint points[8];
};
enum class ManifoldPoints : std::uint8_t {
    reduced,  // at most four: the deepest, and those that keep most of the area
    all,      // up to eight
};
// Returns where two boxes touch: the incident face clipped against the reference face (Sutherland, Hodgman), or the
// nearest points of two edges.
//
// Points are in order around the incident face: the same input gives the same order. Boxes that overlap exactly, but by
// less than rounding can show, give at least one point. Points are off by the rounding of the boxes' size and distance,
// not of their coordinates.
[[nodiscard]] Manifold contact_manifold(const Obb& a, const Obb& b, ManifoldPoints points = ManifoldPoints::reduced);
// Returns where two meshes touch, in a's frame: at most four points, from all their contacts (mesh::contacts). Without
// contacts there are no points.
//
// The normal is that of the curve in which the surfaces cross, by its vector area; an even pressure between the shapes
// would push in that direction. The points are the deepest and those that keep most of the area. The depth of a point
// is how far b has to move along the normal until the surfaces separate on the line through the point. It is 0 if the
// point lies in no overlap.
[[nodiscard]] Manifold contact_manifold(const mesh::MeshTree& a, const mesh::MeshTree& b, const RigidTransform& b_to_a,
                                        std::span<const mesh::MeshContact> contacts);
// Returns one point, at the deepest point of the sphere, or none if the shapes do not overlap. Spheres with the same
// center separate along z.
[[nodiscard]] Manifold contact_manifold(const Obb& box, const Sphere& sphere);
[[nodiscard]] Manifold contact_manifold(const Sphere& a, const Sphere& b);

}  // namespace crofton::collide
