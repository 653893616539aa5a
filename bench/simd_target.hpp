// SPDX-License-Identifier: MIT
// Restricts the library's kernels to one instruction set: the option --target=NAME of the benchmarks.
#pragma once
#include <hwy/targets.h>
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <string_view>

namespace crofton::bench {

// Takes `--target=NAME` out of the arguments, NAME as Highway spells it (AVX2, SSE4, AVX3_DL …). Without it the best
// target of this processor runs. False, with a message, if this processor or build does not have the target.
inline bool take_target_option(int& argc, char** argv) {
    constexpr std::string_view kOption = "--target=";
    for (int i = 1; i < argc; ++i) {
        const std::string_view argument = argv[i];
        if (!argument.starts_with(kOption)) continue;
        const std::string_view name = argument.substr(kOption.size());
        std::int64_t found = 0;
        for (std::int64_t rest = hwy::SupportedTargets(); rest != 0; rest &= rest - 1)
            if (name == hwy::TargetName(rest & -rest)) found = rest & -rest;
        if (found == 0) {
            std::fprintf(stderr, "%s: not available here; there are:", argv[i]);
            for (std::int64_t rest = hwy::SupportedTargets(); rest != 0; rest &= rest - 1)
                std::fprintf(stderr, " %s", hwy::TargetName(rest & -rest));
            std::fputc('\n', stderr);
            return false;
        }
        hwy::SetSupportedTargetsForTest(found);
        std::copy(argv + i + 1, argv + argc, argv + i);
        --argc;
        --i;
    }
    return true;
}

// The instruction set that the kernels use from now on.
[[nodiscard]] inline const char* target_in_use() {
    const std::int64_t targets = hwy::SupportedTargets();
    return hwy::TargetName(targets & -targets);
}

}  // namespace crofton::bench
