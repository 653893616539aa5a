// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <cstdlib>
#include <filesystem>
#include <iterator>

#include "../assets/test_files.hpp"
#include "run_cli.hpp"

using namespace crofton::test;

namespace {

// Two rooms with a wall between them that has a door, and a thing in each.
std::string level() {
    const auto box = [](int number, double x0, double y0, double z0, double x1, double y1, double z1, bool inward) {
        std::string text = "o box" + std::to_string(number) + "\n";
        for (int i = 0; i < 8; ++i)
            text += "v " + std::to_string(i & 1 ? x1 : x0) + " " + std::to_string(i & 2 ? y1 : y0) + " " +
                    std::to_string(i & 4 ? z1 : z0) + "\n";
        const int first = 8 * number + 1;
        const int faces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
        for (const auto& face : faces) {
            text += "f";
            for (int k = 0; k < 4; ++k) text += " " + std::to_string(first + face[inward ? 3 - k : k]);
            text += "\n";
        }
        return text;
    };
    const std::string path = scratch().file("level.obj");
    write_contents(path, box(0, -6, 0, -3, 6, 3, 3, true) + box(1, -0.2, 0, -3, 0.2, 3, 1, false) +
                             box(2, -5, 0.5, -2.5, -4.5, 1, -2, false) + box(3, 4.5, 0.5, -2.5, 5, 1, -2, false));
    return "'" + path + "'";
}

std::string quoted(const std::string& name) {
    return "'" + scratch().file(name) + "'";
}

const char* const kSmall = " --eyes=-6,0,-3,6,3,3 --cells 6x1x3 --epsilon 2e-3 ";

}  // namespace

