// SPDX-License-Identifier: MIT
#include <atomic>
#include <crofton/core/error.hpp>
#include <cstdio>
#include <cstdlib>

namespace crofton {
namespace {

void print_and_abort(const char* condition, const char* message, const char* file, int line) {
    std::fprintf(stderr, "crofton: %s:%d: %s (%s)\n", file, line, message, condition);
    std::abort();
}

std::atomic<AssertHandler> handler_in_force{print_and_abort};

}  // namespace

void set_assert_handler(AssertHandler handler) {
    handler_in_force = handler ? handler : print_and_abort;
}

void detail::assert_failed(const char* condition, const char* message, const char* file, int line) {
    handler_in_force.load()(condition, message, file, line);
}

}  // namespace crofton
