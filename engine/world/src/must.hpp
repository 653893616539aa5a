// SPDX-License-Identifier: MIT
#pragma once
#include <crofton/core/error.hpp>

namespace crofton::world {

// Of calls that fail only where the parts of a World disagree.
inline void must([[maybe_unused]] const Result<void>& done) {
    CROFTON_ASSERT(done.has_value(), "the parts of a World disagree");
}

}  // namespace crofton::world
