// SPDX-License-Identifier: MIT
// Errors as values, the log, assertions.
#pragma once
#include <concepts>
#include <crofton/core/version.hpp>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <type_traits>
#include <utility>

namespace crofton {

// Bad data is reported as a value that names the item, never as an exception.

enum class ErrorCode : std::uint8_t {
    invalid_argument,  // a parameter is outside its documented range
    non_finite,        // a number is NaN or infinite
    out_of_range,      // an index or a size is beyond its limit
    degenerate,        // the geometry lacks the extent or rank that the operation needs
    empty,             // nothing to work on
    unsupported,       // well-formed, but not supported
    io,                // a file could not be read or written
    parse,             // a file is damaged or not of its format
    cancelled,         // a callback asked to stop
    budget_exceeded,   // a time or memory budget ran out before any usable result
    unavailable,       // a device or driver is missing
    stale_handle,      // the handle's object has been removed
    internal,          // a fault of Crofton: please report it
    out_of_memory,     // the memory hook returned none; the operation changed nothing
};

[[nodiscard]] const char* to_string(ErrorCode code);

inline constexpr std::uint64_t kNoItem = ~std::uint64_t{0};

// Describes one failure.
//
// `item` is the index of the bad input (vertex, instance, ring, …), or kNoItem. `message` says which input is bad, why,
// and what to do.
struct Error {
    ErrorCode code = ErrorCode::internal;
    std::uint64_t item = kNoItem;
    std::string message;

    Error() = default;
    Error(ErrorCode the_code, std::uint64_t the_item, std::string the_message = {}) noexcept
        : code(the_code), item(the_item), message(std::move(the_message)) {}
    // A copy has an empty message if there is no memory for it.
    Error(const Error& other) noexcept;
    Error& operator=(const Error& other) noexcept;
    Error(Error&&) noexcept = default;
    Error& operator=(Error&&) noexcept = default;
    ~Error() = default;
};

// Result::value() throws this if there is no value. If nothing catches it, the program ends with the error's message.
class BadResult : public tl::bad_expected_access<Error> {
  public:
    using tl::bad_expected_access<Error>::bad_expected_access;
    [[nodiscard]] const char* what() const noexcept override {
        return error().message.empty() ? to_string(error().code) : error().message.c_str();
    }
};

namespace detail {
[[noreturn]] void end_without_value(const Error& error);  // prints the message and aborts
}

// Holds a value, or the Error that says why there is none.
//
// The compiler warns if you ignore one. Test it, or write (void)world.update() if the call cannot fail.
template <class T>
class [[nodiscard]] Result : public tl::expected<T, Error> {
    using Base = tl::expected<T, Error>;

  public:
    Result() = default;
    Result(Base result) : Base(std::move(result)) {}
    Result(tl::unexpected<Error> error) : Base(std::move(error)) {}
    template <class U = T>
    requires(std::is_constructible_v<T, U&&> && !std::derived_from<std::remove_cvref_t<U>, Base> &&
             !std::same_as<std::remove_cvref_t<U>, tl::unexpected<Error>>) explicit(!std::is_convertible_v<U&&, T>)
        Result(U&& value)
        : Base(std::forward<U>(value)) {}

    // Returns the value; returns nothing for a Result<void>.
    //
    // If there is no value, it throws BadResult; if exceptions are disabled, it prints the message and ends the
    // program. Use it in tests, and in programs that end with the first error.
    std::add_lvalue_reference_t<const T> value() const& {
        demand();
        if constexpr (!std::is_void_v<T>) return **this;
    }
    std::add_lvalue_reference_t<T> value() & {
        demand();
        if constexpr (!std::is_void_v<T>) return **this;
    }
    std::add_rvalue_reference_t<T> value() && {
        demand();
        if constexpr (!std::is_void_v<T>) return std::move(**this);
    }

  private:
    void demand() const {
        if (this->has_value()) return;
#if defined(__cpp_exceptions) || defined(_CPPUNWIND)
        throw BadResult(this->error());
#else
        detail::end_without_value(this->error());
#endif
    }
};

// A text or a number of a message. It does not copy the text.
class MessagePart {
  public:
    MessagePart(const char* text) : text_(text), kind_(Kind::text) {}
    MessagePart(std::string_view text) : text_(text), kind_(Kind::text) {}
    MessagePart(const std::string& text) : text_(text), kind_(Kind::text) {}
    template <std::unsigned_integral T>
    MessagePart(T number) : whole_(number), kind_(Kind::whole) {}
    template <std::signed_integral T>
    MessagePart(T number) : integer_(number), kind_(Kind::integer) {}
    MessagePart(double number) : number_(number), kind_(Kind::number) {}
    // Errors: std::bad_alloc.
    void append_to(std::string& message) const;

  private:
    enum class Kind : std::uint8_t { text, whole, integer, number };
    std::string_view text_;
    union {
        std::uint64_t whole_ = 0;
        std::int64_t integer_;
        double number_;
    };
    Kind kind_;
};

// Makes an error. If there is no memory for the message, the message is empty; code and item are set all the same.
[[nodiscard]] tl::unexpected<Error> fail(ErrorCode code, std::uint64_t item,
                                         std::initializer_list<MessagePart> message) noexcept;
[[nodiscard]] inline tl::unexpected<Error> fail(ErrorCode code, std::uint64_t item, const char* message) noexcept {
    return fail(code, item, {MessagePart(message)});
}
// Takes a finished message. (A template, so that braces mean parts.)
template <std::same_as<std::string> String>
[[nodiscard]] tl::unexpected<Error> fail(ErrorCode code, std::uint64_t item, String message) {
    return tl::unexpected<Error>(Error{code, item, std::move(message)});
}

// ---- Log ----

enum class LogLevel : std::uint8_t { debug, info, warning, error };

using LogHandler = void (*)(void* user, LogLevel level, std::string_view message);

// Installs a handler with its user pointer. nullptr restores the default, which prints warnings and errors to stderr.
// Thread-safe.
void set_log_handler(LogHandler handler, void* user);

void log(LogLevel level, std::string_view message);

// A caller's mistake (as opposed to bad data) calls this hook; the host decides whether to stop.

using AssertHandler = void (*)(const char* condition, const char* message, const char* file, int line);

// Installs a handler. nullptr restores the default, which prints to stderr and aborts. Thread-safe.
void set_assert_handler(AssertHandler handler);

namespace detail {
void assert_failed(const char* condition, const char* message, const char* file, int line);
}

}  // namespace crofton

#if defined(CROFTON_ASSERTS)
#define CROFTON_ASSERT(condition, message) \
    ((condition) ? (void)0 : ::crofton::detail::assert_failed(#condition, message, __FILE__, __LINE__))
#else
#define CROFTON_ASSERT(condition, message) ((void)sizeof(!(condition)))
#endif
