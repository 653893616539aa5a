// SPDX-License-Identifier: MIT
// Surfaces' triangles near a body, and the rule that keeps contacts off inner edges.
#pragma once
#include <span>

#include "triangle_touch.hpp"

namespace crofton::convex {

// A mesh or a height field, alone or within a compound.
struct NearSurface {
    RigidTransform pose;
    Sides sides;
    std::uint32_t child;
    double reach;
};
struct NearTriangle {
    Triangle corners;
    std::uint32_t triangle, surface;  // indices: of the surface's triangle, of the list of surfaces
};

// The rule: a contact's normal belongs to the surface iff no triangle around the vertices on which it stands rises
// above them. Triangles at a vertex are found by a hash of its place, made when first asked for.
class EdgeRule {
  public:
    // For these triangles; they stay unchanged until the next call.
    void start(std::span<const NearTriangle> triangles);
    // Whether a triangle that shares the vertices of `index` that are farthest along the normal rises above them.
    [[nodiscard]] bool points_into_neighbor(std::uint32_t index, const RigidTransform& pose, const glm::dvec3& normal);

  private:
    void list_corners();
    [[nodiscard]] std::size_t slot_of(const glm::dvec3& vertex) const;

    std::span<const NearTriangle> triangles_;
    bool listed_ = false;
    Vector<std::uint32_t> first_, next_;  // chains of corners: triangle · 3 + corner
};

// A direction is across an edge, and a neighbour not above a vertex, up to this sine.
inline constexpr double kFlatSine = 1e-3;

}  // namespace crofton::convex
