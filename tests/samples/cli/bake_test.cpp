// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <thread>
#include <vector>

#include "child.hpp"
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
        for (const char* key : {"bytes", "instances", "meshes", "triangles", "polygons", "nodes", "tree_height",
                                "clusters", "cluster_bytes"})
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

    TEST_CASE("a baked glTF gives the pictures of the glTF: flat faces, back faces and light of its own are kept") {
        // Two crossed triangles without normals, one of them seen from its front alone, and an unlit one.
        const std::string triangle = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAABAAIAAAA=";
        write_contents(scratch().file("looks.gltf"),
                       R"({"asset":{"version":"2.0"},"extensionsUsed":["KHR_materials_unlit"],"scene":0,
            "scenes":[{"nodes":[0,1,2]}],"nodes":[{"mesh":0},{"mesh":1,"translation":[1.5,0,0]},
            {"mesh":2,"translation":[0,1.5,0]}],"materials":[{"doubleSided":true},
            {"doubleSided":true,"extensions":{"KHR_materials_unlit":{}},"pbrMetallicRoughness":{"baseColorFactor":[1,0,0,1]}}],
            "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]},
            {"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0}]},
            {"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":1}]}],
            "buffers":[{"byteLength":44,"uri":"data:application/octet-stream;base64,)" +
                           triangle + R"("}],"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":36},
            {"buffer":0,"byteOffset":36,"byteLength":6}],"accessors":[
            {"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},
            {"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}]})");
        const std::string gltf = "'" + scratch().file("looks.gltf") + "'", baked = scratch().file("looks.crofton");
        const CliRun bake = run_cli("bake " + gltf + " -o " + baked);
        REQUIRE_MESSAGE(bake.status == 0, bake.err);
        const std::string own = scratch().file("own"), shown = scratch().file("shown");
        const std::string frames = " --frames 4 --size 96x64 --occlude --ids --json - --png ";
        const CliRun a = run_cli("frames " + gltf + frames + own), b = run_cli("frames " + baked + frames + shown);
        REQUIRE_MESSAGE(a.status == 0, a.err);
        REQUIRE_MESSAGE(b.status == 0, b.err);
        for (std::size_t i = 0; i < 4; ++i) {
            const auto x = a.json()["frames"][i], y = b.json()["frames"][i];
            for (const char* key : {"camera", "visible_ids", "triangles_passed", "triangles_seen"})
                CHECK(x[key] == y[key]);
            const std::string picture = "/frame_000" + std::to_string(i) + ".png";
            CHECK(contents_of(own + picture) == contents_of(shown + picture));
        }
    }

    TEST_CASE("clusters are baked and counted, and a baked scene passes the triangles that its own would") {
        const std::string path = scratch().file("clusters.crofton"), bare = scratch().file("no_clusters.crofton");
        const CliRun baked = run_cli("bake room -o " + path + " --json -"),
                     without = run_cli("bake room --no-clusters -o " + bare + " --json -");
        REQUIRE(baked.status == 0);
        REQUIRE(without.status == 0);
        CHECK(without.json()["clusters"] == 0);
        CHECK(baked.json()["clusters"].get<int>() > 0);
        // The bytes of the clusters are what the file is larger by: sections begin at multiples of 64.
        const auto more = baked.json()["bytes"].get<double>() - without.json()["bytes"].get<double>();
        CHECK(more >= baked.json()["cluster_bytes"].get<double>());
        CHECK(more <= baked.json()["cluster_bytes"].get<double>() + 8.0 * baked.json()["meshes"].get<double>() + 256.0);
        const std::string frames = " --frames 3 --camera street --no-draw --occlude --json -";
        const CliRun own = run_cli("frames room" + frames);
        for (const std::string& file : {path, bare}) {
            const CliRun shown = run_cli("frames " + file + frames);
            REQUIRE_MESSAGE(shown.status == 0, shown.err);
            for (std::size_t i = 0; i < 3; ++i) {
                const auto a = own.json()["frames"][i], b = shown.json()["frames"][i];
                CHECK(a["camera"] == b["camera"]);
                CHECK(a["occlusion"]["triangles_passed"] == b["occlusion"]["triangles_passed"]);
            }
        }
        // A damaged section is named.
        std::string damaged = contents_of(path);
        const std::size_t entry = damaged.find("clusters");
        std::uint64_t offset = 0;
        REQUIRE(entry != std::string::npos);
        std::memcpy(&offset, damaged.data() + entry + 8, 8);
        damaged[offset + 100] ^= 1;
        write_contents(path, damaged);
        const CliRun refused = run_cli("frames " + path + frames);
        CHECK(refused.status == 2);
        CHECK_MESSAGE(refused.err.find("section 'clusters' is damaged") != std::string::npos, refused.err);
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

    TEST_CASE("a scene is baked into regions, to the same bytes on any number of threads, and the folder is checked") {
        const std::string one = scratch().file("one"), two = scratch().file("two");
        const std::string bake = "bake town --instances 400 --no-occluders --regions 3x2 --json - --folder ";
        const CliRun first = run_cli(bake + one), second = run_cli(bake + two + " --threads 3");
        REQUIRE_MESSAGE(first.status == 0, first.err);
        REQUIRE_MESSAGE(second.status == 0, second.err);
        CHECK(first.json()["regions"] == 6);
        std::size_t files = 0;
        for (const auto& entry : std::filesystem::directory_iterator(one)) {
            const std::string name = entry.path().filename().string();
            CHECK(contents_of(one + "/" + name) == contents_of(two + "/" + name));
            ++files;
        }
        CHECK(files == 7);
        const CliRun checked = run_cli("bake " + one + " --json -");
        REQUIRE_MESSAGE(checked.status == 0, checked.err);
        for (const char* key : {"regions", "instances", "bytes"}) CHECK(checked.json()[key] == first.json()[key]);
        CHECK(checked.json()["instances"].get<int>() > 300);
        // It is no one scene, and what is baked is triangulated already: commands that need those say so.
        for (const std::string command : {"fit ", "triangulate ", "study measure ", "bake -o x.crofton "}) {
            const CliRun run = run_cli(command + one);
            CHECK(run.status == 2);
            CHECK_MESSAGE(
                run.err.find("is a folder of regions, which frames, view, bake and pvs take") != std::string::npos,
                run.err);
        }
        for (const std::string command : {"frames --no-draw ", "bake ", "fit ", "triangulate "})
            CHECK(run_cli(command + one + "/index.crofton")
                      .err.find("is the index of a folder of regions; name the folder") != std::string::npos);
        CHECK(run_cli("triangulate " + one + "/r0_0.crofton").err.find("name the file that it was baked from") !=
              std::string::npos);
        // A damaged region is named.
        std::string damaged = contents_of(one + "/r1_0.crofton");
        damaged[damaged.size() / 2] ^= 1;
        write_contents(one + "/r1_0.crofton", damaged);
        const CliRun refused = run_cli("bake " + one);
        CHECK(refused.status == 2);
        CHECK(refused.err.find("r1_0.crofton") != std::string::npos);
        for (const char* wrong : {"--regions 3", "--regions 3x", "--regions x3", "--regions 3x2x1", "--regions 0x1",
                                  "--regions 2x-1", "--regions 2000x1"})
            CHECK(run_cli("bake room --folder " + scratch().file("none") + " " + wrong).status == 2);
        CHECK(run_cli("bake room --regions 2x2").status == 2);
        CHECK(run_cli("bake room --folder " + scratch().file("none")).status == 2);
        CHECK(run_cli("bake room --regions 2x2 --folder /proc/none").status == 2);
    }

    TEST_CASE("regions that are baked in shards and merged, or resumed, have the same bytes as one run") {
        const std::string bake = "bake town --instances 3000 --no-occluders --regions 4x3 --json - --folder ";
        const std::string one = scratch().file("regions_whole"), parts = scratch().file("parts");
        const auto part = [&](int i) { return scratch().file("region_part" + std::to_string(i)); };
        const auto shard = [&](int i) {
            return run_cli(bake + parts + " --shard " + std::to_string(i) + "/3 --state " + part(i));
        };
        const auto merge = [&](const std::string& states, const std::string& folder) {
            return run_cli("merge " + states + " --shards 3 --out " + folder + "/index.crofton");
        };
        const auto same = [&](const std::string& other) {
            std::size_t files = 0;
            for (const auto& entry : std::filesystem::directory_iterator(one)) {
                const std::string name = "/" + entry.path().filename().string();
                CHECK(contents_of(one + name) == contents_of(other + name));
                ++files;
            }
            const auto others = std::filesystem::directory_iterator(other);
            CHECK(files == static_cast<std::size_t>(std::distance(begin(others), end(others))));
        };
        const CliRun whole = run_cli(bake + one);
        REQUIRE_MESSAGE(whole.status == 0, whole.err);
        REQUIRE(whole.json()["regions"] == 12);
        for (int i = 0; i < 3; ++i) {
            const CliRun baked = shard(i);
            REQUIRE_MESSAGE(baked.status == 0, baked.err);
            CHECK(baked.json()["regions"] == 4);
        }
        // A lost part is named, and there is no index.
        const CliRun lost = merge(part(0) + " " + part(2) + " " + part(2), parts);
        CHECK(lost.status == 1);
        CHECK_MESSAGE(lost.err.find("run again: --shard 1/3") != std::string::npos, lost.err);
        CHECK_FALSE(std::filesystem::exists(parts + "/index.crofton"));
        // So is the file of a region that is missing, or is another bake's; running the shard again mends it.
        const std::string all = part(2) + " " + part(0) + " " + part(1), victim = parts + "/r1_0.crofton";
        std::filesystem::copy_file(parts + "/r2_0.crofton", victim, std::filesystem::copy_options::overwrite_existing);
        const CliRun swapped = merge(all, parts);
        CHECK(swapped.status == 2);
        CHECK_MESSAGE(swapped.err.find("r1_0.crofton") != std::string::npos, swapped.err);
        std::filesystem::remove(victim);
        CHECK(merge(all, parts).err.find("r1_0.crofton") != std::string::npos);
        const CliRun again = shard(1);
        REQUIRE_MESSAGE(again.status == 0, again.err);
        CHECK(again.json()["regions_baked"] == 1);
        CHECK(again.err.find("r1_0.crofton") != std::string::npos);
        const CliRun merged = merge(all, parts);
        REQUIRE_MESSAGE(merged.status == 0, merged.err);
        same(parts);
        CHECK(merge(all, scratch().file("elsewhere")).status == 2);
        CHECK(run_cli("merge " + all + " --out " + parts + "/other.crofton").status == 2);
        // Parts of another scene or of other options, and damaged ones, are named.
        REQUIRE(run_cli(bake + scratch().file("others") + " --seed 2 --shard 1/3 --state " + part(3)).status == 0);
        CHECK(merge(part(0) + " " + part(3), parts).err.find("region_part3: is of another scene") != std::string::npos);
        CHECK(run_cli(bake + parts + " --no-clusters --shard 1/3 --state " + part(1))
                  .err.find("region_part1: is of another") != std::string::npos);
        std::string damaged = contents_of(part(2));
        damaged[damaged.size() / 2] ^= 1;
        write_contents(part(3), damaged);
        CHECK(merge(part(0) + " " + part(3), parts).err.find("region_part3") != std::string::npos);
        for (const char* wrong : {"--shard 3/3 --state x", "--shard 0/3", "--shard 1 --state x"})
            CHECK(run_cli(bake + parts + " " + wrong).status == 2);
        CHECK(run_cli("bake town --shard 0/3 --state x").status == 2);
    }

    TEST_CASE("regions that an interrupted run has finished are not baked again, and the folder has the same bytes") {
        const std::vector<std::string> bake{"bake",           "town",      "--instances", "20000",
                                            "--no-occluders", "--regions", "6x6",         "--folder"};
        const auto run = [&](const std::string& folder, int signal) {
            std::vector<std::string> arguments = bake;
            arguments.push_back(folder);
            arguments.insert(arguments.end(), {"--json", folder + ".json"});
            const Child child(arguments, folder + ".out", folder + ".err");
            while (signal != 0 && (!std::filesystem::is_directory(folder) || std::filesystem::is_empty(folder)))
                std::this_thread::sleep_for(std::chrono::milliseconds(2));
            if (signal != 0) child.signal(signal);
            return child.wait().status;
        };
        const std::string cut = scratch().file("cut"), one = scratch().file("uncut");
        CHECK(run(cut, SIGINT) == 130);
        CHECK_FALSE(std::filesystem::exists(cut + "/index.crofton"));
        CHECK(contents_of(cut + ".err").find("the next run continues") != std::string::npos);
        REQUIRE(run(cut, 0) == 0);
        REQUIRE(run(one, 0) == 0);
        const auto resumed = nlohmann::json::parse(contents_of(cut + ".json"));
        const auto whole = nlohmann::json::parse(contents_of(one + ".json"));
        CHECK(resumed["regions_baked"].get<int>() < resumed["regions"].get<int>());
        CHECK(whole["regions_baked"] == whole["regions"]);
        std::size_t files = 0;
        for (const auto& entry : std::filesystem::directory_iterator(one)) {
            CHECK(contents_of(cut + "/" + entry.path().filename().string()) == contents_of(entry.path().string()));
            ++files;
        }
        CHECK(files == whole["regions"].get<std::size_t>() + 1);
        CHECK_FALSE(std::filesystem::exists(cut + "/unfinished.state"));
    }
}
