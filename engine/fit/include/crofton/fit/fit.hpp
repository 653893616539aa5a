// SPDX-License-Identifier: MIT
// Oriented boxes around points, best by a criterion that the user's queries imply.
#pragma once
#include <crofton/core/executor.hpp>
#include <crofton/geometry/obb.hpp>
#include <crofton/measure/criterion.hpp>
#include <cstdint>
#include <span>

namespace crofton::fit {

enum class Quality : std::uint8_t {
    fast,   // a local search with little effort: within 0.3 % of the optimum on average (docs/notes/fit.md)
    tight,  // a local search from many frames: within 0.03 % on average
    exact,  // the global optimum, proved; fit_exact also returns the proof's bound
};

struct FitOptions {
    measure::Criterion criterion = measure::minimal_perimeter();
    Quality quality = Quality::tight;
};

// A box that contains every point exactly, in the sense of contains(Obb, point). The same bits for any order and
// duplication of the points and any instruction set; −0 counts as 0.
// Errors: no points (empty); a coordinate that is NaN, infinite or beyond 1e30 in magnitude (the item is the first such
// point); weights that are negative, not finite or all zero.
[[nodiscard]] Result<Obb> fit_obb(std::span<const glm::vec3> points, const FitOptions& options = {});
[[nodiscard]] Result<Obb> fit_obb(std::span<const glm::dvec3> points, const FitOptions& options = {});

// The box with the given orthonormal axes around the points: refits a box whose points have moved. Its half extents are
// the least floats that hold all points around its centre. Errors: as fit_obb; axes that are not orthonormal.
[[nodiscard]] Result<Obb> fit_oriented(std::span<const glm::vec3> points, const glm::mat3& axes);
[[nodiscard]] Result<Obb> fit_oriented(std::span<const glm::dvec3> points, const glm::mat3& axes);

// A box that contains all the boxes, locally best by the criterion. One box is returned as it is.
// Errors: no boxes (empty); a box that is not valid, by index.
[[nodiscard]] Result<Obb> merge(std::span<const Obb> boxes, const measure::Criterion& criterion);

}  // namespace crofton::fit
