// SPDX-License-Identifier: MIT
#include <crofton/core/recovery.hpp>
#include <crofton/fit/fit.hpp>

#include "cloud/enclose.hpp"
#include "fitter.hpp"

namespace crofton::fit {

Result<Obb> fit_obb(std::span<const glm::vec3> points, const FitOptions& options) {
    return detail::recover([&]() -> Result<Obb> { return Fitter().fit(points, options); });
}
Result<Obb> fit_obb(std::span<const glm::dvec3> points, const FitOptions& options) {
    return detail::recover([&]() -> Result<Obb> { return Fitter().fit(points, options); });
}

namespace {

template <class Point>
Result<Obb> around(std::span<const Point> points, const glm::mat3& axes) {
    Obb shape;
    shape.axes = axes;
    if (auto valid = validate(shape); !valid) return valid.error();
    PointCloud cloud;
    if (auto valid = cloud.assign(points); !valid) return valid.error();
    return cloud.has_more_than(kSmallSet) ? enclose(cloud, axes) : enclose_small_set(cloud, axes);
}

}  // namespace

Result<Obb> fit_oriented(std::span<const glm::vec3> points, const glm::mat3& axes) {
    return detail::recover([&]() -> Result<Obb> { return around(points, axes); });
}
Result<Obb> fit_oriented(std::span<const glm::dvec3> points, const glm::mat3& axes) {
    return detail::recover([&]() -> Result<Obb> { return around(points, axes); });
}

}  // namespace crofton::fit
