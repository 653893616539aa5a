// SPDX-License-Identifier: MIT
// Random numbers, and uniform directions, rotations, motions and cameras from them.
#pragma once
#include <array>
#include <crofton/core/requirements.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/geometry/shapes.hpp>
#include <cstddef>
#include <cstdint>
#include <glm/mat2x2.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace crofton::sampling {

// Random numbers that are the same bits on every machine, for any number of threads.

// The counter-based generator Philox4x32-10 (Salmon, Moraes, Dror, Shaw, "Parallel random numbers: as easy as 1, 2, 3",
// 2011): 2^64 streams per seed, each of 2^65 values, independent of one another; integer arithmetic only.
class Random {
  public:
    explicit Random(std::uint64_t seed, std::uint64_t stream = 0) : seed_(seed), stream_(stream) {}

    // 64 random bits.
    [[nodiscard]] std::uint64_t bits();
    // A multiple of 2^-53 in [0, 1).
    [[nodiscard]] double uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
    [[nodiscard]] double uniform(double low, double high) { return low + (high - low) * uniform(); }
    template <std::size_t D>
    [[nodiscard]] std::array<double, D> point() {
        std::array<double, D> result;
        for (double& x : result) x = uniform();
        return result;
    }

    // The generator's block function: 128 random bits for a counter under a key.
    using Block = std::array<std::uint32_t, 4>;
    [[nodiscard]] static Block block(const Block& counter, const std::array<std::uint32_t, 2>& key);

  private:
    std::uint64_t seed_, stream_;
    std::uint64_t position_ = 0;
    std::uint64_t spare_ = 0;
    bool has_spare_ = false;
};

enum class Sequence : std::uint8_t {
    pseudo_random,  // independent points: errors have the usual binomial size
    quasi_random,   // evenly spread points: smaller errors, but no binomial estimate of them; vary the seed for one
};

// Points of the unit cube [0, 1)^D, D ≤ 8, by number, so that trial i is the same whoever computes it.
// Quasi-random: Sobol's sequence with the direction numbers of Joe and Kuo ("Constructing Sobol sequences with better
// two-dimensional projections", 2008), digitally shifted by the seed. Spend powers of two of them.
class UnitPoints {
  public:
    explicit UnitPoints(std::uint64_t seed, Sequence sequence = Sequence::pseudo_random)
        : seed_(seed), sequence_(sequence) {}

    template <std::size_t D>
    requires(D <= 8) [[nodiscard]] std::array<double, D> at(std::uint64_t index) const {
        std::array<double, D> result;
        fill(index, result.data(), D);
        return result;
    }

  private:
    void fill(std::uint64_t index, double* coordinates, std::size_t dimensions) const;

    std::uint64_t seed_;
    Sequence sequence_;
};

// Uniform directions, rotations, motions and cameras, as functions of points u of the unit cube. Take these from Random
// or UnitPoints. Computed with + − × ÷ and square roots only: the same bits on every machine.

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
