// SPDX-License-Identifier: MIT
// Paths in the form that the operating system expects.
#pragma once
#include <crofton/core/error.hpp>
#include <string>

namespace crofton::bake {

// The system would cut a path at a zero byte, and open another file than was asked for.
[[nodiscard]] inline Result<void> check_path(const std::string& path) {
    if (path.find('\0') == std::string::npos) return {};
    return fail(ErrorCode::invalid_argument, kNoItem, {path.c_str(), ": the path goes on after a zero byte"});
}

}  // namespace crofton::bake
