// SPDX-License-Identifier: MIT
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/core/recovery.hpp>

namespace crofton::world {

// Of calls that fail only where the parts of a World disagree.
inline void require_ok(const Result<void>& done) {
    detail::give_up_without_memory(done);
    CROFTON_ASSERT(done.has_value(), "the parts of a World disagree");
}

}  // namespace crofton::world