TEST_SUITE("cli/pvs") {
    TEST_CASE("bad cells, shards, eyes and parts are refused by name") {
        const auto refused = [&](const std::string& arguments, const char* reason) {
            const CliRun run = run_cli(arguments);
            CHECK(run.status == 2);
            CHECK_MESSAGE(run.err.find(reason) != std::string::npos, run.err);
        };
        refused("pvs " + level() + " --cells 0x1x1", "at least one cell");
        refused("pvs " + level() + " --cells 4x4", "4x4");
        refused("pvs " + level() + " --shard 3/3 --state " + quoted("p"), "3/3");
        refused("pvs " + level() + " --shard 0/3", "--state");
        refused("pvs " + level() + " --eyes 1,2,3", "--eyes");
        refused("pvs " + level() + " --epsilon 2", "epsilon");
        refused("pvs " + level() + kSmall + "--svg " + quoted("m.svg") + " --eye 90,0,0", "--eye");
        refused("pvs no_such.obj", "no_such.obj");
        write_contents(scratch().file("cells.txt"), "# boxes\n0 0 0 1 1 1\n0 0 zero 1 1 1\n");
        refused("pvs " + level() + " --cells " + quoted("cells.txt"), "line 3");
        write_contents(scratch().file("bad_part"), "nothing of the kind");
        refused("merge " + quoted("bad_part") + " --out " + quoted("sum"), "bad_part");
    }

    TEST_CASE("--cells rooms: a level's sectors as cells, away from the walls") {
        write_contents(scratch().file("room.wad"), test_files::Wad().file());
        const std::string base = "pvs " + quoted("room.wad") + " --epsilon 1e-2 --cells rooms ";
        const CliRun run = run_cli(base + "--near 0.05 --views 50 --svg " + quoted("rooms.svg") + " --json -");
        REQUIRE_MESSAGE(run.status == 0, run.err);
        const auto figures = run.json();
        // A frame around a column: at least four pieces of at most eight triangles.
        CHECK(figures.at("cells").get<int>() >= 4);
        CHECK(figures.at("cells").get<int>() <= 8);
        CHECK(figures.at("cells_solid") == 0);
        CHECK(figures.at("street_views").at("conservative").at("wrong_pixels_worst") == 0.0);
        CHECK(contents_of(scratch().file("rooms.svg")).find("<svg") == 0);
        // 60 square metres, less what is near the walls.
        const CliRun small = run_cli(base + "--near 0.05 --cell-size 1 --views 50 --json -");
        REQUIRE_MESSAGE(small.status == 0, small.err);
        CHECK(small.json().at("cells").get<int>() >= 56);
        CHECK(small.json().at("street_views").at("conservative").at("wrong_pixels_worst") == 0.0);
        // Halving leaves pieces without an area.
        for (const char* sizes : {"--near 0 --cell-size 1.5", "--near 0.05 --cell-size 0.3"})
            CHECK(run_cli(base + sizes + " --seconds 1e-9").status == 0);
        const auto refused = [&](const std::string& arguments, const char* reason) {
            const CliRun bad = run_cli(arguments);
            CHECK(bad.status == 2);
            CHECK_MESSAGE(bad.err.find(reason) != std::string::npos, bad.err);
        };
        refused(base + "--cell-size 0", "--cell-size");
        refused(base + "--near 2", "no room is larger");
        refused("pvs " + level() + " --cells rooms", "has no sectors");
    }

    TEST_CASE("a file of cells: boxes, and convex cells of four to eight corners") {
        const std::string base = "pvs " + level() + " --epsilon 1e-2 --cells " + quoted("convex.txt") + " ";
        const std::string box = "-5.9 0.1 -2.9 -3 2.9 2.9\n";
        const std::string wedge = "1 0.5 -2  5 0.5 -2  1 0.5 2  1 2.5 -2  5 2.5 -2  1 2.5 2\n";
        const std::string tetrahedron = "4 0.5 2  5 0.5 2  4 0.5 2.8  4 1.5 2\n";
        write_contents(scratch().file("convex.txt"), "# cells\n" + box + "\n" + wedge + tetrahedron);
        const CliRun run = run_cli(base + "--json - --svg " + quoted("convex.svg") + " --eye 2,1,-1");
        REQUIRE_MESSAGE(run.status == 0, run.err);
        CHECK(run.json().at("cells") == 3);
        CHECK(run.json().at("cells_solid") == 0);
        // Outside the wedge, but in its box.
        CHECK(run_cli(base + "--svg " + quoted("convex.svg") + " --eye 4.5,1,1.5").err.find("no cell holds it") !=
              std::string::npos);
        const auto refused = [&](const std::string& cells, const char* reason) {
            write_contents(scratch().file("convex.txt"), cells);
            const CliRun bad = run_cli(base);
            CHECK(bad.status == 2);
            CHECK_MESSAGE(bad.err.find(reason) != std::string::npos, bad.err);
        };
        refused(box + "0 0 0 1 1 1 2 2 2\n", "line 2");          // three corners
        refused(box + box + "0 0 0 1 1 1 0 0\n", "line 3");      // not points
        refused("0 0 0 1 0 0 0 0 1 1 0 1\n", "needs a volume");  // flat
        refused("0 0 0 1 0 0 0 0 1 1 nan 1\n", "convex.txt");
        std::string nine;
        for (int i = 0; i < 9; ++i) nine += "0 0 " + std::to_string(i) + " ";
        refused(nine + "\n", "line 1");
        refused("# nothing\n", "convex.txt");
    }

    TEST_CASE("parts merge to the state of one run, a lost one is named, and one given twice counts once") {
        const std::string base = "pvs " + level() + kSmall;
        for (int i = 0; i < 3; ++i)
            REQUIRE(run_cli(base + "--shard " + std::to_string(i) + "/3 --state " + quoted("part" + std::to_string(i)))
                        .status == 0);
        REQUIRE(run_cli(base + "--threads 2 --state " + quoted("whole")).status == 0);
        const CliRun lost =
            run_cli("merge " + quoted("part0") + " " + quoted("part2") + " --shards 3 --out " + quoted("sum"));
        CHECK(lost.status == 1);
        CHECK_MESSAGE(lost.err.find("--shard 1/3") != std::string::npos, lost.err);
        CHECK(run_cli("merge " + quoted("part2") + " " + quoted("part0") + " " + quoted("part1") + " " +
                      quoted("part0") + " --shards 3 --out " + quoted("sum"))
                  .status == 0);
        CHECK(contents_of(scratch().file("sum")) == contents_of(scratch().file("whole")));
        // States of another bake, or of another kind.
        REQUIRE(
            run_cli("study radiosity room --edge 2 --shadow-cuts 0 --runs 2 --state " + quoted("light_state")).status ==
            0);
        const CliRun light =
            run_cli("merge " + quoted("part0") + " " + quoted("light_state") + " --out " + quoted("sum"));
        CHECK(light.status == 2);
        CHECK_MESSAGE(light.err.find("light_state: is of a bake of light, and ") != std::string::npos, light.err);
        REQUIRE(run_cli(base + "--seed 2 --state " + quoted("other")).status == 0);
        const CliRun other = run_cli("merge " + quoted("part0") + " " + quoted("other") + " --out " + quoted("sum"));
        CHECK(other.status == 2);
        CHECK_MESSAGE(other.err.find("other") != std::string::npos, other.err);
        CHECK(run_cli(base + "--state " + quoted("other")).status == 2);
    }

    TEST_CASE("a bake ends in a file, a map and figures, and stopped by time it goes on to the same bytes") {
        const std::string base = "pvs " + level() + kSmall;
        const CliRun run = run_cli(base + "--out " + quoted("sets.crofton") + " --svg " + quoted("map.svg") +
                                   " --eye=-5,1,0 --json -");
        REQUIRE_MESSAGE(run.status == 0, run.err);
        const auto figures = run.json();
        CHECK(figures["cells"] == 18);
        CHECK(figures["objects"].get<int>() >= 1);
        CHECK(figures["lines"] == figures["lines_planned"]);
        CHECK(figures["epsilon"].get<double>() <= 2e-3);
        CHECK(contents_of(scratch().file("map.svg")).find("<svg") == 0);
        CHECK(run_cli(base + "--seconds 1e-9 --state " + quoted("stopped")).status == 0);
        REQUIRE(run_cli(base + "--state " + quoted("stopped") + " --out " + quoted("again.crofton")).status == 0);
        CHECK(contents_of(scratch().file("again.crofton")) == contents_of(scratch().file("sets.crofton")));
        REQUIRE(run_cli(base + "--with-scene --out " + quoted("both.crofton")).status == 0);
        CHECK(run_cli("bake " + quoted("both.crofton")).status == 0);
    }

    TEST_CASE("--views looks at the sets from random places: no wrong pixel in conservative mode, few triangles more") {
        const std::string base = "pvs " + level() + kSmall;
        const CliRun run = run_cli(base + "--views 40 --json -");
        REQUIRE_MESSAGE(run.status == 0, run.err);
        const auto views = run.json().at("street_views");
        CHECK(views.at("views") == 40);
        CHECK(views.at("eyes_in_no_cell") == 0);
        CHECK(views.at("conservative").at("wrong_pixels_worst") == 0.0);
        CHECK(views.at("statistical").at("wrong_pixels_mean").get<double>() < 1e-2);
        const double frustum = views.at("frustum_triangles"), owners = views.at("owner_triangles"),
                     conservative = views.at("conservative").at("triangles");
        CHECK(owners > 0.0);
        CHECK(conservative <= frustum);
        CHECK(conservative >= owners);
        const auto both = views.at("conservative_and_occlusion");
        CHECK(both.at("wrong_pixels_worst") == 0.0);
        CHECK(both.at("triangles").get<double>() <= conservative);
        CHECK(both.at("triangles").get<double>() >= owners);
        CHECK(run_cli(base + "--json -").json().at("street_views") == nullptr);
        CHECK(run_cli(base + "--views 0").status == 2);
        CHECK(run_cli(base + "--views 5 --shard 0/2 --state " + quoted("v")).status == 2);
        CHECK(run_cli(base + "--views 5").out.find("5 street views") != std::string::npos);
    }

    TEST_CASE("a full disk leaves the state that was there, or none, and the bake goes on to the same bytes") {
        const std::string base = "pvs " + level() + " --eyes=-6,0,-3,6,3,3 --cells 60x4x30 --epsilon 2e-2 ";
        const std::string folder = scratch().file("disk");
        std::filesystem::create_directory(folder);
        const auto state = [&](const char* name) { return folder + "/" + name; };
        REQUIRE(run_cli(base + "--shard 0/2 --state '" + state("kept") + "'").status == 0);
        REQUIRE(run_cli(base + "--state " + quoted("undisturbed")).status == 0);
        const std::string before = contents_of(state("kept"));
        CHECK(before.size() > 8 * 1024);  // more than the smaller disk below takes
        for (const char* blocks : {"0", "8"})
            for (const char* name : {"kept", "new"}) {
                const std::string command = std::string("trap '' XFSZ; ulimit -f ") + blocks + "; '" CROFTON_CLI "' " +
                                            base + "--state '" + state(name) + "' >/dev/null 2>&1";
                const int status = std::system(command.c_str());
                CHECK(WIFEXITED(status));
                CHECK(WEXITSTATUS(status) == 2);
                CHECK(contents_of(state("kept")) == before);
                CHECK(std::distance(std::filesystem::directory_iterator(folder), {}) == 1);
            }
        for (const char* name : {"kept", "new"}) {
            REQUIRE(run_cli(base + "--state '" + state(name) + "'").status == 0);
            CHECK(contents_of(state(name)) == contents_of(scratch().file("undisturbed")));
        }
    }

    TEST_CASE("a leaking level is reported by its open cells, and its sets are right") {
        const std::string closed = level(), path = scratch().file("level.obj");
        const auto open_cells = [&] {
            const CliRun run = run_cli("pvs " + closed + kSmall + "--views 40 --json -");
            REQUIRE_MESSAGE(run.status == 0, run.err);
            CHECK(run.json().at("street_views").at("conservative").at("wrong_pixels_worst") == 0.0);
            return run.json().at("cells_open").get<int>();
        };
        CHECK(open_cells() == 0);
        // Without the first room's ceiling, its fourth face.
        std::string text = contents_of(path);
        std::size_t face = 0;
        for (int i = 0; i < 4; ++i) face = text.find("\nf", face + 1);
        text.erase(face, text.find('\n', face + 1) - face);
        write_contents(path, text);
        CHECK(open_cells() >= 12);
    }
    TEST_CASE("sets of regions hide what no picture shows, in one run or in shards, and follow their regions") {
        const std::string folder = scratch().file("set_regions"), shards = scratch().file("set_shards"),
                          cameras = scratch().file("set_cameras.json"),
                          sets = " --cells 8x2x8 --reach 20 --epsilon 0.02 --near 0.3 ",
                          look = "frames '" + folder + "' --camera '" + cameras +
                                 "' --size 160x90 --occlude --occlusion sets --json - ";
        REQUIRE(run_cli("bake town --instances 1200 --regions 3x2 --folder '" + folder + "'").status == 0);
        std::filesystem::copy(folder, shards);
        nlohmann::json path;
        for (int i = 0; i < 16; ++i)
            path["cameras"].push_back({{"position", {-60.0 + 9.0 * i, 1.7, 25.0 - 4.0 * i}},
                                       {"forward", {i % 3 - 1.0, -0.02, i % 2 == 0 ? 1.0 : -1.0}},
                                       {"near_distance", 0.1}});
        write_contents(cameras, path.dump());
        // Without sets nothing is hidden.
        const CliRun before = run_cli(look);
        REQUIRE_MESSAGE(before.status == 0, before.err);
        CHECK(before.json()["summary"]["mean_occlusion_visible"] == before.json()["summary"]["mean_visible"]);
        const CliRun baked = run_cli("pvs '" + folder + "'" + sets + "--threads 2 --json -");
        REQUIRE_MESSAGE(baked.status == 0, baked.err);
        const std::size_t regions = baked.json()["regions"].get<std::size_t>();
        CHECK(baked.json()["regions_baked"] == regions);
        CHECK(baked.json()["hidden"].get<double>() > 0.02);
        const CliRun seen = run_cli(look + "--verify");
        REQUIRE_MESSAGE(seen.status == 0, seen.err);
        CHECK(seen.json()["summary"]["mismatches"] == 0);
        CHECK(seen.json()["summary"]["mean_occlusion_visible"] < before.json()["summary"]["mean_visible"]);
        CHECK(run_cli("pvs '" + folder + "' --cells 8x1x8x").err.find("NXxNYxNZ") != std::string::npos);
        // Nothing is baked twice, and shards write the same bytes.
        CHECK(run_cli("pvs '" + folder + "'" + sets + "--json -").json()["regions_baked"] == 0);
        for (const char* shard : {"0/2", "1/2"})
            REQUIRE(run_cli("pvs '" + shards + "'" + sets + "--shard " + shard).status == 0);
        std::size_t files = 0;
        std::string one;
        for (const auto& entry : std::filesystem::directory_iterator(folder)) {
            if (entry.path().string().find(".sets.crofton") == std::string::npos) continue;
            ++files;
            one = entry.path().filename().string();
            CHECK(contents_of(entry.path().string()) == contents_of(shards + "/" + one));
        }
        CHECK(files == regions);
        // A damaged file of sets, and one of another region, are named.
        const std::string good = contents_of(folder + "/" + one);
        std::string bad = good;
        bad[bad.size() / 2] ^= 1;
        write_contents(folder + "/" + one, bad);
        CHECK(run_cli(look).status == 2);
        CHECK(run_cli(look).err.find(one) != std::string::npos);
        for (const auto& entry : std::filesystem::directory_iterator(shards)) {
            const std::string other = entry.path().filename().string();
            if (other.find(".sets.crofton") != std::string::npos && other != one)
                write_contents(folder + "/" + one, contents_of(entry.path().string()));
        }
        const CliRun wrong = run_cli(look);
        CHECK(wrong.status == 2);
        CHECK_MESSAGE(wrong.err.find("crofton pvs") != std::string::npos, wrong.err);
        // A region that is baked anew loses its sets; without the flag nobody reads them.
        CHECK(run_cli("frames '" + folder + "' --frames 2 --no-draw").status == 0);
        REQUIRE(run_cli("bake town --instances 1200 --no-occluders --regions 3x2 --folder '" + folder + "'").status ==
                0);
        CHECK_FALSE(std::filesystem::exists(folder + "/" + one));
        CHECK(run_cli(look).status == 0);
        for (const char* refused : {"--out x.crofton", "--views 3", "--map E1M1", "--cells rooms", "--shard 2/2"})
            CHECK(run_cli("pvs '" + folder + "' " + refused).status == 2);
        CHECK(run_cli("frames town --occlude --occlusion sets").status == 2);
        CHECK(run_cli("pvs " + level() + " --reach 3").status == 2);
    }
}
