// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>

#include "run_cli.hpp"

using namespace crofton::test;

TEST_SUITE("cli/verify") {
    TEST_CASE("a topic that does not exist, no trials and a folder that is missing are bad usage") {
        for (const char* arguments :
             {"verify nothing", "verify lines --trials 0", "verify lines --trials many", "verify --seed"}) {
            const CliRun run = run_cli(arguments);
            CHECK(run.status == 2);
            CHECK(run.out.empty());
            CHECK_FALSE(run.err.empty());
        }
        const CliRun run = run_cli("verify lines --trials 1000 --json /no/such/folder/rows.json");
        CHECK(run.status == 2);
        CHECK(run.err.find("/no/such/folder/rows.json") != std::string::npos);
    }

    TEST_CASE("every claim on lines holds, right ones by agreement and wrong ones by rejection") {
        const CliRun run = run_cli("verify lines --trials 2000 --json -");
        CHECK(run.status == 0);
        const auto rows = run.json();
        REQUIRE(rows.is_array());
        int wrong = 0;
        for (const auto& row : rows) {
            for (const char* key : {"claim", "source", "predicted", "measured", "standard_error", "z", "holds"})
                CHECK(row.contains(key));
            CHECK(row["holds"] == true);
            const bool is_wrong = row["claim"].get<std::string>().rfind("wrong, must be rejected: ", 0) == 0;
            wrong += is_wrong;
            CHECK((std::abs(row["z"].get<double>()) > 4.0) == is_wrong);
        }
        CHECK(wrong >= 4);
    }

    TEST_CASE("the paper's claims hold for several seeds, and a seed gives the same bits again") {
        for (const char* seed : {"1", "7", "123456789"}) {
            const std::string arguments = std::string("verify paper --trials 2000 --json - --seed ") + seed;
            const CliRun run = run_cli(arguments);
            CHECK(run.status == 0);
            CHECK(run.json().size() > 60);
            CHECK(run_cli(arguments).out == run.out);
        }
    }

    TEST_CASE("culling is right for boxes, axis-aligned boxes and spheres at every offset, and says on how many") {
        const CliRun run = run_cli("verify cull --trials 3000 --json -");
        CHECK(run.status == 0);
        std::map<std::string, std::uint64_t> proved;
        for (const auto& row : run.json()) {
            CHECK(row["holds"] == true);
            const std::string claim = row["claim"];
            const std::string kind = claim.substr(0, claim.find(':'));
            if (claim.find(": of ") != std::string::npos && claim.find(" proved ") != std::string::npos)
                proved[kind] += row["cases"].get<std::uint64_t>();
        }
        CHECK(proved == std::map<std::string, std::uint64_t>{
                            {"axis-aligned boxes", 15000}, {"spheres", 15000}, {"boxes", 15000}});
    }

    TEST_CASE("nothing seen is culled in a whole scene, the town by default") {
        CliRun run = run_cli("verify occlude --trials 5000 --json -");
        CHECK(run.status == 0);
        CHECK(run.json().size() == 4);
        for (const auto& row : run.json()) {
            CHECK(row["holds"] == true);
            CHECK(row["cases"].get<std::uint64_t>() > 1000);
            CHECK(row["claim"].get<std::string>().find("(0.0 %") == std::string::npos);
        }
        CHECK(run_cli("verify occlude --scene town --trials 5000 --json -").out == run.out);
        CHECK(run_cli("verify lines --scene town").status == 2);
        run = run_cli("verify occlude --scene no_such_scene.obj");
        CHECK(run.status == 2);
        CHECK(run.err.find("no_such_scene.obj") != std::string::npos);
    }

    TEST_CASE("no pair above epsilon is missed in the town, and no ray or street view meets what is proved hidden") {
        const CliRun run = run_cli("verify pvs --trials 40000 --json -");
        CHECK(run.status == 0);
        CHECK(run.json().size() == 3);
        for (const auto& row : run.json()) {
            CHECK(row["holds"] == true);
            CHECK(row["cases"].get<std::uint64_t>() > 100);
        }
    }

    TEST_CASE("shapes that nearly touch, hulls, meshes and maps as shapes are exact") {
        CliRun run = run_cli("verify collide --trials 1000 --json -");
        CHECK(run.status == 0);
        for (const auto& row : run.json()) CHECK(row["holds"] == true);
        const auto all = run.json();
        run = run_cli("verify convex --trials 1000 --json -");
        CHECK(run.status == 0);
        const auto part = run.json();
        REQUIRE(part.size() == 76);
        for (std::size_t i = 0; i < part.size(); ++i) CHECK(part[i] == all[all.size() - part.size() + i]);
        const std::string mesh = scratch().file("tetrahedra.obj"), map = scratch().file("squares.poly"),
                          tests = "--trials 8000 --json -";
        std::ofstream(mesh)
            << "v 0 0 0\nv 4 0 0\nv 0 4 0\nv 0 0 4\nv 4 4 4\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\nf 2 5 3\n"
               "f 3 5 4\nf 4 5 2\n";
        std::ofstream(map) << "P high 1\n4 0 0 9 0 9 4 0 4\nP low 2\n4 0 4 9 4 9 9 0 9\n4 2 5 3 5 3 6 2 6\n";
        run = run_cli("verify collide --scene " + mesh + " --scene " + map + " " + tests);
        CHECK(run.status == 0);
        CHECK(run.json().size() == 8 + 4);
        std::size_t fields = 0;
        for (const auto& row : run.json()) {
            CHECK(row["holds"] == true);
            CHECK(row["cases"].get<std::uint64_t>() > 0);
            fields += row["claim"].get<std::string>().find("height field") != std::string::npos;
        }
        CHECK(fields == 3);
        run = run_cli("verify collide --scene no_such_map.poly");
        CHECK(run.status == 2);
        CHECK(run.err.find("no_such_map.poly") != std::string::npos);
    }

    TEST_CASE("any level of a WAD, by its name") {
        const std::string wad = std::string(CROFTON_SHARED_DATA) + "/scenes/freedoom2_maps.wad";
        if (!std::filesystem::exists(wad)) {
            MESSAGE("skipped: no shared data");
            return;
        }
        for (const std::string topic : {"occlude", "collide"}) {
            const CliRun run = run_cli("verify " + topic + " --scene " + wad + " --map MAP02 --trials 1000 --json -");
            CHECK(run.status == 0);
            for (const auto& row : run.json()) {
                CHECK(row["holds"] == true);
                CHECK(row["claim"].get<std::string>().rfind("freedoom2_maps.wad MAP02", 0) == 0);
            }
            const CliRun missing = run_cli("verify " + topic + " --scene " + wad + " --map MAP99");
            CHECK(missing.status == 2);
            CHECK(missing.err.find("MAP99") != std::string::npos);
        }
    }

    TEST_CASE("the table lists one claim a line") {
        const CliRun run = run_cli("verify lines --trials 1000");
        CHECK(run.status == 0);
        CHECK(run.out.rfind("claim", 0) == 0);
        CHECK(run.out.find("cosine-weighted from a box") != std::string::npos);
    }

    TEST_CASE("every formula has a row that sees an error of 1 percent, those by volumes of sums one of 0.1 percent") {
        for (const char* topic : {"paper", "lines"}) {
            const CliRun run = run_cli(std::string("verify ") + topic + " --json -");
            CHECK(run.status == 0);
            std::map<std::string, double> best;
            for (const auto& row : run.json()) {
                REQUIRE(row.contains("resolution"));
                const std::string claim = row["claim"], source = row["source"];
                if (claim.rfind("wrong, must be rejected: ", 0) == 0) continue;
                const double resolution = row["resolution"].is_null() ? HUGE_VAL : row["resolution"].get<double>();
                const auto found = best.emplace(source, resolution).first;
                found->second = std::min(found->second, resolution);
            }
            for (const auto& entry : best) {
                CAPTURE(entry.first);
                // What headers promise may be yes or no: wrong answers are counted, and there may be none.
                if (entry.second == HUGE_VAL && entry.first.rfind("header", 0) == 0) continue;
                CHECK(entry.second <= 0.01);
            }
            if (topic == std::string("lines")) continue;
            for (const char* formula :
                 {"theory.md (1)", "theory.md (2)", "theory.md (6)", "theory.md section 2, m_o"}) {
                CAPTURE(formula);
                CHECK(best.at(formula) <= 0.001);
            }
        }
    }
}
