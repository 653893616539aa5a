// SPDX-License-Identifier: MIT
// A folder of regions: they come and go with the eye, and are told apart.
#include "view_run.hpp"

using namespace crofton::test;

TEST_SUITE("viewer/regions") {
    TEST_CASE("regions come and go with the eye, differ in colour, and a damaged one is named") {
        const std::string folder = scratch().file("regions");
        REQUIRE(run_cli("bake town --instances 3000 --no-occluders --regions 5x4 --folder " + folder).status == 0);
        const auto eye = [](int frame, double x) {
            return json{{"frame", frame}, {"camera", {{"position", {x, 30, 0}}, {"forward", {0.9, -0.4, 0}}}}};
        };
        const json events = {set(0, {{"panels", false}}),
                             eye(0, -150),
                             shot(1, "west.png"),
                             set(2, {{"coloring", "regions"}}),
                             shot(3, "regions.png"),
                             set(4, {{"coloring", "verdict"}}),
                             shot(5, "verdict.png"),
                             eye(6, 5000),
                             shot(7, "east.png"),
                             set(8, {{"panels", true}, {"coloring", "clusters"}, {"bounds", true}, {"cascades", 3}}),
                             {{"frame", 9}, {"click", {240, 135}}},
                             shot(9, "panels.png"),
                             set(10, {{"panels", false}, {"coloring", "lit"}}),
                             eye(10, -150),
                             {{"frame", 11}, {"click", {240, 135}}},
                             shot(12, "picked.png"),
                             {{"frame", 13}, {"camera", {{"position", {-150, 30, 0}}, {"forward", {0, 1, 0.1}}}}},
                             {{"frame", 14}, {"click", {240, 135}}},
                             shot(15, "sky.png")};
        const ViewRun result = view(events, "'" + folder + "'", false);
        check_clean(result);
        const json& west = picture(result, "west.png");
        CHECK(west["statistics"]["regions"]["attached"].get<int>() > 0);
        CHECK(west["statistics"]["visible"].get<int>() > 100);
        CHECK(west["statistics"]["triangles_seen"] <= west["statistics"]["triangles_passed"]);
        int came = 0, went = 0;
        for (const json& frame : result.document["frames"]) {
            came += frame["regions"]["came"].get<int>();
            went += frame["regions"]["went"].get<int>();
            CHECK(frame["regions"]["attached"] == came - went);
        }
        CHECK(went > 0);
        // Twelve lines a region of the index.
        CHECK(picture(result, "regions.png")["lines"].get<int>() % 12 == 0);
        CHECK(picture(result, "regions.png")["lines"].get<int>() >= 12 * 10);
        CHECK(Pixels(scratch().file("regions.png")).different(Pixels(scratch().file("west.png"))) > 5000);
        const json& verdict = picture(result, "verdict.png");
        CHECK(tinted(verdict, "inside") == verdict["statistics"]["inside"]);
        CHECK(tinted(verdict, "straddling") == verdict["statistics"]["straddling"]);
        // What regions lack is left out, with a message.
        const json& panels = picture(result, "panels.png");
        CHECK(panels["settings"]["coloring"] == "regions");
        CHECK(panels["settings"]["bounds"] == false);
        CHECK(panels["messages"].dump().find("over regions") != std::string::npos);
        CHECK_FALSE(panels.contains("selected"));
        REQUIRE(picture(result, "picked.png").contains("selected"));
        CHECK(tinted(picture(result, "picked.png"), "selected") == 1);
        CHECK_FALSE(picture(result, "sky.png").contains("selected"));
        // The same script shows the same picture again.
        const Pixels before(scratch().file("east.png"));
        check_clean(view(events, "'" + folder + "'", false));
        CHECK(Pixels(scratch().file("east.png")).different(before) == 0);

        std::string bytes = contents_of(folder + "/r2_2.crofton");
        REQUIRE(!bytes.empty());
        bytes[bytes.size() / 2] ^= 1;
        write_contents(folder + "/r2_2.crofton", bytes);
        const ViewRun damaged = view(events, "'" + folder + "'", false);
        CHECK(damaged.run.status == 2);
        CHECK_MESSAGE(damaged.run.err.find("r2_2.crofton") != std::string::npos, damaged.run.err);
    }
}
