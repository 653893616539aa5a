// SPDX-License-Identifier: MIT
// Uniform directions, rotations, motions and cameras, as functions of points u of the unit cube. Take these from Random
// or UnitPoints. Computed with + − × ÷ and square roots only: the same bits on every machine.
#pragma once
#include <array>
#include <crofton/geometry/aabb.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/geometry/rigid_transform.hpp>
#include <glm/mat2x2.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace crofton::sampling {

// (cos 2πu, sin 2πu), within 2e-16; u in [0, 1].
[[nodiscard]] glm::dvec2 circle_point(double u);
// Uniform on the unit sphere (Archimedes: the height is uniform), in the unit disc, in the unit ball.
[[nodiscard]] glm::dvec3 direction(const std::array<double, 2>& u);
[[nodiscard]] glm::dvec2 disc_point(const std::array<double, 2>& u);
[[nodiscard]] glm::dvec3 ball_point(const std::array<double, 3>& u);
// Density ∝ cosine of the angle to the unit vector `normal`, as light leaves a diffuse surface.
[[nodiscard]] glm::dvec3 cosine_direction(const glm::dvec3& normal, const std::array<double, 2>& u);
// Two unit vectors that complete the unit vector `axis` to a right-handed frame (first, second, axis).
[[nodiscard]] std::array<glm::dvec3, 2> orthonormal_frame(const glm::dvec3& axis);

// Uniform (Haar measure, normalised to 1) rotations of space (Shoemake, Graphics Gems III) and of the plane.
[[nodiscard]] glm::dmat3 rotation(const std::array<double, 3>& u);
[[nodiscard]] glm::dmat2 planar_rotation(double u);
[[nodiscard]] glm::dvec3 box_point(const Aabb& box, const std::array<double, 3>& u);

// x ↦ rotation · x + translation, in the plane.
struct PlanarMotion {
    glm::dmat2 rotation{1.0};
    glm::dvec2 translation{0.0};
    [[nodiscard]] glm::dvec2 operator()(const glm::dvec2& x) const { return rotation * x + translation; }
};

// Uniform over the motions whose translation lies in `translations`. The measure of a set of motions is their share of
// all × that volume.
[[nodiscard]] RigidTransform motion(const Aabb& translations, const std::array<double, 6>& u);
// The same in the plane, with translations in the rectangle [low, high].
[[nodiscard]] PlanarMotion planar_motion(const glm::dvec2& low, const glm::dvec2& high, const std::array<double, 3>& u);

// `prototype` seen from a uniform position in `positions`, uniformly turned (forward and up are replaced).
[[nodiscard]] Camera random_camera(const Camera& prototype, const Aabb& positions, const std::array<double, 6>& u);

}  // namespace crofton::sampling
