// SPDX-License-Identifier: MIT
// Where the eye stands when a scene is opened.
#include <set>

#include "view_run.hpp"

using namespace crofton::test;

namespace {

// The first frame of a scene.
struct FirstLook {
    json eye, statistics;
    int sky = 0;  // pixels as blue as the sky above the horizon
};
FirstLook look_at(const std::string& scene, const std::string& arguments = {}) {
    const ViewRun run = view({set(0, {{"panels", false}, {"paused", true}}), shot(1, "start.png")},
                             "'" + scene + "' " + arguments, false);
    check_clean(run);
    const json& entry = picture(run, "start.png");
    const int sky =
        Pixels(scratch().file("start.png")).count([](int r, int g, int b) { return b > 150 && b > r + 30 && b > g; });
    return {entry["eye"], entry["statistics"], sky};
}

}  // namespace

TEST_SUITE("viewer/start") {
    TEST_CASE("a level without cameras is entered: one looks level, sees walls instead of sky, and not all of it") {
        const std::string folder = CROFTON_SHARED_DATA "/scenes/";
        for (const char* name : {"recast_dungeon.obj", "freedoom2_maps.wad"}) {
            if (!std::filesystem::exists(folder + name)) continue;
            CAPTURE(name);
            const FirstLook look = look_at(folder + name);
            CHECK(look.eye["forward"][1] == 0.0);
            CHECK(look.sky < 480 * 270 / 20);
            CHECK(look.statistics["visible"] < look.statistics["instances"]);
        }
    }
    TEST_CASE("a thing is looked at from above and outside, all of it in view") {
        const std::string bunny = CROFTON_SHARED_DATA "/meshes/bunny.obj";
        if (!std::filesystem::exists(bunny)) return;
        const FirstLook look = look_at(bunny);
        CHECK(look.eye["forward"][1] < -0.2);
        CHECK(look.statistics["inside"] == look.statistics["instances"]);
    }
    TEST_CASE("the street leads through a level, frame by frame elsewhere") {
        const std::string level = CROFTON_SHARED_DATA "/scenes/recast_dungeon.obj";
        if (!std::filesystem::exists(level)) return;
        const CliRun frames = run_cli("frames '" + level + "' --camera street --frames 8 --no-draw --json -");
        REQUIRE(frames.status == 0);
        std::set<std::string> places;
        const json document = frames.json();
        for (const json& frame : document["frames"]) {
            CHECK(frame["visible"] > 0);
            places.insert(frame["camera"]["position"].dump());
        }
        CHECK(places.size() == 8);
    }
}
