// SPDX-License-Identifier: MIT
// What the oracles of the tests ask of a number, for Dyadic, which never rounds.
#pragma once
#include <crofton/geometry/dyadic.hpp>

namespace crofton {

[[nodiscard]] inline int sgn(const Dyadic& number) {
    return number.sign();
}

}  // namespace crofton
