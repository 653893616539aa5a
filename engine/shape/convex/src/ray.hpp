// SPDX-License-Identifier: MIT
// Rays against shapes: moves the ray's origin near the shape, transforms it to the shape's frame, and intersects there.
#pragma once
#include <crofton/convex/query.hpp>
#include <crofton/geometry/shapes.hpp>
#include <optional>

namespace crofton::convex {

// A ray in some frame: origin + t · direction for t in [0, max_t]. Components of the direction are below 4 in size, the
// largest is at least about a half. `error` bounds how far its points near the shape are from the real ray's.
struct NearRay {
    glm::dvec3 origin{0.0}, direction{0.0};
    double max_t = 0.0;
    double error = 0.0;
    bool moved = false;  // its origin lies ahead of the real one's, surely outside of the shape
};

// Where a ray that begins outside first meets a shape, in the shape's frame. The normal is of any length but 0.
struct NearHit {
    double t = 0.0;
    glm::dvec3 normal{0.0};
    std::uint32_t triangle = 0;
};

// A convex shape with bounds. Triangles without rounding have no inside and are met from both sides.
[[nodiscard]] std::optional<NearHit> meet_convex(const Shape& shape, const NearRay& ray);
// Whether the origin is in the shape's rounded cylinder or cone.
[[nodiscard]] bool is_in_round(const Shape& shape, const glm::dvec3& point);
[[nodiscard]] std::optional<NearHit> meet_mesh(const Shape& shape, const NearRay& ray);
[[nodiscard]] std::optional<NearHit> meet_field(const HeightField& field, Sides sides, const NearRay& ray);

// The nearest point of a triangle on the ray, decided exactly for the ray as it is; a one-sided one is passed from
// behind.
[[nodiscard]] std::optional<NearHit> meet_triangle(const Triangle& corners, Sides sides, const NearRay& ray);
// Toward the side on which counter-clockwise is; each component is exact within roundings of its own size.
[[nodiscard]] glm::dvec3 normal_of(const Triangle& corners);

// Whether the ray passes within `margin` of the box before max_t, and from where on.
[[nodiscard]] bool passes_box(const NearRay& ray, const Aabb& box, double margin, double& from);

// Calls `visit` for the children whose boxes the ray passes; the ray is in the compound's frame.
using ChildVisitor = FunctionRef<void(const CompoundChild& child, std::uint32_t first_part)>;
void visit_children_along(const Compound& compound, const NearRay& ray, ChildVisitor visit);

}  // namespace crofton::convex
