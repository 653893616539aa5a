// SPDX-License-Identifier: MIT
#include <cmath>
#include <crofton/geometry/shapes.hpp>
#include <glm/geometric.hpp>

namespace crofton {

Result<void> validate(const Ray& ray, std::uint64_t item) {
    const glm::dvec3 sum = ray.origin + ray.direction;
    if (!std::isfinite(sum.x + sum.y + sum.z))
        return fail(ErrorCode::non_finite, item, "ray: the origin or direction is not finite");
    if (!(glm::dot(ray.direction, ray.direction) > 0.0))
        return fail(ErrorCode::degenerate, item, "ray: the direction is zero, or too short for double");
    if (!(ray.max_t >= 0.0)) return fail(ErrorCode::invalid_argument, item, "ray: max_t is negative or NaN");
    return {};
}

}  // namespace crofton
