// SPDX-License-Identifier: MIT
// The convex parts of a shape that may be near a box.
#pragma once
#include <crofton/convex/query.hpp>
#include <crofton/core/executor.hpp>

namespace crofton::convex {

// True ends the search.
using PartVisitor = FunctionRef<bool(const Part& part)>;
struct PartSearch;
// Triangles of surfaces that need not be shapes; with the search that came upon them. True ends the search.
using TriangleVisitor = FunctionRef<bool(const PartSearch& of, const Triangle& corners, std::uint32_t triangle)>;

inline constexpr double kSkewed = 1.00001;  // of a radius: axes and frames are orthonormal to 4e-6 alone

// A box in some frame: center ± half[k] · axes[k], where the axes are those of a pose seen from another, grown by a
// radius.
struct QueryBox {
    glm::dvec3 center{0.0}, half{0.0};
    double radius = 0.0;
    glm::dmat3 axes{1.0};
    double rounding = 0.0;  // how far the center may be off
};

// How far the products of m's columns are from those of a rotation: |(Mᵀ M − 1) v| is at most three times as much for
// unit vectors v.
[[nodiscard]] double skew(const glm::dmat3& m);
// The box around the shape's core and the radius, in the shape's own frame.
[[nodiscard]] QueryBox core_box(const Shape& shape);
// The same in the frame of `pose`.
[[nodiscard]] QueryBox box_around(const ShapeAtPose& shape, const RigidTransform& pose);
// The box as seen from the frame of `pose`.
[[nodiscard]] QueryBox seen_from(const QueryBox& box, const RigidTransform& pose);
[[nodiscard]] Aabb bounds_of(const QueryBox& box);

// Calls `visit` for each part of the shape that is not surely farther than `margin` from the box, which is in the
// shape's frame. With a margin of kEverything: for all. True if a visit ended the search. Parts come in an order that
// depends on the shape alone.
inline constexpr double kEverything = 1e300;
bool visit_parts(const ShapeAtPose& shape, const QueryBox& box, double margin, PartVisitor visit);
// The same, with the triangles of surfaces by themselves.
bool visit_parts(const ShapeAtPose& shape, const QueryBox& box, double margin, PartVisitor visit,
                 TriangleVisitor triangles);

// Calls `visit` for parts that may be nearer to the box than `limit`, the visitor's to lessen; about the nearest first.
bool visit_nearest_parts(const ShapeAtPose& shape, const QueryBox& box, const double& limit, PartVisitor visit);

// What the searches of one kind of shape share: the shape of the search, a child's number, and both ways to ask.
struct PartSearch {
    const RigidTransform& pose;  // of the shape
    Sides sides;
    std::uint32_t child;  // number of the shape among a compound's, or of its first part
    bool nearest_first;   // else in the shape's order
    const double& limit;  // distance
    PartVisitor visit;
    const Shape* shape = nullptr;                  // the surface that is searched
    const TriangleVisitor* on_triangle = nullptr;  // instead of visit

    // Calls one of them for a triangle.
    bool offer(const Triangle& corners, std::uint32_t triangle) const;
};
bool search_mesh(const Shape& shape, const QueryBox& box, const PartSearch& search);
bool search_field(const HeightField& field, const Aabb& box, const PartSearch& search);
bool search_compound(const Compound& compound, const QueryBox& box, const PartSearch& search);
bool search_parts(const ShapeAtPose& shape, const QueryBox& box, const PartSearch& search);

// Whether the shape is a mesh or a height field, or a compound that holds one.
[[nodiscard]] bool has_surfaces(const Shape& shape);

// Of two closed boxes, from below, also where they are told in a frame that is orthonormal to 1e-6 alone.
[[nodiscard]] double distance_between(const Aabb& a, const Aabb& b);

// A pose within another.
[[nodiscard]] inline RigidTransform within(const RigidTransform& outer, const RigidTransform& inner) {
    return {outer.rotation * inner.rotation, outer.rotation * inner.translation + outer.translation};
}

}  // namespace crofton::convex
