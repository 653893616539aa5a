// SPDX-License-Identifier: MIT
// Random numbers, random motions, and global lines.
#pragma once
#include <array>
#include <crofton/core/memory.hpp>
#include <crofton/core/version.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/geometry/mesh.hpp>
#include <crofton/geometry/shapes.hpp>
#include <cstddef>
#include <cstdint>
#include <glm/mat2x2.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace crofton::sampling {

// Random numbers with the same bits on every machine and for any number of threads.

// The counter-based generator Philox4x32-10 (Salmon, Moraes, Dror, Shaw, "Parallel random numbers: as easy as 1, 2, 3",
// 2011). Each seed has 2^64 independent streams of 2^65 values. It uses integer arithmetic only.
class Random {
  public:
    explicit Random(std::uint64_t seed, std::uint64_t stream = 0) : seed_(seed), stream_(stream) {}

    // Returns 64 random bits.
    [[nodiscard]] std::uint64_t bits();
    // Fills `numbers` with the next results of `bits`.
    void fill(std::span<std::uint64_t> numbers);
    // Returns a multiple of 2^-53 in [0, 1).
    [[nodiscard]] double uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
    [[nodiscard]] double uniform(double low, double high) { return low + (high - low) * uniform(); }
    template <std::size_t D>
    [[nodiscard]] std::array<double, D> point() {
        std::array<double, D> result;
        for (double& x : result) x = uniform();
        return result;
    }

    // Returns 128 random bits for a counter under a key: the generator's block function.
    using Block = std::array<std::uint32_t, 4>;
    [[nodiscard]] static Block block(const Block& counter, const std::array<std::uint32_t, 2>& key);

  private:
    std::uint64_t seed_, stream_;
    std::uint64_t position_ = 0;
    std::uint64_t spare_ = 0;
    bool has_spare_ = false;
};

// Returns the seed of repetition `number` of `count` under one seed. Repetitions under different seeds never share a
// seed, as they would with `seed + number`. For seed 1 they are 1, 2, 3, …
[[nodiscard]] constexpr std::uint64_t seed_of_repetition(std::uint64_t seed, std::uint64_t number,
                                                         std::uint64_t count) {
    return 1 + (seed - 1) * count + number;
}

enum class Sequence : std::uint8_t {
    pseudo_random,  // independent points: errors have the usual binomial size
    quasi_random,   // evenly spread points: smaller errors, but no binomial estimate of them; vary the seed for one
};

// Numbered points of the unit cube [0, 1)^D, D ≤ 8. Point i does not depend on which thread computes it.
//
// Quasi-random points are Sobol's sequence with the direction numbers of Joe and Kuo ("Constructing Sobol sequences
// with better two-dimensional projections", 2008), digitally shifted by the seed. Use a power of two of them.
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

// Uniform directions, rotations, motions and cameras, as functions of points u of the unit cube, which come from Random
// or UnitPoints. They use only + − × ÷ and square roots, so they have the same bits on every machine.

// Returns (cos 2πu, sin 2πu) within 2e-16, for u in [0, 1].
[[nodiscard]] glm::dvec2 circle_point(double u);
// Return uniform points on the unit sphere (Archimedes: the height is uniform), in the unit disc, and in the unit ball.
[[nodiscard]] glm::dvec3 direction(const std::array<double, 2>& u);
[[nodiscard]] glm::dvec2 disc_point(const std::array<double, 2>& u);
[[nodiscard]] glm::dvec3 ball_point(const std::array<double, 3>& u);
// Returns a direction with density ∝ the cosine of its angle to the unit vector `normal`, as light leaves a diffuse
// surface.
[[nodiscard]] glm::dvec3 cosine_direction(const glm::dvec3& normal, const std::array<double, 2>& u);
// Returns two unit vectors that complete the unit vector `axis` to a right-handed frame (first, second, axis).
[[nodiscard]] std::array<glm::dvec3, 2> orthonormal_frame(const glm::dvec3& axis);

