// SPDX-License-Identifier: MIT
// How much work is granted where none is asked for.
#include <doctest/doctest.h>
#include <crofton/triangulate/triangulate.hpp>
#include <watch.hpp>

using namespace crofton::triangulate;

TEST_SUITE("triangulate/watch") {
    TEST_CASE(
        "work has a limit by the number of points, none where there is one of time, and the one that is asked for") {
        constexpr std::size_t kStep = 100'000'000;
        const auto steps_granted = [](const TriangulateOptions& options, std::size_t points) {
            Watch watch(options, points);
            while (watch.steps() < 12'000'000'000 && !watch.stopped(0.0, kStep)) {
            }
            return watch.steps();
        };
        CHECK(steps_granted({}, 100) == 1'000'000'000);
        CHECK(steps_granted({}, 60'000) == 3'000'000'000);
        CHECK(steps_granted({}, 10'000'000) == 10'000'000'000);
        CHECK(steps_granted({.seconds = 1e4}, 100) == 12'000'000'000);
        CHECK(steps_granted({.work = 500'000'000, .seconds = 1e4}, 60'000) == 500'000'000);
        CHECK(steps_granted({.work = TriangulateOptions::kUnlimitedWork}, 100) == 12'000'000'000);
        CHECK(steps_granted({.seconds = 0.0}, 100) == kStep);
    }
}
