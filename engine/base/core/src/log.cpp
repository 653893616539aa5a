// SPDX-License-Identifier: MIT
#include <crofton/core/error.hpp>
#include <cstdio>
#include <mutex>

namespace crofton {
namespace {

void print_warnings(void*, LogLevel level, std::string_view message) {
    if (level < LogLevel::warning) return;
    std::fprintf(stderr, "crofton: %s: %.*s\n", level == LogLevel::warning ? "warning" : "error",
                 static_cast<int>(message.size()), message.data());
}

struct Sink {
    std::mutex mutex;
    LogHandler handler = print_warnings;
    void* user = nullptr;
};

Sink& sink() {
    static Sink instance;
    return instance;
}

}  // namespace

void set_log_handler(LogHandler handler, void* user) {
    const std::lock_guard lock(sink().mutex);
    sink().handler = handler ? handler : print_warnings;
    sink().user = handler ? user : nullptr;
}

void log(LogLevel level, std::string_view message) {
    LogHandler handler;
    void* user;
    {
        const std::lock_guard lock(sink().mutex);
        handler = sink().handler;
        user = sink().user;
    }
    handler(user, level, message);
}

}  // namespace crofton
