// SPDX-License-Identifier: MIT
// What the tests of meshes in a World share.
#pragma once
#include <doctest/doctest.h>
#include <box_mesh.hpp>
#include <crofton/crofton.hpp>
#include <limits>

namespace crofton::testing {

inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

inline Transform at(const glm::dvec3& place, const glm::dmat3& linear = glm::dmat3(1.0)) {
    return {linear, place};
}

inline MeshDescription described(const TriangleMesh& mesh) {
    return {.positions = mesh.positions, .indices = mesh.indices};
}

inline Ray down(double x, double y) {
    return {{x, y, 100.0}, {0.0, 0.0, -1.0}};
}

inline std::size_t seen(const World& world) {
    ViewResult visible;
    Camera camera;
    camera.position.z = 50.0;
    REQUIRE(world.view({.camera = camera}, visible).has_value());
    return visible.size();
}

}  // namespace crofton::testing
