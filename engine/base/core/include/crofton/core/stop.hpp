// SPDX-License-Identifier: MIT
#pragma once
#include <crofton/core/version.hpp>

namespace crofton {

// Asks the caller whether long work should stop: return true to stop it. `user` is the caller's own; `share_done` is
// how much of the work is done, in [0, 1], and never decreases.
//
// Called now and then from any of the executor's threads, never from two at once, and not again once it has returned
// true. Must not throw.
using StopCallback = bool (*)(void* user, double share_done);

}  // namespace crofton
