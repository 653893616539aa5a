// SPDX-License-Identifier: MIT
// Checks which bounds an object may have.
#pragma once
#include <cmath>
#include <crofton/core/error.hpp>
#include <crofton/world/inputs.hpp>

namespace crofton::world {

// `without` is the error of a bound that is none.
[[nodiscard]] inline Result<void> validate(const Bound& bound, std::uint64_t item, const char* without) {
    if (bound.kind == BoundKind::none) return fail(ErrorCode::invalid_argument, item, without);
    if (bound.kind == BoundKind::sphere && !(bound.radius >= 0.0))
        return fail(std::isnan(bound.radius) ? ErrorCode::non_finite : ErrorCode::invalid_argument, item,
                    "sphere: the radius is negative or NaN");
    return crofton::validate(bound.box, item);
}

}  // namespace crofton::world
