// SPDX-License-Identifier: MIT
// Runs exact fits with a temporary Fitter.
#include <crofton/core/recovery.hpp>
#include <crofton/fit/fit.hpp>

#include "fitter.hpp"

namespace crofton::fit {

Result<ExactFit> fit_exact(std::span<const glm::vec3> points, const ExactOptions& options) {
    return detail::recover([&]() -> Result<ExactFit> { return Fitter().exact(points, options); });
}
Result<ExactFit> fit_exact(std::span<const glm::dvec3> points, const ExactOptions& options) {
    return detail::recover([&]() -> Result<ExactFit> { return Fitter().exact(points, options); });
}

}  // namespace crofton::fit
