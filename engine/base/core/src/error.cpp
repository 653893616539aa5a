// SPDX-License-Identifier: MIT
#include <crofton/core/error.hpp>

#include <cstdio>
#include <cstdlib>
#include <new>
#include <utility>

namespace crofton {

void detail::end_without_value(const Error& error) {
    std::fprintf(stderr, "crofton: %s: %s\n", to_string(error.code), error.message.c_str());
    std::abort();
}

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

Error::Error(const Error& other) noexcept : code(other.code), item(other.item) {
    try {
        message = other.message;
    } catch (const std::bad_alloc&) {
    }
}

Error& Error::operator=(const Error& other) noexcept {
    if (this != &other) *this = Error(other);
    return *this;
}

void MessagePart::append_to(std::string& message) const {
    switch (kind_) {
        case Kind::text:
            message += text_;
            break;
        case Kind::whole:
            message += std::to_string(whole_);
            break;
        case Kind::integer:
            message += std::to_string(integer_);
            break;
        case Kind::number:
            message += std::to_string(number_);
            break;
    }
}

Error fail(ErrorCode code, std::uint64_t item, std::initializer_list<MessagePart> message) noexcept {
    Error error{code, item, {}};
    try {
        for (const MessagePart& part : message) part.append_to(error.message);
    } catch (const std::bad_alloc&) {
        error.message.clear();
    }
    return error;
}

}  // namespace crofton
