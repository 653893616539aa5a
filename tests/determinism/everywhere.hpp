// SPDX-License-Identifier: MIT
// One answer on every instruction set that this processor has, alone and on threads.
#pragma once
#include <doctest/doctest.h>
#include <hwy/targets.h>
#include <crofton/core/executor.hpp>
#include <cstdint>
#include <sstream>

namespace crofton::test {

[[nodiscard]] inline std::string hex(std::uint64_t number) {
    std::ostringstream text;
    text << "0x" << std::hex << number;
    return text.str();
}

// answer(executor) is the digest of what was computed. `published` is the same on every machine: it was taken from runs
// whose answers an oracle had confirmed, as the tests here go on to do.
template <class Answer>
void check_everywhere(std::uint64_t published, Answer answer) {
    ThreadPool pool(3);
    for (std::int64_t rest = hwy::SupportedTargets(); rest != 0; rest &= rest - 1) {
        hwy::SetSupportedTargetsForTest(rest & -rest);
        CAPTURE(hwy::TargetName(rest & -rest));
        CHECK(hex(answer(serial_executor())) == hex(published));
    }
    hwy::SetSupportedTargetsForTest(0);
    CHECK(hex(answer(pool)) == hex(published));
}

}  // namespace crofton::test
