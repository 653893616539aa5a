// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include "run_cli.hpp"

using namespace crofton::test;

TEST_SUITE("cli/hierarchy") {
    TEST_CASE("no levels, a file that is no polygon and one that is missing are bad usage") {
        write_contents(scratch().file("chain.obj"), "v 0 0 0\n");
        write_contents(scratch().file("chain_nan.poly"), "P a 1\n3 0 0 1 nan 2 2\n");
        for (const std::string& arguments :
             {std::string("study hierarchy --levels 0"), std::string("study hierarchy --lines 1"),
              "study hierarchy '" + scratch().file("chain.obj") + "'",
              "study hierarchy '" + scratch().file("missing.poly") + "'",
              "study hierarchy '" + scratch().file("chain_nan.poly") + "'"}) {
            CAPTURE(arguments);
            const CliRun run = run_cli(arguments);
            CHECK(run.status == 2);
            CHECK_FALSE(run.err.empty());
        }
    }

    TEST_CASE(
        "the paper's example: the second circle saves 40.3 percent, random lines agree, the picture has all chains") {
        const CliRun run = run_cli("study hierarchy --lines 200000 --json -");
        REQUIRE(run.status == 0);
        const auto document = run.json();
        const auto& circles = document.at("chains")[0].at("levels");
        CHECK(circles[0].at("improper").get<double>() == doctest::Approx(2.0 * 3.14159265358979 - 4.0).epsilon(1e-9));
        CHECK(circles[1].at("improper").get<double>() == doctest::Approx(1.3637).epsilon(1e-4));
        CHECK(circles[1].at("gain").get<double>() == doctest::Approx(0.403).epsilon(1e-3));
        for (const auto& row : document.at("rows")) CHECK(row.at("holds") == true);
        // Rectangles are at least as good as boxes along the axes, which are among them.
        for (std::size_t object = 0; object < 2; ++object) {
            const auto& rectangles = document.at("chains")[3 * object + 1].at("levels");
            const auto& boxes = document.at("chains")[3 * object + 2].at("levels");
            CHECK(rectangles[1].at("improper").get<double>() <= boxes[1].at("improper").get<double>() + 1e-8);
        }
        const CliRun drawn = run_cli("study hierarchy --lines 1000 --svg -");
        CHECK(drawn.out.rfind("<svg", 0) == 0);
        CHECK(drawn.out.find("a triangle: boxes") != std::string::npos);
        CHECK(drawn.out.find(">level 3<") != std::string::npos);
    }
}
