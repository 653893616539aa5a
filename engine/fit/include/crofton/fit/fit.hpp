// Oriented boxes around points, best by the criterion that the user's queries imply.
#pragma once
#include <crofton/core/executor.hpp>
#include <crofton/geometry/obb.hpp>
#include <crofton/measure/criterion.hpp>
#include <cstdint>
#include <span>

namespace crofton::fit {

enum class Quality : std::uint8_t {
    fast,   // a few passes over the points
    tight,  // local search from many frames to a flush optimum
    exact,  // the global optimum with a certificate
};

struct Options {
    measure::Criterion criterion = measure::minimal_perimeter();
    Quality quality = Quality::tight;
};

// Fits a box that contains every point exactly (in the sense of contains(Obb, point)). Deterministic.
// Errors: no points (empty); NaN, infinite or |coordinate| > 1e30, with the first bad index as the item.
[[nodiscard]] Result<Obb> fit_obb(std::span<const glm::vec3> points, const Options& options = {});
[[nodiscard]] Result<Obb> fit_obb(std::span<const glm::dvec3> points, const Options& options = {});

// A box with the given (orthonormal) axes around the points, as small as rounding allows: how a box is refitted when
// its points have moved.
[[nodiscard]] Result<Obb> fit_oriented(std::span<const glm::vec3> points, const glm::mat3& axes);
[[nodiscard]] Result<Obb> fit_oriented(std::span<const glm::dvec3> points, const glm::mat3& axes);

// A box that contains all the boxes, good by the criterion.
[[nodiscard]] Result<Obb> merge(std::span<const Obb> boxes, const measure::Criterion& criterion);

}  // namespace crofton::fit