// Return uniform rotations (Haar measure, normalised to 1) of space (Shoemake, Graphics Gems III) and of the plane.
[[nodiscard]] glm::dmat3 rotation(const std::array<double, 3>& u);
[[nodiscard]] glm::dmat2 planar_rotation(double u);
[[nodiscard]] glm::dvec3 box_point(const Aabb& box, const std::array<double, 3>& u);

// A motion of the plane: x ↦ rotation · x + translation.
struct PlanarMotion {
    glm::dmat2 rotation{1.0};
    glm::dvec2 translation{0.0};
    [[nodiscard]] glm::dvec2 operator()(const glm::dvec2& x) const { return rotation * x + translation; }
};

// Returns a uniform motion whose translation lies in `translations`. The measure of a set of motions is its share of
// all of them × that volume.
[[nodiscard]] RigidTransform motion(const Aabb& translations, const std::array<double, 6>& u);
// Returns a uniform motion of the plane with a translation in the rectangle [low, high].
[[nodiscard]] PlanarMotion planar_motion(const glm::dvec2& low, const glm::dvec2& high, const std::array<double, 3>& u);

// Returns `prototype` at a uniform position in `positions`, with a uniform rotation: forward and up are replaced.
[[nodiscard]] Camera random_camera(const Camera& prototype, const Aabb& positions, const std::array<double, 6>& u);

// Uniform random lines through a region: no place and no direction is preferred (docs/theory.md, section 6). The signs
// of directions are uniform too unless a function says otherwise.

// Returns the motion-invariant measure of the undirected lines that meet a convex body of this surface area: π·area/2.
//
// N·F_B/F_A of N uniform lines through a convex body A meet a convex B inside it on average. They cross a surface of
// area S inside it 2·N·S/F_A times on average, which is N·S/(2πR²) for a sphere.
[[nodiscard]] double measure_of_lines(double surface_area);

// (a) Returns the line through two independent uniform points of the sphere. It starts at one and points to the other.
[[nodiscard]] Line line_through_two_sphere_points(const Sphere& ball, const std::array<double, 4>& u);

// (b) Returns a line of uniform direction through a uniform point of the orthogonal disc through the centre.
[[nodiscard]] Line line_through_disc(const Sphere& ball, const std::array<double, 4>& u);

// (c) Appends a bundle of parallel lines: a uniform direction, and a square grid of cell area Δ in the plane orthogonal
// to it, rotated and shifted at random. Each cell has one line, uniform in it. Only lines that meet the ball are
// appended, πR²/Δ on average.
//
// A bundle crosses a surface of area S inside the ball S/(2Δ) times on average. Requires cell_area > 0 and at most 2^31
// cells across the ball's projection.
void append_line_bundle(const Sphere& ball, double cell_area, Random& random, Vector<Line>& lines);

// (d) Returns a line from a uniform point of a box's surface inward, cosine-weighted. It starts on the surface.
// Requires a box of at least two positive extents.
[[nodiscard]] Line line_from_box(const Aabb& box, const std::array<double, 5>& u);
[[nodiscard]] Line line_from_box(const Obb& box, const std::array<double, 5>& u);

// (d) for a convex polytope, given by a closed triangle mesh, counter-clockwise from outside. The tighter the polytope,
// the fewer lines miss the objects inside. Convexity is not checked.
class LinesFromHull {
  public:
    // Errors: as validate(TriangleMesh); an empty mesh; a mesh without area.
    [[nodiscard]] static Result<LinesFromHull> make(const TriangleMesh& hull);
    [[nodiscard]] Line operator()(const std::array<double, 5>& u) const;
    [[nodiscard]] double area() const { return cumulative_area_.back(); }

  private:
    struct Face {
        glm::dvec3 corner, first_edge, second_edge, inward_normal;
    };
    Vector<Face> faces_;
    Vector<double> cumulative_area_;
};

}  // namespace crofton::sampling
