// SPDX-License-Identifier: MIT
// What must hold, whatever the input; and how much of it was asked.
#pragma once
#include <cstdint>
#include <cstdio>
#include <cstdlib>

namespace crofton::fuzz {

// Counts of this process, printed when it ends, so that executions that judge nothing are seen.
class Tally {
  public:
    ~Tally() {
        if (executions_ == 0) return;
        std::fprintf(stderr, "fuzz: %llu executions, %llu judged, %llu demands\n", number(executions_), number(judged_),
                     number(demands_));
    }
    void execution() {
        ++executions_;
        judged_ += demands_ != demands_before_;
        demands_before_ = demands_;
    }
    void demand() { ++demands_; }

  private:
    static unsigned long long number(std::uint64_t n) { return n; }

    std::uint64_t executions_ = 0, judged_ = 0, demands_ = 0, demands_before_ = 0;
};
inline Tally tally;

// Requires that `what` holds: ends the process, which is how a fuzzer is told, or a test's case.
inline void demand(bool holds, const char* what) {
    tally.demand();
#ifdef DOCTEST_LIBRARY_INCLUDED
    REQUIRE_MESSAGE(holds, what);
#else
    if (holds) return;
    std::fprintf(stderr, "fuzz: %s\n", what);
    std::abort();
#endif
}

}  // namespace crofton::fuzz
