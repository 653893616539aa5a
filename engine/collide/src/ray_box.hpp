// A ray against a box, both known to be valid.
#pragma once
#include <crofton/collide/ray.hpp>
#include <optional>

namespace crofton::collide {

[[nodiscard]] std::optional<double> entry_of(const Ray& ray, const Obb& box);

}  // namespace crofton::collide
