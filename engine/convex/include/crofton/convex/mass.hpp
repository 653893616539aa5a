// SPDX-License-Identifier: MIT
// Volume, center of mass and inertia of a body of density 1.
#pragma once
#include <crofton/core/requirements.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

namespace crofton::convex {

// In the body's frame. Times the density: mass and inertia tensor.
struct MassProperties {
    double volume = 0.0;
    glm::dvec3 center{0.0};   // of mass
    glm::dmat3 inertia{0.0};  // about `center`: ∫ (|r|² I − r rᵀ) dV, symmetric
};

}  // namespace crofton::convex
