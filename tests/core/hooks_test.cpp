#include <doctest/doctest.h>
#include <crofton/core/log.hpp>
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
}
