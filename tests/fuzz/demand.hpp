// SPDX-License-Identifier: MIT
// What must hold, whatever the input.
#pragma once
#include <cstdio>
#include <cstdlib>

namespace crofton::fuzz {

// Ends the process, which is how a fuzzer is told; the text says what failed.
inline void demand(bool holds, const char* what) {
    if (holds) return;
    std::fprintf(stderr, "fuzz: %s\n", what);
    std::abort();
}

}  // namespace crofton::fuzz
