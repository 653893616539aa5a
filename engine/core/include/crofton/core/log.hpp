// SPDX-License-Identifier: MIT
// Messages for a person, to the host's own log.
#pragma once
#include <crofton/core/requirements.hpp>
#include <cstdint>
#include <string_view>

namespace crofton {

enum class LogLevel : std::uint8_t { debug, info, warning, error };

using LogHandler = void (*)(void* user, LogLevel level, std::string_view message);

// Installs a handler with its user pointer; nullptr restores the default: warnings and errors to stderr. Thread-safe.
void set_log_handler(LogHandler handler, void* user);

void log(LogLevel level, std::string_view message);

}  // namespace crofton
