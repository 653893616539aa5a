// SPDX-License-Identifier: MIT
// Reports zones to the host's profiler.
#pragma once
#include <crofton/world/world.hpp>

namespace crofton::world {

// From here to the end of the block is a zone.
class TraceZone {
  public:
    TraceZone(const TraceHooks& hooks, const char* name) : hooks_(hooks), name_(name) {
        if (hooks_.begin) hooks_.begin(hooks_.user, name_);
    }
    ~TraceZone() {
        if (hooks_.end) hooks_.end(hooks_.user, name_);
    }
    TraceZone(const TraceZone&) = delete;
    TraceZone& operator=(const TraceZone&) = delete;

  private:
    const TraceHooks& hooks_;
    const char* name_;
};

inline void trace_count(const TraceHooks& hooks, const char* counter, std::size_t value) {
    if (hooks.count) hooks.count(hooks.user, counter, static_cast<double>(value));
}

}  // namespace crofton::world
