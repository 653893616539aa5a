// SPDX-License-Identifier: MIT
#include "interrupt.hpp"

#include <csignal>
#include <initializer_list>

namespace crofton::cli {
namespace {
volatile std::sig_atomic_t caught = 0;
}

void catch_interrupts() {
    struct sigaction action {};
    action.sa_handler = [](int) { caught = 1; };
    action.sa_flags = static_cast<int>(SA_RESETHAND);
    for (const int signal : {SIGINT, SIGTERM}) sigaction(signal, &action, nullptr);
}

bool interrupted() {
    return caught != 0;
}

bool go_on(void*, double) {
    return !interrupted();
}

}  // namespace crofton::cli
