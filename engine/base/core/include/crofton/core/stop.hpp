// SPDX-License-Identifier: MIT
// Defines the callback by which a caller ends a long operation.
#pragma once
#include <crofton/core/version.hpp>

namespace crofton {

// Asks the caller whether a long operation should stop; return true to stop it. `user` is your own pointer.
// `share_done` is the finished share of the work, in [0, 1]; it never decreases.
//
// It is called now and then on any of the executor's threads, but never on two at once, and not again after it has
// returned true. Must not throw.
using StopCallback = bool (*)(void* user, double share_done);

}  // namespace crofton
