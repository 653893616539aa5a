// SPDX-License-Identifier: MIT
// The code of an error, safely: error() of a result that holds a value is undefined, and what lies there may well be 0,
// which is a code.
#pragma once
#include <crofton/core/error.hpp>
#include <optional>

namespace crofton::oracle {

template <class T>
std::optional<ErrorCode> code_of(const Result<T>& result) {
    return result.has_value() ? std::nullopt : std::optional(result.error().code);
}

}  // namespace crofton::oracle
