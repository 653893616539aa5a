// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <cmath>
#include <string>

#include "run_cli.hpp"

using namespace crofton::test;

TEST_SUITE("cli/factors") {
    TEST_CASE("a scene that is missing, one patch and no lines are bad usage") {
        for (const char* arguments :
             {"study factors /no/such/scene.obj", "study factors room --patches 1", "study factors --blocks 0"}) {
            CAPTURE(arguments);
            const CliRun run = run_cli(arguments);
            CHECK(run.status == 2);
            CHECK_FALSE(run.err.empty());
        }
    }

    TEST_CASE("six pairs, each within four errors of its known value, two of them printed in tables") {
        const CliRun run = run_cli("study factors --blocks 300 --json -");
        CHECK(run.status == 0);
        const auto rows = run.json();
        REQUIRE(rows.size() == 6);
        for (const auto& row : rows) CHECK(std::abs(row.at("z").get<double>()) <= 4.0);
        CHECK(rows[0].at("predicted").get<double>() == doctest::Approx(0.199825).epsilon(1e-6));
        CHECK(rows[2].at("predicted").get<double>() == doctest::Approx(0.200044).epsilon(1e-5));
    }

    TEST_CASE("scenes: bits between 0 and the entropy, and one line a scene") {
        const CliRun run = run_cli("study factors room town --blocks 50 --patches 300 --json -");
        CHECK(run.status == 0);
        const auto scenes = run.json();
        REQUIRE(scenes.size() == 2);
        for (const auto& scene : scenes) {
            CHECK(scene.at("bits").get<double>() > 0.0);
            CHECK(scene.at("bits").get<double>() < scene.at("entropy_bits").get<double>());
        }
        // Inside a room hardly anything escapes; from a town's streets and roofs most does.
        CHECK(scenes[0].at("escaped").get<double>() < 0.1);
        CHECK(scenes[1].at("escaped").get<double>() > 0.5);
    }
}
