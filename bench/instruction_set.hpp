// Benchmarks on an instruction set of one's choice: --instruction_set=AVX2.
#pragma once
#include <benchmark/benchmark.h>
#include <hwy/targets.h>

#include <cstdint>
#include <cstdio>
#include <cstring>

namespace crofton::bench {

// Takes --instruction_set=NAME (a target of Highway's: SSE4, AVX2, AVX3_DL, …) out of the arguments and lets the
// kernels run on nothing better. Writes into the results which one they ran on. False, with a message: this processor
// or build has no such target.
inline bool choose_instruction_set(int& argc, char** argv) {
    constexpr char kOption[] = "--instruction_set=";
    const std::int64_t supported = hwy::SupportedTargets();
    std::int64_t chosen = supported & -supported;  // the lowest bit is the best
    for (int i = 1; i < argc; ++i) {
        if (std::strncmp(argv[i], kOption, sizeof(kOption) - 1) != 0) continue;
        const char* const name = argv[i] + sizeof(kOption) - 1;
        chosen = 0;
        for (std::int64_t rest = supported; rest != 0; rest &= rest - 1)
            if (std::strcmp(hwy::TargetName(rest & -rest), name) == 0) chosen = rest & -rest;
        if (chosen == 0) return std::fprintf(stderr, "there is no instruction set %s here\n", name), false;
        hwy::SetSupportedTargetsForTest(chosen);
        for (int k = i; k + 1 < argc; ++k) argv[k] = argv[k + 1];
        --argc;
        break;
    }
    benchmark::AddCustomContext("instruction_set", hwy::TargetName(chosen));
    return true;
}

}  // namespace crofton::bench
