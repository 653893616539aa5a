// SPDX-License-Identifier: MIT
// Errors as values, the log, assertions.
#pragma once
#include <concepts>
#include <crofton/core/version.hpp>
#include <cstdint>
#include <exception>
#include <initializer_list>
#include <new>
#include <string>
#include <string_view>
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
class BadResult : public std::exception {
  public:
    explicit BadResult(Error error) noexcept : error_(std::move(error)) {}
    [[nodiscard]] const Error& error() const noexcept { return error_; }
    [[nodiscard]] const char* what() const noexcept override {
        return error_.message.empty() ? to_string(error_.code) : error_.message.c_str();
    }

  private:
    Error error_;
};

namespace detail {
struct Nothing {};                                        // the value of a Result<void>
[[noreturn]] void end_without_value(const Error& error);  // prints the message and aborts
}  // namespace detail

// Holds a value, or the Error that says why there is none.
//
// The compiler warns if you ignore one. Test it, or write (void)world.update() if the call cannot fail. To pass an
// error on, return it: `if (!tree) return tree.error();`
template <class T>
class [[nodiscard]] Result {
    using Value = std::conditional_t<std::is_void_v<T>, detail::Nothing, T>;
    static constexpr bool kMoves = std::is_nothrow_move_constructible_v<Value>;

  public:
    Result() requires std::default_initializable<Value> : value_(), has_value_(true) {}
    Result(Error error) noexcept : error_(std::move(error)), has_value_(false) {}
    template <class U = T>
    requires(std::is_constructible_v<Value, U&&> && !std::same_as<std::remove_cvref_t<U>, Result> &&
             !std::same_as<std::remove_cvref_t<U>, Error>) explicit(!std::is_convertible_v<U&&, Value>)
        Result(U&& value)
        : value_(std::forward<U>(value)), has_value_(true) {}
    Result(const Result& other) requires std::is_copy_constructible_v<Value> { take(other); }
    Result(Result&& other) noexcept(kMoves) { take(std::move(other)); }
    Result& operator=(const Result& other) requires std::is_copy_constructible_v<Value> {
        return *this = Result(other);
    }
    Result& operator=(Result&& other) noexcept {
        static_assert(kMoves);
        if (this == &other) return *this;
        clear();
        take(std::move(other));
        return *this;
    }
    ~Result() { clear(); }

    [[nodiscard]] bool has_value() const noexcept { return has_value_; }
    explicit operator bool() const noexcept { return has_value_; }

    // Return the value. Requires has_value().
    const Value& operator*() const& noexcept { return value_; }
    Value& operator*() & noexcept { return value_; }
    Value&& operator*() && noexcept { return std::move(value_); }
    const Value* operator->() const noexcept { return &value_; }
    Value* operator->() noexcept { return &value_; }

    // Returns the value, or `other` if there is none.
    Value value_or(Value other) const& { return has_value_ ? value_ : std::move(other); }

    // Returns the error. Requires !has_value().
    [[nodiscard]] const Error& error() const& noexcept { return error_; }
    [[nodiscard]] Error& error() & noexcept { return error_; }
    [[nodiscard]] Error&& error() && noexcept { return std::move(error_); }

    // Returns the value; returns nothing for a Result<void>.
    //
    // If there is no value, it throws BadResult; if exceptions are disabled, it prints the message and ends the
    // program. Use it in tests, and in programs that end with the first error.
    std::add_lvalue_reference_t<const T> value() const& {
        demand();
        if constexpr (!std::is_void_v<T>) return value_;
    }
    std::add_lvalue_reference_t<T> value() & {
        demand();
        if constexpr (!std::is_void_v<T>) return value_;
    }
    std::add_rvalue_reference_t<T> value() && {
        demand();
        if constexpr (!std::is_void_v<T>) return std::move(value_);
    }

  private:
    template <class Other>
    void take(Other&& other) {
        has_value_ = other.has_value_;
        if (has_value_)
            ::new (static_cast<void*>(&value_)) Value(*std::forward<Other>(other));
        else
            ::new (static_cast<void*>(&error_)) Error(std::forward<Other>(other).error());
    }
    void clear() noexcept {
        if (has_value_)
            value_.~Value();
        else
            error_.~Error();
    }
    void demand() const {
        if (has_value_) return;
#if defined(__cpp_exceptions) || defined(_CPPUNWIND)
        throw BadResult(error_);
#else
        detail::end_without_value(error_);
#endif
    }

    union {
        Value value_;
        Error error_;
    };
    bool has_value_;
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
[[nodiscard]] Error fail(ErrorCode code, std::uint64_t item, std::initializer_list<MessagePart> message) noexcept;
[[nodiscard]] inline Error fail(ErrorCode code, std::uint64_t item, const char* message) noexcept {
    return fail(code, item, {MessagePart(message)});
}
// Takes a finished message. (A template, so that braces mean parts.)
template <std::same_as<std::string> String>
[[nodiscard]] Error fail(ErrorCode code, std::uint64_t item, String message) {
    return {code, item, std::move(message)};
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
