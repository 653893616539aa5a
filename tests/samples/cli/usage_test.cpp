// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <sys/stat.h>

#include "run_cli.hpp"

using namespace crofton::test;

TEST_SUITE("cli/usage") {
    TEST_CASE("without a sub-command, or with one that does not exist, the exit status is 2 and stdout stays empty") {
        CHECK(run_cli("").err.find("crofton: a sub-command is missing") == 0);
        for (const char* arguments : {"", "no-such-command", "--no-such-option"}) {
            const CliRun run = run_cli(arguments);
            CHECK(run.status == 2);
            CHECK(run.out.empty());
            CHECK_FALSE(run.err.empty());
        }
    }

    TEST_CASE("--version and --help answer on stdout and succeed") {
        CHECK(run_cli("--version").out.find("crofton 0.") == 0);
        CHECK(run_cli("--version").status == 0);
        const CliRun help = run_cli("--help");
        CHECK(help.status == 0);
        CHECK(help.out.find("verify") != std::string::npos);
    }

    TEST_CASE("a word that is nearly a sub-command or an option is answered with the one that was meant") {
        CHECK(run_cli("frame").err.find("there is no sub-command 'frame'; did you mean 'frames'?") !=
              std::string::npos);
        CHECK(run_cli("measure room").err.find("it is 'crofton study measure'") != std::string::npos);
        CHECK(run_cli("study").err.find("a sub-command is missing\n'crofton study --help' lists") != std::string::npos);
        CHECK(run_cli("study rdaiosity").err.find("did you mean 'radiosity'?") != std::string::npos);
        CHECK(run_cli("--hlep").err.find("there is no option '--hlep'; did you mean '--help'?") != std::string::npos);
        CHECK(run_cli("frames town --frmaes 3").err.find("there is no option '--frmaes'; did you mean '--frames'?") !=
              std::string::npos);
        CHECK(run_cli("frames town --cols=3").err.find("there is no option '--cols'") != std::string::npos);
        CHECK(run_cli("jump").err.find("did you mean") == std::string::npos);
        CHECK(run_cli("frames town street").err.find("'street' is one argument too many") != std::string::npos);
    }

    TEST_CASE("where crofton-study was not built, verify says which target to build, and the other commands work") {
        const std::string alone = scratch().file("crofton_alone");
        std::filesystem::copy_file(CROFTON_CLI, alone);
        const auto run = [&](const char* arguments) {
            const std::string err = scratch().file("err");
            const int status = std::system(("'" + alone + "' " + arguments + " >/dev/null 2>'" + err + "'").c_str());
            return std::pair(WEXITSTATUS(status), contents_of(err));
        };
        for (const char* arguments : {"verify", "help verify", "merge a --out b", "study measure room"}) {
            const auto [status, err] = run(arguments);
            CHECK(status == 2);
            CHECK(err.find("--target crofton_study_cli") != std::string::npos);
        }
        CHECK(run("collide --help").first == 0);
    }

    TEST_CASE("an option that needs another says which one, and the exit status is 2") {
        write_contents(scratch().file("square.poly"), "P square 1\n4 0 0 2 0 2 2 0 2\n");
        write_contents(scratch().file("tetra.obj"),
                       "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n");
        const std::string poly = "'" + scratch().file("square.poly") + "'",
                          obj = "'" + scratch().file("tetra.obj") + "'";
        const std::pair<std::string, const char*> cases[] = {
            {"bake " + obj, "-o is missing"},
            {"bake town", "-o is missing"},
            {"bake no_such.glb", "-o is missing"},
            {"bake x.crofton --map MAP01", "--output"},
            {"bake x.crofton --tree oriented", "--output"},
            {"bake x.crofton --no-occluders", "--output"},
            {"collide " + obj + " " + obj + " --mode cast", "--velocity"},
            {"collide " + obj + " " + obj + " --hulls --mode cast --duration 3", "--velocity"},
            {"collide " + obj + " " + obj + " --velocity 1,0,0", "--mode cast"},
            {"collide " + obj + " " + obj + " --max-vertices 8", "--hulls"},
            {"triangulate " + poly + " --tolerance 0.1", "for meshes"},
            {"triangulate " + poly + " --attribute-tolerance 0.1", "for meshes"},
            {"fit " + obj + " --budget 1 --quality fast", "--quality exact"},
            {"frames room --no-draw --ids", "--json"},
            {"frames room --no-draw --occluders 3", "--occlude"},
            {"frames room --no-draw --instances 30", "town only"},
            {"frames " + obj + " --no-draw --map MAP01", ".wad"},
            {"pvs room --cell-size 1", "--cells rooms"},
            {"pvs room --height 3 --eyes 0,0,0,1,1,1", "--eyes"},
            {"pvs room --eye 0,0,0", "--svg"},
            {"pvs room --with-scene", "--out"},
            {"pvs room --shard 0/2", "--state"},
            {"study radiosity room --shard 0/2", "--runs"},
            {"study radiosity room --stored-lines 9", "--light-field"},
            {"verify cull --map MAP01", "--scene"},
            {"verify cull --instances 40", "--scene"}};
        for (const auto& refused : cases) {
            const std::string& reason = refused.second;
            CAPTURE(refused.first);
            const CliRun run = run_cli(refused.first);
            CHECK(run.status == 2);
            CHECK(run.out == "");
            CHECK_MESSAGE(run.err.find(reason) != std::string::npos, run.err);
        }
        CHECK(run_cli("collide " + obj + " " + obj + " --mode cast --spin 0,1,0").status == 0);
    }

    TEST_CASE("help is printed for either form of the request") {
        CHECK(run_cli("help").out == run_cli("--help").out);
        CHECK(run_cli("help fit").out == run_cli("fit --help").out);
        CHECK(run_cli("help fit").status == 0);
    }

    TEST_CASE("a number that is none, or has a sign where it has no meaning, is refused by name") {
        for (const char* seed : {"x", "-1", "1e6", "99999999999999999999"}) {
            const CliRun run = run_cli(std::string("frames --no-draw --frames 1 --seed ") + seed);
            CHECK(run.status == 2);
            CHECK(run.err.find(std::string("--seed: '") + seed + "' is not a whole number") != std::string::npos);
        }
        CHECK(run_cli("frames --threads 9999").err.find("--threads") != std::string::npos);
    }

    TEST_CASE("NaN, infinity, and numbers out of range are refused, and the message says what is wanted") {
        const struct {
            const char *arguments, *reason;
        } cases[] = {
            {"frames --no-draw --frames 1 --max-seconds 0", "--max-seconds: '0' is not a number above 0"},
            {"frames --no-draw --frames 1 --max-seconds nan", "--max-seconds: 'nan' is not a number above 0"},
            {"frames --no-draw --frames 1 --max-seconds inf", "--max-seconds: 'inf' is not a number above 0"},
            {"frames --no-draw --frames 1 --max-seconds x", "--max-seconds: 'x' is not a number"},
            {"study radiosity room --error nan", "--error: 'nan' is not a number above 0"},
            {"study radiosity room --sun -1", "--sun: '-1' is not a number from 0"},
            {"fit room --budget nan", "--budget: 'nan' is not a number from 0"},
            {"view --no-window --after 1 --scale nan", "--scale: 'nan' is not a number in [0.5 - 8]"},
        };
        for (const auto& c : cases) {
            CAPTURE(c.arguments);
            const CliRun run = run_cli(c.arguments);
            CHECK(run.status == 2);
            CHECK(run.out.empty());
            CHECK(run.err.find(c.reason) != std::string::npos);
        }
        CHECK(run_cli("frames room --no-draw --frames 1 --max-seconds 1e3").status == 0);
    }

    TEST_CASE("an option that does nothing without another one is refused without it") {
        const struct {
            const char *arguments, *option, *other;
        } cases[] = {
            {"collide room room --max-vertices 9", "--max-vertices", "--hulls"},
            {"study radiosity room --stored-lines 9", "--stored-lines", "--light-field"},
            {"pvs room --cells 1x1x1 --with-scene", "--with-scene", "--out"},
            {"pvs room --cells 1x1x1 --eye 1,1,1", "--eye", "--svg"},
        };
        for (const auto& c : cases) {
            CAPTURE(c.arguments);
            const CliRun run = run_cli(c.arguments);
            CHECK(run.status == 2);
            CHECK(run.err.find(std::string(c.option) + " requires " + c.other) != std::string::npos);
        }
        for (const char* option : {"--velocity 1,0,0", "--spin 1,0,0", "--duration 2"}) {
            const CliRun run = run_cli(std::string("collide room room ") + option);
            CHECK(run.status == 2);
            CHECK(run.err.find("--velocity, --spin and --duration go with --mode cast") != std::string::npos);
        }
    }

    TEST_CASE("an output that is also read is refused before anything is lost") {
        REQUIRE(run_cli("triangulate room --out '" + scratch().file("room.glb") + "'").status == 0);
        const std::string scene = scratch().file("room.glb"), link = scratch().file("room_link.csv");
        const std::string before = contents_of(scene);
        std::filesystem::create_symlink(scene, link);
        for (const std::string& arguments : {"frames '" + scene + "' --no-draw --frames 1 --csv '" + link + "'",
                                             "fit room '" + scene + "' --svg '" + scene + "'",
                                             "frames --camera '" + scene + "' --json '" + scene + "'"}) {
            CAPTURE(arguments);
            const CliRun run = run_cli(arguments);
            CHECK(run.status == 2);
            CHECK(run.err.find(" would replace '" + scene + "', which is read") != std::string::npos);
            CHECK(contents_of(scene) == before);
        }
        // States are read and written by intent.
        const std::string state = " --state '" + scratch().file("own.state") + "'";
        const std::string bake = "study radiosity room --edge 2 --shadow-cuts 0 --runs 2" + state;
        CHECK(run_cli(bake).status == 0);
        CHECK(run_cli(bake).status == 0);
    }

    TEST_CASE("a place where nothing can be written is refused before the work") {
        const std::string folder = scratch().file("folder");
        std::filesystem::create_directories(folder);
        const std::string file = scratch().file("plain");
        write_contents(file, "");
        for (const std::string& place : {folder, folder + "/missing/a.json", file + "/a.json"}) {
            const CliRun run = run_cli("frames --no-draw --frames 1 --json '" + place + "'");
            CHECK(run.status == 2);
            CHECK(run.out.empty());
            CHECK(run.err.find(place) != std::string::npos);
        }
    }

    TEST_CASE("the message says what is missing, and what --cells may be") {
        CHECK(run_cli("fit").err.find("an argument is missing: files") != std::string::npos);
        CHECK(run_cli("collide a.obj").err.find("an argument is missing: B") != std::string::npos);
        for (const std::string option : {"frames --json", "frames --frames", "collide a b --pose", "pvs room --near",
                                         "fit room --criterion", "verify --trials", "study measure --lines"})
            CHECK(run_cli(option).err.find(option.substr(option.rfind('-') - 1) + ": its value is missing") !=
                  std::string::npos);
        const CliRun cells = run_cli("pvs room --cells 4x4 --out p.crofton");
        CHECK(cells.status == 2);
        CHECK(cells.err.find("--cells 4x4: there is no such file; a grid is three numbers") != std::string::npos);
    }

    TEST_CASE("two outputs into one file, or both to stdout, are refused by their names before the work") {
        const std::string out = scratch().file("both"), link = scratch().file("both_link");
        write_contents(out, "old");
        std::filesystem::create_symlink(out, link);
        const std::string first = " '" + out + "' ", second = " '" + link + "'";
        const struct {
            std::string command, first, second;
        } pairs[] = {
            {"triangulate town", "--json", "--out"},
            {"triangulate a.poly", "--json", "--svg"},
            {"view --no-window --after 1", "--screenshot", "--json"},
            {"study hierarchy --lines 1000", "--json", "--svg"},
            {"pvs room --cells 1x1x1", "--state", "--out"},
            {"study radiosity room", "--out", "--png"},
            {"study radiosity room", "--json", "--checkpoint"},
            {"bake room", "--output", "--json"},
            {"fit room", "--json", "--svg"},
            {"frames --no-draw --frames 1", "--report", "--trace"},
        };
        for (const auto& p : pairs) {
            CAPTURE(p.command);
            const CliRun run = run_cli(p.command + " " + p.first + first + p.second + second);
            CHECK(run.status == 2);
            CHECK(run.err.find(p.first + " and " + p.second + " name one file") != std::string::npos);
            CHECK(contents_of(out) == "old");
        }
        for (const char* command : {"triangulate a.poly --json - --svg -",
                                    "study hierarchy --lines 1000 --json - --svg -", "fit room --json - --svg -"})
            CHECK(run_cli(command).err.find("--json and --svg cannot both go to stdout") != std::string::npos);
        // Through two links to a file that is not there yet.
        const std::string later = scratch().file("later"), to_later = scratch().file("to_later");
        std::filesystem::create_symlink("later", to_later);
        std::filesystem::create_symlink(to_later, scratch().file("to_link"));
        const CliRun run =
            run_cli("triangulate a.poly --json '" + later + "' --svg '" + scratch().file("to_link") + "'");
        CHECK(run.status == 2);
        CHECK(run.err.find("--json and --svg name one file") != std::string::npos);
        CHECK(run_cli("frames --no-draw --frames 1 --json a --csv ./a").status == 2);
        CHECK(run_cli("frames --no-draw --frames 1 --json - --csv -").status == 2);
        CHECK(run_cli("frames --no-draw --frames 1 --json /dev/null --csv /dev/null").status == 0);
    }

    TEST_CASE("an output that shares stdout with the command's own words is refused") {
        for (const char* arguments : {"bake room -o -", "pvs room --cells 1x1x1 --svg -", "frames --no-draw --trace -",
                                      "study radiosity room --out -", "merge a b --out -"}) {
            const CliRun run = run_cli(arguments);
            CHECK(run.status == 2);
            CHECK(run.out.empty());
            CHECK(run.err.find("cannot go to stdout") != std::string::npos);
        }
    }

    TEST_CASE("special files are written to and stay what they are, and a full disk is an error") {
        const std::string link = scratch().file("link.csv"), target = scratch().file("target.csv");
        write_contents(target, "old");
        std::filesystem::create_symlink(target, link);
        CHECK(run_cli("frames --no-draw --frames 1 --csv '" + link + "'").status == 0);
        CHECK(std::filesystem::is_symlink(link));
        CHECK(contents_of(target).find("index,") == 0);

        const std::string pipe = scratch().file("pipe");
        REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
        const std::string copy = scratch().file("copy");
        const int status =
            std::system(("cat '" + pipe + "' >'" + copy + "' & '" CROFTON_CLI "' frames --no-draw --frames 1 --csv '" +
                         pipe + "' >/dev/null; wait")
                            .c_str());
        CHECK(status == 0);
        CHECK(std::filesystem::is_fifo(pipe));
        CHECK(contents_of(copy).find("index,") == 0);

        const std::string full = scratch().file("full.csv");  // a link, so that even a failing program harms no device
        std::filesystem::create_symlink("/dev/full", full);
        const CliRun run = run_cli("frames --no-draw --frames 1 --csv '" + full + "'");
        CHECK(run.status == 2);
        CHECK(run.err.find("cannot write") != std::string::npos);
        CHECK(std::filesystem::is_character_file("/dev/full"));
        CHECK(WEXITSTATUS(std::system("'" CROFTON_CLI "' frames --no-draw --frames 1 >/dev/full 2>/dev/null")) == 2);
    }

    TEST_CASE("a scene that is a folder, an empty file, or no .crofton file is refused for that reason") {
        const std::string folder = scratch().file("scenes.glb"), empty = scratch().file("empty.obj");
        std::filesystem::create_directories(folder);
        write_contents(empty, "");
        CHECK(run_cli("frames '" + folder + "'").err.find("is a folder; name a file in it") != std::string::npos);
        CHECK(run_cli("frames '" + empty + "'").err.find("the file is empty") != std::string::npos);
        CHECK(run_cli("frames a.crofton").err.find("'crofton bake' writes") != std::string::npos);
        CHECK(run_cli("bake town").err.find("say where to: -o FILE") != std::string::npos);
        CHECK(run_cli("frames town --map MAP01 --no-draw").err.find("in a .wad file only") != std::string::npos);
    }
}
