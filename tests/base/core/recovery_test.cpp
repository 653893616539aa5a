// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <crofton/core/no_recovery.hpp>
#include <crofton/core/recovery.hpp>
#include <new>

using namespace crofton;

namespace {

Result<int> failed(ErrorCode code) {
    return fail(code, kNoItem, "text");
}

}  // namespace

TEST_SUITE("core/recovery") {
    TEST_CASE("a value or its absence is handed on, and the end of memory becomes the operation's error") {
        CHECK(detail::value_or_give_up(Result<int>(7)) == 7);
        const auto result = detail::recover(
            []() -> Result<int> { return detail::value_or_give_up(failed(ErrorCode::out_of_memory)) + 1; });
        REQUIRE_FALSE(result);
        CHECK(result.error().code == ErrorCode::out_of_memory);
    }

    TEST_CASE("errors other than the end of memory are the caller's own affair") {
        const auto outcome = [](const Result<int>& given) {
            return detail::recover([&]() -> Result<int> {
                detail::give_up_without_memory(given);
                return 1;
            });
        };
        CHECK(outcome(3).value() == 1);
        CHECK(outcome(failed(ErrorCode::degenerate)).value() == 1);
        REQUIRE_FALSE(outcome(failed(ErrorCode::out_of_memory)));
        CHECK(outcome(failed(ErrorCode::out_of_memory)).error().code == ErrorCode::out_of_memory);
    }

    TEST_CASE("an allocation that fails within an operation unwinds to the outermost one") {
        set_memory_hooks({[](void*, std::size_t, std::size_t) -> void* { return nullptr; },
                          [](void*, void*, std::size_t, std::size_t) {}, nullptr});
        bool inner_went_on = false;
        const auto result = detail::recover([&]() -> Result<int> {
            const auto inner = detail::recover([]() -> Result<int> {
                const Vector<int> numbers(10);
                return static_cast<int>(numbers.size());
            });
            inner_went_on = true;
            return inner;
        });
        reset_memory_hooks();
        CHECK_FALSE(inner_went_on);
        REQUIRE_FALSE(result);
        CHECK(result.error().code == ErrorCode::out_of_memory);
    }

    TEST_CASE("a parallel operation reports bodies that run out of memory once all have returned") {
        ThreadPool pool(3);
        std::atomic<int> ended{0};
        const auto result = detail::recover([&]() -> Result<int> {
            detail::recoverable_for(pool, 20, 1, [&](std::size_t begin, std::size_t, unsigned) {
                if (begin == 5) detail::give_up();
                ++ended;
            });
            return 1;
        });
        REQUIRE_FALSE(result);
        CHECK(result.error().code == ErrorCode::out_of_memory);
        CHECK(ended < 20);
        CHECK(ended >= 0);
    }
}
