// SPDX-License-Identifier: MIT
// Ends a process that writes a file, by kill -9 at random moments.
#pragma once
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>
#include <cstdint>
#include <cstdlib>
#include <string>

namespace crofton::testing {

// How often tests kill: CROFTON_KILLS, or 30.
inline int kill_count() {
    const char* wanted = std::getenv("CROFTON_KILLS");
    return wanted ? std::atoi(wanted) : 30;
}

// Runs `write` in a child process again and again, and kills it after a time in [0, `longest_microseconds`) that
// depends on `seed`. True where the child was still at it.
template <class Write>
bool kill_while_writing(const Write& write, std::uint64_t seed, unsigned longest_microseconds) {
    const pid_t child = fork();
    if (child == 0)
        for (std::uint64_t round = 0;; ++round)
            if (!write(round)) _exit(1);
    seed = (seed + 1) * 0x9E3779B97F4A7C15u;
    ::usleep(static_cast<useconds_t>((seed >> 32) * longest_microseconds >> 32));
    ::kill(child, SIGKILL);
    int status = 0;
    ::waitpid(child, &status, 0);
    return WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL;
}

}  // namespace crofton::testing
