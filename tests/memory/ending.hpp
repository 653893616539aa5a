// SPDX-License-Identifier: MIT
// Operations that end the program where memory ends: each try is a process of its own, forked from the same state.
#pragma once
#include <doctest/doctest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <string>

#include "failing_memory.hpp"

namespace crofton::testing {

inline int endings_tried = 0, endings_survived = 0;

// How one process ended whose n-th allocation failed.
struct Ending {
    bool failed = false;    // an allocation did
    bool survived = false;  // and the operation returned all the same
    bool is_abort = false;  // the program was ended on purpose
    std::string said;
};

inline constexpr int kNothingFailed = 10, kSurvived = 11, kThrew = 12;

template <class Operation>
Ending end_of(std::int64_t n, const Operation& operation) {
    int ends[2];
    REQUIRE(pipe(ends) == 0);
    const pid_t child = fork();
    REQUIRE(child >= 0);
    if (child == 0) {
        dup2(ends[1], STDERR_FILENO);
        for (const int signal : {SIGABRT, SIGSEGV, SIGFPE, SIGILL, SIGBUS}) std::signal(signal, SIG_DFL);
        has_failed = false;
        allocations_left = n;
        try {
            operation();
        } catch (...) {
            _exit(kThrew);
        }
        allocations_left = kNever;
        _exit(has_failed ? kSurvived : kNothingFailed);
    }
    close(ends[1]);
    Ending ending;
    char part[256];
    for (ssize_t count = 0; (count = read(ends[0], part, sizeof part)) > 0;)
        ending.said.append(part, static_cast<std::size_t>(count));
    close(ends[0]);
    int status = 0;
    REQUIRE(waitpid(child, &status, 0) == child);
    ending.survived = WIFEXITED(status) && WEXITSTATUS(status) == kSurvived;
    ending.failed = !(WIFEXITED(status) && WEXITSTATUS(status) == kNothingFailed);
    ending.is_abort = WIFSIGNALED(status) && WTERMSIG(status) == SIGABRT;
    return ending;
}

// Every allocation of the operation fails once: the program ends with the documented message, or the operation
// returns. `operation` may change what it likes: each try begins with the state of now.
template <class Operation>
void sweep_ending(const char* name, const Operation& operation) {
    CAPTURE(std::string(name));
    for (std::int64_t n = 0;; ++n) {
        CAPTURE(n);
        const Ending ending = end_of(n, operation);
        if (!ending.failed) {
            CHECK(n > 0);  // else the operation is no test
            return;
        }
        ++endings_tried;
        endings_survived += ending.survived;
        CAPTURE(ending.said);
        REQUIRE((ending.survived || ending.is_abort));
        if (ending.is_abort) REQUIRE(ending.said.find("crofton: out of memory") != std::string::npos);
    }
}

}  // namespace crofton::testing
