// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <crofton/core/error.hpp>
#include <cstdio>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <type_traits>
#include <utility>

#if defined(__unix__)
#include <unistd.h>
#endif

using namespace crofton;

TEST_SUITE("core/error") {
    TEST_CASE("every code has a name of its own, other numbers are unknown") {
        std::set<std::string> names;
        for (int code = 0; code <= static_cast<int>(ErrorCode::out_of_memory); ++code)
            names.insert(to_string(static_cast<ErrorCode>(code)));
        CHECK(names.size() == static_cast<std::size_t>(ErrorCode::out_of_memory) + 1);
        CHECK(names.count("unknown") == 0);
        CHECK(to_string(static_cast<ErrorCode>(200)) == std::string("unknown"));
    }

    TEST_CASE("a message is made of texts and of numbers of each kind") {
        const std::string text = "text";
        const Error error = fail(ErrorCode::parse, 7, {text, " ", 18446744073709551615u, " ", -5, " ", 0.5});
        CHECK(error.code == ErrorCode::parse);
        CHECK(error.item == 7);
        CHECK(error.message == "text 18446744073709551615 -5 0.500000");
    }

    TEST_CASE("an error is copied whole, also over another and over itself") {
        const Error first{ErrorCode::io, 3, "a message that is too long for the room within a string"};
        Error second{ErrorCode::empty, 9, "other"};
        second = first;
        CHECK((second.code == ErrorCode::io && second.item == 3 && second.message == first.message));
        const Error& same = second;
        second = same;
        CHECK((second.code == ErrorCode::io && second.item == 3 && second.message == first.message));
    }

    TEST_CASE("value() of a result gives the value, nothing for void, and throws what says the message") {
        const auto with = [](bool good) -> Result<int> {
            if (!good) return fail(ErrorCode::empty, 3, "nothing is here");
            return 7;
        };
        const auto without = [&](bool good) -> Result<void> {
            if (auto done = with(good); !done) return done.error();
            return {};
        };
        CHECK(with(true).value() == 7);
        without(true).value();
        static_assert(std::is_void_v<decltype(without(true).value())>);
        Result<int> kept = with(true);
        kept.value() = 8;
        CHECK(std::as_const(kept).value() == 8);
        CHECK(Result<std::unique_ptr<int>>(std::make_unique<int>(5)).value() != nullptr);
        for (const bool is_void : {false, true}) {
            try {
                is_void ? without(false).value() : (void)with(false).value();
                FAIL("there is no value");
            } catch (const BadResult& bad) {
                CHECK(std::string(bad.what()) == "nothing is here");
                CHECK(bad.error().code == ErrorCode::empty);
                CHECK(bad.error().item == 3);
            }
        }
        try {
            Result<void>(fail(ErrorCode::io, 0, "")).value();
            FAIL("there is no value");
        } catch (const BadResult& bad) {
            CHECK(std::string(bad.what()) == "input/output");
        }
    }

    TEST_CASE("a result is made of values, errors and other results") {
        Result<bool> yes = true;
        Result<bool> copy = yes;  // not a conversion to bool
        yes = Result<bool>(false);
        CHECK(copy.value());
        CHECK_FALSE(yes.value());
        CHECK_FALSE(std::is_constructible_v<Result<int>, std::string>);
        CHECK(std::is_convertible_v<int, Result<double>>);
        const Result<std::optional<int>> none = std::nullopt;
        REQUIRE(none.has_value());
        CHECK_FALSE(none->has_value());
    }

    TEST_CASE("a result that is assigned lets go of the value or error that it had") {
        using Shared = Result<std::shared_ptr<int>>;
        const auto owned = std::make_shared<int>(3);
        const Error error = fail(ErrorCode::io, 4, "a message that is too long for the room within a string");
        Shared value = owned, none = error;
        CHECK(owned.use_count() == 2);
        Shared copy = value;
        CHECK(owned.use_count() == 3);
        copy = none;
        CHECK(owned.use_count() == 2);
        CHECK(copy.error().message == error.message);
        copy = value;
        CHECK(owned.use_count() == 3);
        CHECK(*copy == owned);
        const Shared& same = copy;
        copy = same;
        CHECK(owned.use_count() == 3);
        none = std::move(copy);
        CHECK(**none == 3);
        value = Shared(error);
        CHECK(owned.use_count() == 2);
        CHECK(value.value_or(nullptr) == nullptr);
        CHECK(none.value_or(nullptr) == owned);
        static_assert(!std::is_copy_constructible_v<Result<std::unique_ptr<int>>>);
        static_assert(std::is_nothrow_move_constructible_v<Result<std::unique_ptr<int>>>);
    }

#if defined(__unix__) && !defined(__EMSCRIPTEN__)  // whose stderr stays the host's
    TEST_CASE("without a handler warnings and errors go to stderr, and nothing below them") {
        set_log_handler(nullptr, nullptr);
        std::FILE* const file = std::tmpfile();
        REQUIRE(file != nullptr);
        std::fflush(stderr);
        const int kept = dup(STDERR_FILENO);
        dup2(fileno(file), STDERR_FILENO);
        log(LogLevel::debug, "one");
        log(LogLevel::info, "two");
        log(LogLevel::warning, std::string_view("three and more").substr(0, 5));
        log(LogLevel::error, "four");
        std::fflush(stderr);
        dup2(kept, STDERR_FILENO);
        close(kept);
        std::rewind(file);
        char said[256] = {};
        const std::size_t length = std::fread(said, 1, sizeof said - 1, file);
        std::fclose(file);
        CHECK(std::string(said, length) == "crofton: warning: three\ncrofton: error: four\n");
    }
#endif
}
