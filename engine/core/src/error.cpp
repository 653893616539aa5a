// SPDX-License-Identifier: MIT
#include <crofton/core/error.hpp>

#include <new>
#include <utility>

namespace crofton {

const char* to_string(ErrorCode code) {
    switch (code) {
        case ErrorCode::invalid_argument:
            return "invalid argument";
        case ErrorCode::non_finite:
            return "not finite";
        case ErrorCode::out_of_range:
            return "out of range";
        case ErrorCode::degenerate:
            return "degenerate";
        case ErrorCode::empty:
            return "empty";
        case ErrorCode::unsupported:
            return "unsupported";
        case ErrorCode::io:
            return "input/output";
        case ErrorCode::parse:
            return "parse";
        case ErrorCode::cancelled:
            return "cancelled";
        case ErrorCode::budget_exceeded:
            return "budget exceeded";
        case ErrorCode::unavailable:
            return "unavailable";
        case ErrorCode::stale_handle:
            return "stale handle";
        case ErrorCode::internal:
            return "internal";
        case ErrorCode::out_of_memory:
            return "out of memory";
    }
    return "unknown";
}

tl::unexpected<Error> fail(ErrorCode code, std::uint64_t item, const char* message) {
    Error error{code, item, {}};
    try {
        error.message = message;
    } catch (const std::bad_alloc&) {
    }
    return tl::unexpected<Error>(std::move(error));
}

}  // namespace crofton
