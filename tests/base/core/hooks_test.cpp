// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <crofton/core/error.hpp>
#include <crofton/core/version.hpp>
#include <string>

using namespace crofton;

TEST_SUITE("core/hooks") {
    TEST_CASE("log messages reach the host's handler with their level") {
        std::string seen;
        set_log_handler(
            [](void* user, LogLevel level, std::string_view message) {
                *static_cast<std::string*>(user) +=
                    std::to_string(static_cast<int>(level)) + ":" + std::string(message);
            },
            &seen);
        log(LogLevel::info, "hello");
        set_log_handler(nullptr, nullptr);
        CHECK(seen == "1:hello");
    }

    TEST_CASE("the version string spells the version") {
        const Version v = version();
        CHECK(std::string(version_string()) ==
              std::to_string(v.major) + "." + std::to_string(v.minor) + "." + std::to_string(v.patch));
    }

    TEST_CASE("headers and library are of one version") {
        CHECK(version().major == CROFTON_VERSION_MAJOR);
        CHECK(version().minor == CROFTON_VERSION_MINOR);
        CHECK(version().patch == CROFTON_VERSION_PATCH);
        static_assert(CROFTON_VERSION >= CROFTON_MAKE_VERSION(0, 2, 0));
        static_assert(CROFTON_VERSION < CROFTON_MAKE_VERSION(CROFTON_VERSION_MAJOR + 1, 0, 0));
    }
}
