// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <filesystem>

#include "run_cli.hpp"

using namespace crofton::test;

TEST_SUITE("cli/bake") {
    TEST_CASE("scenes and files that cannot be read end with status 2, name the culprit and leave no output behind") {
        const std::string output = scratch().file("never.crofton");
        for (const char* scene : {"no-such-file.glb", "no-such-kind.xyz"}) {
            const CliRun run = run_cli(std::string("bake ") + scene + " -o " + output);
            CHECK(run.status == 2);
            CHECK(run.err.find(scene) != std::string::npos);
            CHECK_FALSE(std::filesystem::exists(output));
        }
        CHECK(run_cli("bake").status == 2);
        CHECK(run_cli("bake missing.crofton").status == 2);
        CHECK(run_cli("bake town --instances 400 -o /no/such/folder/town.crofton").status == 2);
        CHECK(run_cli("bake town --threads lots").status == 2);
    }

    TEST_CASE("a baked file is loaded again, and damage, a cut and another version give different messages") {
        const std::string path = scratch().file("town.crofton"), bad = scratch().file("bad.crofton");
        const CliRun baked = run_cli("bake town --instances 400 -o " + path + " --json -");
        REQUIRE(baked.status == 0);
        const CliRun loaded = run_cli("bake " + path + " --json -");
        REQUIRE(loaded.status == 0);
        for (const char* key : {"bytes", "instances", "meshes", "triangles", "polygons", "nodes", "tree_height"})
            CHECK(loaded.json()[key] == baked.json()[key]);
        CHECK(loaded.json()["instances"].get<int>() > 300);
        CHECK(std::filesystem::file_size(path) == loaded.json()["bytes"].get<std::size_t>());

        const std::string sound = contents_of(path);
        const auto refused = [&](std::string contents, const char* reason) {
            write_contents(bad, contents);
            const CliRun run = run_cli("bake " + bad);
            CHECK(run.status == 2);
            CHECK(run.err.find("bad.crofton") != std::string::npos);
            CAPTURE(run.err);
            CHECK(run.err.find(reason) != std::string::npos);
        };
        std::string damaged = sound;
        damaged[sound.size() / 2] ^= 1;
        refused(damaged, "damaged");
        refused(sound.substr(0, sound.size() / 2), "cut off");
        std::string newer = sound;
        newer[12] = 9;
        refused(newer, "version 9");
        refused("not a file of ours at all, but long enough to have a header of its own", "not a .crofton file");
    }

    TEST_CASE("a baked file can be drawn and measured like the scene that it was made of") {
        const std::string baked = scratch().file("shown.crofton"), again = scratch().file("again.crofton");
        REQUIRE(run_cli("bake room -o " + baked).status == 0);
        const std::string frames = " --frames 4 --camera orbit --no-draw --verify --ids --json - ";
        const CliRun own = run_cli("frames room" + frames), shown = run_cli("frames " + baked + frames);
        REQUIRE(own.status == 0);
        REQUIRE_MESSAGE(shown.status == 0, shown.err);
        for (std::size_t i = 0; i < 4; ++i) {
            const auto a = own.json()["frames"][i], b = shown.json()["frames"][i];
            CHECK(a["visible_ids"] == b["visible_ids"]);
            CHECK(a["camera"] == b["camera"]);
        }
        const CliRun area = run_cli("study measure room --lines 1000 --json -"),
                     same = run_cli("study measure " + baked + " --lines 1000 --json -");
        REQUIRE_MESSAGE(same.status == 0, same.err);
        CHECK(area.json()["rows"] == same.json()["rows"]);
        const CliRun street = run_cli("frames " + baked + " --frames 4 --camera street --no-draw --occlude --json -");
        CHECK_MESSAGE(street.status == 0, street.err);
        // The file, baked once more, holds the same.
        REQUIRE(run_cli("bake " + baked + " -o " + again).status == 0);
        CHECK(run_cli("bake " + again + " --json -").json()["triangles"] ==
              run_cli("bake " + baked + " --json -").json()["triangles"]);
        // Sets without a scene are none.
        const std::string sets = scratch().file("sets_alone.crofton");
        REQUIRE(run_cli("pvs room --cells 2x1x2 --epsilon 1e-2 --out " + sets).status == 0);
        const CliRun none = run_cli("frames --no-draw " + sets);
        CHECK(none.status == 2);
        CHECK_MESSAGE(none.err.find("--with-scene") != std::string::npos, none.err);
    }

    TEST_CASE("the same scene is baked to the same bytes, with any number of threads") {
        const std::string one = scratch().file("one.crofton"), two = scratch().file("two.crofton");
        REQUIRE(run_cli("bake town --instances 400 -o " + one).status == 0);
        REQUIRE(run_cli("bake town --instances 400 --threads 3 -o " + two).status == 0);
        CHECK(contents_of(one) == contents_of(two));
    }

    TEST_CASE("occluders that were baked are used in their place, and a file without them says so") {
        const std::string path = scratch().file("hides.crofton"), bare = scratch().file("bare.crofton");
        const CliRun baked = run_cli("bake town --instances 400 -o " + path + " --json -");
        REQUIRE(baked.status == 0);
        CHECK(baked.json()["occluders"].get<int>() > 100);
        CHECK(run_cli("bake " + path + " --json -").json()["occluders"] == baked.json()["occluders"]);
        const std::string frames =
            "frames town --instances 400 --camera street --frames 3 --no-draw --occlude --occlusion occluders --json "
            "- ";
        const CliRun found = run_cli(frames), known = run_cli(frames + "--baked " + path);
        REQUIRE(found.status == 0);
        REQUIRE(known.status == 0);
        for (std::size_t i = 0; i < 3; ++i) {
            const auto a = found.json()["frames"][i]["occlusion"], b = known.json()["frames"][i]["occlusion"];
            CHECK(a["visible"] == b["visible"]);
            CHECK(a["occluders"] == b["occluders"]);
            CHECK(a["visible"] < found.json()["frames"][i]["visible"]);
        }
        const CliRun without = run_cli("bake town --instances 400 --no-occluders -o " + bare + " --json -");
        REQUIRE(without.status == 0);
        CHECK(without.json()["occluders"] == 0);
        CHECK(without.json()["bytes"] < baked.json()["bytes"]);
        const CliRun none = run_cli(frames + "--baked " + bare);
        CHECK(none.status == 2);
        CHECK(none.err.find("bare.crofton") != std::string::npos);
        const CliRun other = run_cli("frames town --instances 400 --seed 2 --no-draw --occlude --baked " + path);
        CHECK(other.status == 2);
        CHECK(other.err.find("another scene") != std::string::npos);
        CHECK(run_cli("frames town --baked " + path).status == 2);  // without --occlude
    }
}
