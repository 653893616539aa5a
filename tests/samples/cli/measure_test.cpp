// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "run_cli.hpp"

using namespace crofton::test;
using std::numbers::pi;

namespace {

// A box of edges 1, 2, 3 with a wall inside it, from corner to corner, that its hull does not show.
constexpr const char* kBox =
    "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 1 2 0\nv 0 0 3\nv 1 0 3\nv 0 2 3\nv 1 2 3\n"
    "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\nf 1 4 8 5\n";

}  // namespace

TEST_SUITE("cli/measure") {
    TEST_CASE("a box with a wall in it: area, hull, volume and curvature as computed by hand, and counted by lines") {
        const std::string file = scratch().file("box.obj");
        write_contents(file, kBox);
        for (const char* seed : {"1", "2", "3"}) {
            const CliRun run = run_cli("study measure '" + file + "' --json - --seed " + seed);
            REQUIRE(run.status == 0);
            const auto document = run.json();
            CHECK(document["F0"].get<double>() == doctest::Approx(pi * 14.0));  // the sphere of diameter √14
            const auto& rows = document["rows"];
            REQUIRE(rows.size() == 4);
            const double expected[] = {22.0 + 3.0 * std::sqrt(5.0), 22.0, 6.0, 6.0 * pi};
            for (std::size_t i = 0; i < 4; ++i) {
                CHECK(rows[i]["predicted"].get<double>() == doctest::Approx(expected[i]));
                CHECK(std::abs(rows[i]["z"].get<double>()) < 4.0);
                CHECK(rows[i]["standard_error"].get<double>() < 0.01 * expected[i]);
            }
        }
    }

    TEST_CASE("a flat mesh has no volume to count, and points on a line have nothing") {
        const std::string square = scratch().file("square.obj"), line = scratch().file("line.obj");
        write_contents(square, "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
        const auto rows = run_cli("study measure '" + square + "' --json -").json()["rows"];
        REQUIRE(rows.size() == 2);
        CHECK(rows[0]["predicted"].get<double>() == doctest::Approx(1.0));
        CHECK(rows[1]["predicted"].get<double>() == doctest::Approx(2.0 * pi));  // πL/2 of a perimeter of 4
        write_contents(line, "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
        const CliRun run = run_cli("study measure '" + line + "'");
        CHECK(run.status == 2);
        CHECK(run.err.find("all vertices lie on one line") != std::string::npos);
    }
}
