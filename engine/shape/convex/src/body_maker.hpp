// SPDX-License-Identifier: MIT
// Bodies whose numbers are known to be good.
#pragma once
#include <crofton/convex/body.hpp>

namespace crofton::convex {

struct BodyMaker {
    [[nodiscard]] static Body triangle(const Triangle& corners);
};

}  // namespace crofton::convex
