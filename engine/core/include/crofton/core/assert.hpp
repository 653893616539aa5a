// SPDX-License-Identifier: MIT
// A caller's mistake (as opposed to bad data) goes to a hook; the host decides whether to stop.
#pragma once
#include <crofton/core/requirements.hpp>

namespace crofton {

using AssertHandler = void (*)(const char* condition, const char* message, const char* file, int line);

// Installs a handler; nullptr restores the default, which prints to stderr and aborts. Thread-safe.
void set_assert_handler(AssertHandler handler);

namespace detail {
void assert_failed(const char* condition, const char* message, const char* file, int line);
}

}  // namespace crofton

#if defined(CROFTON_ASSERTS)
#define CROFTON_ASSERT(condition, message) \
    ((condition) ? (void)0 : ::crofton::detail::assert_failed(#condition, message, __FILE__, __LINE__))
#else
#define CROFTON_ASSERT(condition, message) ((void)sizeof(!(condition)))
#endif
