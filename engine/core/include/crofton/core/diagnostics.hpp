// SPDX-License-Identifier: MIT
// What the engine tells its host: messages for a person, and a caller's mistakes.
#pragma once
#include <crofton/core/requirements.hpp>
#include <cstdint>
#include <string_view>

namespace crofton {

// Messages for a person, to the host's own log.

enum class LogLevel : std::uint8_t { debug, info, warning, error };

using LogHandler = void (*)(void* user, LogLevel level, std::string_view message);

// Installs a handler with its user pointer; nullptr restores the default: warnings and errors to stderr. Thread-safe.
void set_log_handler(LogHandler handler, void* user);

void log(LogLevel level, std::string_view message);

// A caller's mistake (as opposed to bad data) goes to a hook; the host decides whether to stop.

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
