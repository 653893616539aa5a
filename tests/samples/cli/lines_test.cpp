// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <cmath>
#include <string>
#include <vector>

#include "run_cli.hpp"

using namespace crofton::test;

TEST_SUITE("cli/lines") {
    TEST_CASE("a scene that is missing, several without --factors and too many patches are bad usage") {
        for (const char* arguments :
             {"study lines /no/such/scene.obj", "study lines room town", "study lines --factors --patches 1",
              "study lines --factors /no/such/scene.glb", "study lines --factors --blocks 0"}) {
            CAPTURE(arguments);
            const CliRun run = run_cli(arguments);
            CHECK(run.status == 2);
            CHECK_FALSE(run.err.empty());
        }
    }

    TEST_CASE("estimates of two seeds share no draw") {
        // Crossings per line of each method. The room is the same for all seeds.
        const auto crossings = [](const char* seed_and_repeats) {
            const CliRun run = run_cli(std::string("study lines room --blocks 2 --json - --seed ") + seed_and_repeats);
            CHECK(run.status == 0);
            const auto report = run.json();
            std::vector<double> means;
            for (const auto& method : report.at("methods")) means.push_back(method.at("mean_crossings"));
            return means;
        };
        // Two estimates of seed 1, and two of seed 2, are the four of seed 1.
        const auto first = crossings("1 --repeats 2"), second = crossings("2 --repeats 2");
        const auto four = crossings("1 --repeats 4");
        REQUIRE(four.size() == 8);
        for (std::size_t i = 0; i < 8; ++i) {
            CAPTURE(i);
            CHECK(four[i] == doctest::Approx((first[i] + second[i]) / 2.0).epsilon(1e-12));
        }
    }

    TEST_CASE("--factors: six pairs, each within four errors of its known value, two of them printed in tables") {
        const CliRun run = run_cli("study lines --factors --blocks 300 --json -");
        CHECK(run.status == 0);
        const auto rows = run.json();
        REQUIRE(rows.size() == 6);
        for (const auto& row : rows) CHECK(std::abs(row.at("z").get<double>()) <= 4.0);
        CHECK(rows[0].at("predicted").get<double>() == doctest::Approx(0.199825).epsilon(1e-6));
        CHECK(rows[2].at("predicted").get<double>() == doctest::Approx(0.200044).epsilon(1e-5));
    }

    TEST_CASE("--factors of scenes: bits between 0 and the entropy, and one line a scene") {
        const CliRun run = run_cli("study lines --factors room town --blocks 50 --patches 300 --json -");
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
