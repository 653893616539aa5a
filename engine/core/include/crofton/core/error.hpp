// SPDX-License-Identifier: MIT
// How bad data is reported: a value that names the item, never an exception.
#pragma once
#include <crofton/core/requirements.hpp>
#include <cstdint>
#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace crofton {

enum class ErrorCode : std::uint8_t {
    invalid_argument,  // a parameter outside its documented range
    non_finite,        // NaN or infinity where a finite number is needed
    out_of_range,      // an index or a size beyond its limit
    degenerate,        // geometry without the extent or rank the operation needs
    empty,             // nothing to work on
    unsupported,       // well-formed, but not something we handle
    io,                // a file could not be read or written
    parse,             // a file's contents are damaged or not of its format
    cancelled,         // a callback asked to stop
    budget_exceeded,   // a time or memory budget ran out before any usable result
    unavailable,       // a device or driver is missing
    stale_handle,      // a handle of something that has been removed
    internal,          // our mistake: please report it
    out_of_memory,     // the memory hook had none; the operation changed nothing
};

[[nodiscard]] const char* to_string(ErrorCode code);

inline constexpr std::uint64_t kNoItem = ~std::uint64_t{0};

// `item` is the index of the offending input (vertex, instance, ring, …) or kNoItem; `message` says which, why and what
// to do.
struct Error {
    ErrorCode code = ErrorCode::internal;
    std::uint64_t item = kNoItem;
    std::string message;
};

template <class T>
using Result = tl::expected<T, Error>;

[[nodiscard]] inline tl::unexpected<Error> fail(ErrorCode code, std::uint64_t item, std::string message) {
    return tl::unexpected<Error>(Error{code, item, std::move(message)});
}

}  // namespace crofton
