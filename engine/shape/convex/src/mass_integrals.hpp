// SPDX-License-Identifier: MIT
// Moments of solids, and mass properties from them.
#pragma once
#include <array>
#include <crofton/convex/shape.hpp>
#include <crofton/core/memory.hpp>
#include <cstdint>
#include <span>

namespace crofton::convex {

// ∫ dV, ∫ x dV, ∫ x xᵀ dV; solids add up.
struct Moments {
    double volume = 0.0;
    glm::dvec3 first{0.0};
    glm::dmat3 second{0.0};

    // The tetrahedron of the origin and a, b, c; negative where they turn clockwise seen from outside.
    void add_tetrahedron(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c);
};

[[nodiscard]] MassProperties mass_of(const Moments& moments, const glm::dvec3& origin);

// The solid within closed triangles: polynomials, rounded.
[[nodiscard]] MassProperties mass_of_triangles(std::span<const glm::dvec3> points,
                                               const Vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace crofton::convex
