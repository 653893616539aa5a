// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>

#include "run_cli.hpp"

using namespace crofton::test;
using nlohmann::json;

namespace {

// A town small enough that brute force takes no time.
const std::string kSmallTown = "frames town --instances 400 --size 160x90 ";

bool says(const std::string& text, const std::string& what) {
    return text.find(what) != std::string::npos;
}

}  // namespace

TEST_SUITE("cli/frames") {
    TEST_CASE("bad options and files end with status 2, name the culprit and leave no output behind") {
        const std::string output = scratch().file("never.json");
        write_contents(scratch().file("damaged.glb"), std::string("glTF\x02\0\0\0", 8));
        write_contents(scratch().file("nan.obj"), "v 0 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n");
        write_contents(scratch().file("index.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
        write_contents(scratch().file("empty.obj"), "# nothing\n");
        write_contents(scratch().file("cameras.json"), "[{\"position\": [0, 0, \"x\"]}]");
        write_contents(scratch().file("far.gltf"),
                       R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
            "nodes": [{"translation": [1e39, 0, 0], "name": "runaway"}]})");
        struct Case {
            std::string arguments, culprit;
        };
        const Case cases[] = {
            {"no-such-file.glb", "no-such-file.glb"},
            {"town --size 0x90", "0x90"},
            {"town --bounds ball", "ball"},
            {"town --cull sometimes", "sometimes"},
            {"town --frames 0", "frames"},
            {"town --camera nowhere", "nowhere"},
            {"town --camera " + scratch().file("cameras.json"), "cameras.json"},
            {scratch().file("cameras.json"), "json"},
            {scratch().file("damaged.glb"), "damaged.glb"},
            {scratch().file("nan.obj"), "nan.obj"},
            {scratch().file("index.obj"), "index.obj"},
            {scratch().file("empty.obj"), "empty.obj"},
            {scratch().file("far.gltf"), "node 0 'runaway' and all below it: left out: transform"},
            {"town --png pictures --no-draw", "--no-draw excludes --png"},
            {"town --occluders 10", "occlude"},
            {"town --occlude --occlusion-size 4x90", "4x90"},
            {"town --occlude --occlusion boxes", "boxes"},
            {"town --shadow 64", "occlude"},
            {"town --occlude --shadow 8", "--shadow"},
            {"town --occlude --occlusion occluders --shadow 64", "--shadow needs --occlusion depth"},
            {"town --occlude --occlusion depth --occluders 9", "need --occlusion occluders"},
        };
        for (const Case& wrong : cases) {
            CAPTURE(wrong.arguments);
            const CliRun run = run_cli("frames " + wrong.arguments + " --json " + output);
            CHECK(run.status == 2);
            CHECK(says(run.err, wrong.culprit));
            CHECK(run.out.empty());
            CHECK_FALSE(std::filesystem::exists(output));
            CHECK_FALSE(std::filesystem::exists(output + ".partial"));
        }
    }

    TEST_CASE("an output that cannot be written is an error, not silence") {
        CHECK(run_cli(kSmallTown + "--frames 1 --no-draw --json /no/such/folder/out.json").status == 2);
        CHECK(run_cli(kSmallTown + "--frames 1 --no-draw --json - --csv -").status == 2);
    }

    TEST_CASE("without a Vulkan driver the frames run without drawing and say so, and --png is an error") {
        const std::string no_driver = "VK_ICD_FILENAMES=/dev/null VK_DRIVER_FILES=/dev/null";
        const CliRun undrawn = run_cli(kSmallTown + "--frames 2 --json -", no_driver);
        CHECK(undrawn.status == 0);
        CHECK(says(undrawn.err, "not drawing"));
        CHECK(undrawn.json()["frames"][0]["gpu"].is_null());
        CHECK(run_cli(kSmallTown + "--frames 2 --png " + scratch().file("undrawn"), no_driver).status == 2);
    }

    TEST_CASE("the JSON has every documented field, and the counts agree with each other") {
        const CliRun run = run_cli(kSmallTown + "--frames 6 --camera street --ids --json -");
        REQUIRE(run.status == 0);
        const json document = run.json();
        REQUIRE(document.is_object());
        for (const char* field : {"name", "nodes", "instances", "triangles"}) CHECK(document["scene"].contains(field));
        REQUIRE(document["frames"].size() == 6);
        for (const json& frame : document["frames"]) {
            for (const char* field : {"index",
                                      "camera",
                                      "instances",
                                      "visible",
                                      "inside",
                                      "straddling",
                                      "improper",
                                      "nodes_tested",
                                      "triangles_submitted",
                                      "triangles_passed",
                                      "triangles_clipped",
                                      "triangles_seen",
                                      "passed_per_seen",
                                      "instances_seen",
                                      "gpu",
                                      "colliding_pairs",
                                      "update_us",
                                      "cull_us",
                                      "collide_us",
                                      "draw_us",
                                      "visible_ids",
                                      "colliding_ids",
                                      "pairs_tested",
                                      "separated_by_face_a",
                                      "separated_by_face_b",
                                      "separated_by_edges",
                                      "pairs_refined",
                                      "contacts"})
                CHECK_MESSAGE(frame.contains(field), field);
            for (const char* field : {"position", "forward", "up", "fov_y", "aspect", "near", "far"})
                CHECK_MESSAGE(frame["camera"].contains(field), field);
            CHECK(frame["inside"].get<int>() + frame["straddling"].get<int>() == frame["visible"].get<int>());
            CHECK(frame["improper"].get<int>() <= frame["straddling"].get<int>());
            CHECK(frame["triangles_passed"].get<int>() <= frame["triangles_submitted"].get<int>());
            CHECK(frame["visible_ids"].size() == frame["visible"].get<std::size_t>());
            CHECK(frame["colliding_ids"].size() == frame["colliding_pairs"].get<std::size_t>());
            const int separated = frame["separated_by_face_a"].get<int>() + frame["separated_by_face_b"].get<int>() +
                                  frame["separated_by_edges"].get<int>();
            CHECK(frame["pairs_tested"].get<int>() == separated + frame["colliding_pairs"].get<int>());
            CHECK(frame["pairs_refined"].get<int>() <= frame["pairs_tested"].get<int>());
            CHECK(frame["contacts"].get<int>() <= 8 * frame["colliding_pairs"].get<int>());
            CHECK(frame["contacts"].get<int>() >= frame["colliding_pairs"].get<int>());
            if (frame["gpu"].is_object()) {
                CHECK(frame["gpu"]["input_assembly_primitives"] == frame["triangles_submitted"]);
                CHECK(frame["gpu"]["clipping_invocations"] == frame["triangles_submitted"]);
                CHECK(frame["gpu"]["clipping_primitives"] == frame["triangles_clipped"]);
            }
        }
        CHECK(document["summary"]["mismatches"] == 0);
    }

    TEST_CASE("brute force finds nothing wrong, with any bound and way of culling") {
        for (const char* choice :
             {"--bounds sphere", "--bounds aabb", "--bounds obb-volume", "--bounds obb-area", "--bounds obb-frustum",
              "--cull flat", "--cull none", "--camera street", "--camera random"}) {
            CAPTURE(choice);
            const CliRun run = run_cli(kSmallTown + "--frames 8 --verify --json - " + choice);
            CHECK(run.status == 0);
            const json document = run.json();
            REQUIRE(document.contains("summary"));
            CHECK(document["summary"]["verified"] == true);
            CHECK(document["summary"]["mismatches"] == 0);
        }
    }

    TEST_CASE("--trace writes zones that nest, with the stages of each frame") {
        const std::string file = scratch().file("trace.json");
        REQUIRE(run_cli(kSmallTown + "--frames 3 --no-draw --occlude --occlusion occluders --trace " + file).status ==
                0);
        std::ifstream stream(file);
        const json events = json::parse(stream)["traceEvents"];
        std::vector<std::string> open;
        std::map<std::string, int> ended;
        double time = 0.0;
        for (const json& event : events) {
            CHECK(event["ts"].get<double>() >= time);
            time = event["ts"];
            if (event["ph"] == "B") open.push_back(event["name"]);
            if (event["ph"] == "E") {
                REQUIRE(!open.empty());
                CHECK(open.back() == event["name"]);
                ++ended[open.back()];
                open.pop_back();
            }
        }
        CHECK(open.empty());
        CHECK(ended["frame"] == 3);
        CHECK(ended["view: draw occluders"] == 3);
        CHECK(ended["World::update"] >= 3);
        CHECK(run_cli(kSmallTown + "--frames 1 --no-draw --trace /no/such/folder/t.json").status == 2);
    }

    TEST_CASE("with --occlude frames have both columns, the second has less, and nothing that owns a pixel is hidden") {
        for (const char* choice : {"", "--bounds sphere", "--bounds aabb --cull flat", "--threads 2",
                                   "--occlusion occluders", "--occlusion-size 64x36", "--occluders 0"}) {
            CAPTURE(choice);
            const CliRun run =
                run_cli(kSmallTown + "--frames 6 --camera street --occlude --verify --ids --json - " + choice);
            REQUIRE(run.status == 0);
            const json document = run.json();
            CHECK(document["summary"]["mismatches"] == 0);
            CHECK(document["summary"]["hidden_but_seen"] == 0);
            CHECK(document["summary"]["changed_pictures"] == 0);
            const bool hides = std::string(choice) != "--occluders 0";
            std::size_t hidden = 0;
            for (const json& frame : document["frames"]) {
                const json& with = frame["occlusion"];
                REQUIRE(with.is_object());
                for (const char* field : {"visible", "occluders", "triangles_submitted", "triangles_passed",
                                          "triangles_clipped", "gpu", "occlude_us", "draw_us"})
                    CHECK_MESSAGE(with.contains(field), field);
                CHECK(with["visible_ids"].size() == with["visible"].get<std::size_t>());
                CHECK(with["triangles_passed"].get<int>() <= frame["triangles_passed"].get<int>());
                hidden += frame["visible"].get<std::size_t>() - with["visible"].get<std::size_t>();
                if (!with["gpu"].is_object()) continue;
                CHECK(with["gpu"]["input_assembly_primitives"] == with["triangles_submitted"]);
                CHECK(with["gpu"]["clipping_primitives"] == with["triangles_clipped"]);
                CHECK(frame["triangles_seen"].get<int>() <= with["triangles_passed"].get<int>());
                CHECK(frame["instances_seen"].get<int>() > 0);
                CHECK(frame["instances_seen"].get<int>() <= with["visible"].get<int>());
            }
            CHECK((hidden > 0) == hides);
        }
        CHECK(run_cli(kSmallTown + "--frames 1 --no-draw --json -").json()["frames"][0]["occlusion"].is_null());
    }

    TEST_CASE("owned pixels are counted in every drawn frame, and are the same with and without occlusion") {
        const std::string path = kSmallTown + "--frames 4 --camera street ";
        const json plain = run_cli(path + "--json -").json(), occluded = run_cli(path + "--occlude --json -").json();
        if (plain["summary"]["drawn"] == false) {
            MESSAGE("skipped: nothing can be drawn here");
            return;
        }
        double passed = 0.0, seen = 0.0;
        for (std::size_t i = 0; i < 4; ++i) {
            const json &without = plain["frames"][i], &with = occluded["frames"][i];
            CHECK(static_cast<bool>(without["triangles_seen"] == with["triangles_seen"] &&
                                    without["instances_seen"] == with["instances_seen"]));
            CHECK(without["triangles_seen"].get<int>() > 0);
            CHECK(without["triangles_seen"].get<int>() <= with["occlusion"]["triangles_passed"].get<int>());
            CHECK(without["instances_seen"].get<int>() <= with["occlusion"]["visible"].get<int>());
            passed += without["triangles_passed"].get<double>();
            seen += without["triangles_seen"].get<double>();
        }
        CHECK(plain["summary"]["passed_per_seen"].get<double>() == doctest::Approx(passed / seen));
        CHECK(occluded["summary"]["passed_per_seen"] == plain["summary"]["passed_per_seen"]);
        CHECK(occluded["summary"]["occlusion_passed_per_seen"].get<double>() < passed / seen);
        const CliRun table = run_cli(path + "--occlude");
        CHECK(says(table.out, "passed / seen: "));
        CHECK(says(run_cli(path + "--csv -").out, "triangles_seen,passed_per_seen,instances_seen"));
        // Not counted where it is not wanted, nor where nothing is drawn.
        const json none = run_cli(path + "--no-seen --json -").json();
        CHECK(none["frames"][0]["triangles_seen"].is_null());
        CHECK_FALSE(none["summary"].contains("passed_per_seen"));
        CHECK(run_cli(path + "--no-draw --json -").json()["frames"][0]["triangles_seen"].is_null());
        CHECK_FALSE(says(run_cli(path + "--no-seen --csv -").out, "seen"));
    }

    TEST_CASE("a shadow map needs few of its casters") {
        const std::string path = kSmallTown + "--frames 3 --camera street --no-draw --occlude --shadow 256 ";
        const json document = run_cli(path + "--json -").json();
        for (const json& frame : document["frames"]) {
            const json& shadow = frame["shadow"];
            CHECK(shadow["casters_listed"].get<int>() > 0);
            CHECK(shadow["casters_listed"].get<int>() <= shadow["casters"].get<int>());
            CHECK(2 * shadow["triangles_listed"].get<int>() < shadow["triangles"].get<int>());
            CHECK(shadow["find_us"].get<double>() > 0.0);
        }
        CHECK(document["summary"].contains("mean_shadow_triangles_listed"));
        const json threads = run_cli(path + "--threads 2 --json -").json();
        CHECK(threads["summary"]["mean_shadow_triangles_listed"] ==
              document["summary"]["mean_shadow_triangles_listed"]);
        CHECK(says(run_cli(path).out, "triangles of the shadow map"));
        CHECK(says(run_cli(path + "--csv -").out, "shadow_casters,shadow_triangles,shadow_casters_listed"));
    }

    TEST_CASE("the table and the CSV hold both columns") {
        const std::string csv = scratch().file("occlusion.csv");
        const CliRun run = run_cli(kSmallTown + "--frames 3 --camera street --occlude --csv " + csv);
        REQUIRE(run.status == 0);
        CHECK(says(run.out, "triangles submitted"));
        CHECK(says(run.out, "without"));
        CHECK(says(run.out, "ms of the frame, median"));
        CHECK(says(run.out, "ms of the frame, 99 % are below"));
        for (const char* column : {"occlusion_visible", "occlusion_triangles_submitted", "occlusion_occlude_us"})
            CHECK_MESSAGE(says(contents_of(csv), column), column);
    }

    TEST_CASE("flat and tree culling see the same instances, with one thread or two, and again from a recorded path") {
        const std::string recorded = scratch().file("recorded.json");
        const auto ids_of = [](const json& document) {
            json ids = json::array();
            for (const json& frame : document["frames"]) ids.push_back({frame["visible_ids"], frame["colliding_ids"]});
            return ids;
        };
        REQUIRE(
            run_cli(kSmallTown + "--frames 10 --camera random --seed 5 --no-draw --ids --json " + recorded).status ==
            0);
        const json expected = ids_of(json::parse(contents_of(recorded)));
        for (const std::string& choice : {std::string("--cull flat --camera random"),
                                          std::string("--threads 2 --camera random"), "--camera " + recorded}) {
            CAPTURE(choice);
            const CliRun run = run_cli(kSmallTown + "--frames 10 --seed 5 --no-draw --ids --json - " + choice);
            REQUIRE(run.status == 0);
            CHECK(static_cast<bool>(ids_of(run.json()) == expected));
        }
    }

    TEST_CASE("pictures and CSV are written, one per frame and one line per frame") {
        const std::string folder = scratch().file("pictures"), csv = scratch().file("frames.csv");
        const CliRun run = run_cli(kSmallTown + "--frames 2 --csv " + csv + " --png " + folder);
        if (run.status != 0) {
            MESSAGE("no Vulkan driver here: " << run.err);
            return;
        }
        const std::string text = contents_of(csv);
        CHECK(std::count(text.begin(), text.end(), '\n') == 3);
        CHECK(contents_of(folder + "/frame_0001.png").substr(1, 3) == "PNG");
        CHECK(says(run.out, "instances"));
    }

    TEST_CASE(
        "a street through regions is at a person's height between houses, and says nothing of what was not drawn") {
        const std::string folder = scratch().file("street_regions");
        REQUIRE(run_cli("bake town --instances 1500 --regions 4x4 --folder " + folder).status == 0);
        const CliRun table = run_cli("frames " + folder + " --camera street --frames 2 --no-draw --occlude");
        REQUIRE_MESSAGE(table.status == 0, table.err);
        CHECK(says(table.out, " instances\n"));
        CHECK_FALSE(says(table.out, " 0 triangles"));
        CHECK(says(table.out, "        -       -       - "));  // triangles seen, and met for each
        const json walk = run_cli("frames " + folder + " --camera street --frames 24 --no-draw --json -").json();
        CHECK(walk["scene"]["triangles"].is_null());
        for (const json& frame : walk["frames"]) {
            CHECK(frame["camera"]["position"][1].get<double>() > 1.6);
            CHECK(frame["camera"]["position"][1].get<double>() < 5.0);  // a meadow's hill
            CHECK(frame["visible"].get<int>() > 20);
            CHECK(frame["triangles_seen"].is_null());
        }
    }

    TEST_CASE("a flight over regions counts what the whole scene's frames count, on any number of threads") {
        const std::string folder = scratch().file("flight"), whole = scratch().file("flight.crofton"),
                          path = scratch().file("flight.json"),
                          fly = "frames " + folder + " --frames 24 --no-draw --json ";
        REQUIRE(run_cli("bake town --instances 3000 --regions 5x4 --folder " + folder).status == 0);
        REQUIRE(run_cli("bake town --instances 3000 -o " + whole).status == 0);
        const CliRun flight = run_cli(fly + path + " --ids --occlude");
        REQUIRE_MESSAGE(flight.status == 0, flight.err);
        CHECK(says(flight.out, "the first frame was found"));
        const CliRun scene = run_cli("frames " + whole + " --no-draw --occlude --camera " + path + " --json -");
        REQUIRE_MESSAGE(scene.status == 0, scene.err);
        const json here = json::parse(contents_of(path)), there = scene.json();
        std::size_t visible = 0;
        for (std::size_t i = 0; i < 24; ++i) {
            CAPTURE(i);
            for (const char* key : {"instances", "visible", "inside", "straddling", "improper", "triangles_submitted",
                                    "triangles_passed", "triangles_clipped"})
                CHECK(here["frames"][i][key] == there["frames"][i][key]);
            const json& ids = here["frames"][i]["visible_ids"];
            CHECK(std::set<int>(ids.begin(), ids.end()).size() == here["frames"][i]["visible"].get<std::size_t>());
            CHECK(here["frames"][i]["occlusion"]["triangles_passed"] <= here["frames"][i]["triangles_passed"]);
            visible += ids.size();
        }
        CHECK(visible > 1000);
        const json& regions = here["summary"]["regions"];
        CHECK(regions["came"].get<int>() > 5);
        CHECK(regions["went"].get<int>() > 0);
        // What is loaded when does not matter, but to a flight that waits for nothing.
        const json again = run_cli(fly + "- --ids --occlude --threads 3").json();
        for (std::size_t i = 0; i < 24; ++i)
            for (const char* key : {"visible_ids", "triangles_passed", "nodes_tested"})
                CHECK(again["frames"][i][key] == here["frames"][i][key]);
        const CliRun live = run_cli(fly + "- --real-time");
        REQUIRE_MESSAGE(live.status == 0, live.err);
        const json live_frames = live.json()["frames"];
        for (const json& frame : live_frames) {
            CHECK(frame["regions"]["came"].get<int>() <= 1);
            CHECK(frame["regions"]["wait_us"].get<double>() < 1e5);
        }
        const CliRun hidden = run_cli(fly + "- --occlude --occlusion occluders");
        REQUIRE_MESSAGE(hidden.status == 0, hidden.err);
        CHECK(hidden.json()["summary"]["mean_occlusion_visible"] <= hidden.json()["summary"]["mean_visible"]);
        for (const char* how : {"", " --occlude", " --occlude --occlusion occluders"}) {
            const CliRun checked = run_cli("frames " + folder + " --frames 8 --verify --json -" + how);
            REQUIRE_MESSAGE(checked.status == 0, checked.err);
            CHECK(checked.json()["summary"]["verified"] == true);
            CHECK(checked.json()["summary"]["mismatches"] == 0);
        }
        // What does not fit is refused, and a damaged region is named.
        for (const char* wrong :
             {"--verify --real-time", "--bounds aabb", "--cull flat", "--map MAP01", "--camera nowhere"})
            CHECK(run_cli(fly + "- " + wrong).status == 2);
        CHECK(says(run_cli(kSmallTown + "--real-time").err, "--real-time"));
        const std::string victim = folder + "/r2_2.crofton";
        std::string bytes = contents_of(victim);
        REQUIRE(!bytes.empty());
        bytes[bytes.size() / 2] ^= 1;
        write_contents(victim, bytes);
        const CliRun damaged = run_cli(fly + "-");
        CHECK(damaged.status == 2);
        CHECK_MESSAGE(says(damaged.err, "r2_2.crofton"), damaged.err);
    }
}
