// SPDX-License-Identifier: MIT
// k-DOPs, convex polytopes with faces perpendicular to k/2 fixed directions, as an alternative to boxes and spheres.
#pragma once
#include <crofton/convex/shape.hpp>
#include <crofton/core/error.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/measure/measure.hpp>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <span>

namespace crofton::study {

// Returns half of a k-DOP's directions as unit vectors: the coordinate axes, and the cube's diagonals (14), its faces'
// diagonals (18), or both (26). Errors: k is none of 6, 14, 18, 26.
[[nodiscard]] Result<Vector<glm::dvec3>> k_dop_directions(std::uint32_t k);

// { x : low[i] ≤ dot(directions[i], x) ≤ high[i] }, and its corners.
struct KDop {
    Vector<glm::dvec3> directions;
    Vector<double> low, high;
    Vector<glm::dvec3> corners;
};

// Returns the smallest k-DOP with these directions around the points: every slab touches two of them. Directions may
// have any length whose square is neither 0 nor infinite.
//
// Errors: no points, NaN or infinite ones (by index); more than 64 directions; a direction that is 0 or not finite (by
// index); directions that all lie in a plane.
[[nodiscard]] Result<KDop> k_dop_around(std::span<const glm::dvec3> points, std::span<const glm::dvec3> directions);

struct BestKDop {
    KDop bound;
    glm::dmat3 rotation{1.0};  // of the directions
    double value = 0.0;
    double lower_bound = 0.0;  // no rotation of the directions has less
    std::uint64_t cells = 0;   // sets of rotations bounded
};

struct BestKDopOptions {
    double tolerance = 1e-2;         // stop when value − lower_bound ≤ tolerance · value …
    std::uint64_t max_cells = 5000;  // … or after this many sets of rotations
};

// Finds the best rotation of the directions as a whole.
//
// It searches downhill from several rotations, so the result is never worse than the unrotated directions. Then it uses
// branch and bound over all rotations. For each face the offset is at least a linear function of the turn minus a
// remainder of second order. V^(1/3), F^(1/2) and M are concave in the offsets (Brunn and Minkowski), so over a cell
// each is smallest in a corner (docs/notes/measure.md). `lower_bound` is never below the hull's own value. Errors: as
// k_dop_around; a criterion that fails validate; a hull without volume; a tolerance outside (0, 1).
[[nodiscard]] Result<BestKDop> best_k_dop(std::span<const glm::dvec3> points, std::span<const glm::dvec3> directions,
                                          const measure::Criterion& criterion, const BestKDopOptions& options = {});

// Returns the k-DOP as a hull for cull::classify. Its corners are rounded to floats and moved out by a few 2^-22 of
// their size until the hull contains every point, in exact arithmetic. Errors: no points; NaN or infinite ones (by
// index); points far outside the k-DOP; as convex::Hull::build.
[[nodiscard]] Result<convex::Hull> hull_around(const KDop& dop, std::span<const glm::dvec3> points);

}  // namespace crofton::study
