// SPDX-License-Identifier: MIT
// What the tests of meshes in a World share.
#pragma once
#include <doctest/doctest.h>
#include <crofton/crofton.hpp>
#include <limits>

namespace crofton::testing {

inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

inline scene::Transform at(const glm::dvec3& place, const glm::dmat3& linear = glm::dmat3(1.0)) {
    return {linear, place};
}

inline MeshDescription described(const TriangleMesh& mesh) {
    return {.positions = mesh.positions, .indices = mesh.indices};
}

// [-1, 1]³.
inline TriangleMesh cube() {
    TriangleMesh mesh;
    for (int i = 0; i < 8; ++i) mesh.positions.push_back({i & 1 ? 1.f : -1.f, i & 2 ? 1.f : -1.f, i & 4 ? 1.f : -1.f});
    mesh.indices = {0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                    2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6};
    return mesh;
}

inline Ray down(double x, double y) {
    return {{x, y, 100.0}, {0.0, 0.0, -1.0}};
}

inline std::size_t seen(const World& world) {
    VisibleObjects visible;
    Camera camera;
    camera.position.z = 50.0;
    REQUIRE(world.view(camera, visible).has_value());
    return visible.size();
}

}  // namespace crofton::testing
