// SPDX-License-Identifier: MIT
// The error of a result, safely: error() of a result that holds a value is undefined, and what lies there may well be
// what a test expects.
#pragma once
#include <doctest/doctest.h>
#include <crofton/core/error.hpp>

namespace crofton {

// Fails the test where there is a value. Found by the argument: no namespace is needed.
template <class T>
Error error_of(const Result<T>& result) {
    CHECK_MESSAGE(!result.has_value(), "expected an error, and there is a value");
    return result.has_value() ? Error{} : result.error();
}

}  // namespace crofton
