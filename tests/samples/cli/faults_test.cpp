// SPDX-License-Identifier: MIT
// What goes wrong from outside: hostile files, a full disk, kill -9, Ctrl-C.
#include <doctest/doctest.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <thread>
#include <vector>

#include "../../kill_writer.hpp"
#include "child.hpp"
#include "run_cli.hpp"

using namespace crofton::test;

namespace {

bool tells(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

// A folder of its own, so that what is left behind can be counted.
std::string fresh_folder(const std::string& name) {
    const std::string path = scratch().file(name);
    std::filesystem::remove_all(path);
    std::filesystem::create_directories(path);
    return path;
}

std::vector<std::string> names_in(const std::string& folder) {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) names.push_back(entry.path().filename());
    std::sort(names.begin(), names.end());
    return names;
}

// Until the file has so many lines; false after half a minute.
bool wait_for_lines(const std::string& path, std::ptrdiff_t lines) {
    for (int i = 0; i < 3000; ++i) {
        const std::string text = contents_of(path);
        if (std::count(text.begin(), text.end(), '\n') >= lines) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
}

// Starts it, sends Ctrl-C while it computes, and returns its status. Before it listens, Ctrl-C ends it: then it has
// longer.
int interrupt(const std::vector<std::string>& arguments, int milliseconds = 200) {
    for (; milliseconds < 30'000; milliseconds *= 2) {
        const Child child(arguments, "/dev/null");
        std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
        child.signal(SIGINT);
        if (const int status = child.wait().status; status >= 0) return status;
    }
    return -1;
}

const std::string kTriangle = R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],
    "bufferViews":[{"buffer":0,"byteLength":36}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
    "nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}],"scene":0,"asset":{"version":"2.0"})";

}  // namespace

TEST_SUITE("cli/faults") {
    TEST_CASE("no file of the system gets into an output, and a pipe does not stop the program") {
        const std::string folder = fresh_folder("uris");
        const std::string out = folder + "/out.glb";
        mkfifo((folder + "/pipe").c_str(), 0600);
        for (const char* uri : {"/etc/passwd", "../../../../../../etc/passwd", "%2e%2e/%2e%2e/%2e%2e/etc/passwd",
                                "file:///etc/passwd", "pipe"}) {
            CAPTURE(uri);
            write_contents(folder + "/a.gltf", "{\"buffers\":[{\"byteLength\":36,\"uri\":\"" + std::string(uri) +
                                                   "\"}]," + kTriangle + "}");
            const CliRun run = run_cli("triangulate '" + folder + "/a.gltf' --out '" + out + "'");
            CHECK(run.status == 2);
            CHECK(tells(run.err, "buffer 0"));
            CHECK_FALSE(std::filesystem::exists(out));
            CHECK(run_cli("frames --no-draw '" + folder + "/a.gltf'").status == 2);
        }
    }

    TEST_CASE("limits are options of every sub-command that reads files, and the message names the option") {
        const std::string obj = scratch().file("large.obj");
        write_contents(obj, "v 0 0 0\nv 1 0 0\nv 1 1 1\nv 0 1 0\nf 1 2 3\nf 1 3 4\n");
        for (const char* command : {"frames --no-draw", "bake -o /dev/null", "study radiosity", "study factors",
                                    "study measure", "triangulate", "fit"}) {
            CAPTURE(command);
            const CliRun run = run_cli(std::string(command) + " '" + obj + "' --max-bytes 10");
            CHECK(run.status == 2);
            CHECK(tells(run.err, "more than 10 bytes, the limit: --max-bytes raises it"));
        }
        CHECK(tells(run_cli("collide '" + obj + "' '" + obj + "' --max-triangles 1").err, "--max-triangles"));
        const std::string poly = scratch().file("a.poly");
        write_contents(poly, "P a 1\n4 0 0 1 0 1 1 0 1\n");
        CHECK(tells(run_cli("triangulate '" + poly + "' --max-triangles 3").err, "--max-triangles"));
        const std::string deep = scratch().file("deep.json");
        write_contents(deep, std::string(300, '[') + std::string(300, ']'));
        CHECK(tells(run_cli("triangulate '" + deep + "'").err, "nested deeper than 200"));
        CHECK(tells(run_cli("frames room --no-draw --camera '" + deep + "'").err, "nested deeper than 200"));
    }

    TEST_CASE("--strict refuses a file of which something is left out") {
        const std::string obj = scratch().file("spoilt.obj");
        write_contents(obj, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 9\n");
        const CliRun lenient = run_cli("frames --no-draw --frames 1 '" + obj + "'");
        CHECK(lenient.status == 0);
        CHECK(tells(lenient.err, "line 5: face: vertex 9 of 3: left out"));
        const CliRun strict = run_cli("frames --no-draw --frames 1 --strict '" + obj + "'");
        CHECK(strict.status == 2);
        CHECK(tells(strict.err, "line 5"));
    }

    TEST_CASE(
        "--unit sets how high the street's eyes are, also in a baked file, and is refused where it means nothing") {
        const std::string obj = scratch().file("plain.obj"), baked = scratch().file("plain.crofton");
        write_contents(obj, "v 0 0 0\nv 0 0 9000\nv 9000 0 9000\nv 9000 0 0\nf 1 2 3 4\n");
        REQUIRE(run_cli("bake '" + obj + "' --unit 0.01 -o '" + baked + "'").status == 0);
        for (const std::string& scene : {"'" + obj + "' --unit 0.01", "'" + baked + "'"}) {
            const CliRun run = run_cli("frames --no-draw --frames 3 --camera street " + scene);
            CHECK(run.status == 0);
            CHECK(run.err == "");
        }
        CHECK(run_cli("frames --no-draw --frames 1 '" + obj + "' --unit 0").status == 2);
        CHECK(tells(run_cli("frames --no-draw --frames 1 town --unit 0.01").err, "town: is in metres"));
    }

    TEST_CASE("a disk without room leaves the old file, and the exit status says so") {
        const std::string folder = fresh_folder("full");
        const std::string out = folder + "/room.crofton";
        write_contents(out, "old");
        const std::string command =
            "trap '' XFSZ; ulimit -f 1; '" CROFTON_CLI "' bake room -o '" + out + "' >/dev/null 2>'" + folder + "/err'";
        const int status = std::system(("sh -c \"" + command + "\"").c_str());
        CHECK(WEXITSTATUS(status) == 2);
        CHECK(tells(contents_of(folder + "/err"), "cannot write: File too large"));
        std::filesystem::remove(folder + "/err");
        CHECK(contents_of(out) == "old");
        CHECK(names_in(folder) == std::vector<std::string>{"room.crofton"});
    }

    TEST_CASE("killed while it bakes, the program leaves the old file or the new one, and the next run cleans up") {
        const std::string folder = fresh_folder("killed");
        const std::string out = folder + "/room.crofton";
        REQUIRE(run_cli("bake room -o '" + out + "'").status == 0);
        for (int i = 0; i < crofton::testing::kill_count() / 3; ++i) {
            const Child child({"bake", "room", "--seed", std::to_string(i), "-o", out}, "/dev/null");
            std::this_thread::sleep_for(std::chrono::microseconds(i * 7919 % 60'000));
            child.signal(SIGKILL);
            static_cast<void>(child.wait());
            CHECK(run_cli("bake '" + out + "'").status == 0);  // checks the file whole
        }
        REQUIRE(run_cli("bake room -o '" + out + "'").status == 0);
        CHECK(names_in(folder) == std::vector<std::string>{"room.crofton"});
    }

    TEST_CASE("frames streams its lines, Ctrl-C keeps what there is, in every output, and the exit status is 130") {
        const std::string folder = fresh_folder("interrupted");
        const std::string out = folder + "/out.csv", json = folder + "/out.json";
        const Child child({"frames", "room", "--no-draw", "--frames", "1000000", "--csv", "-", "--json", json}, out);
        REQUIRE(wait_for_lines(out, 5));
        CHECK_FALSE(std::filesystem::exists(json));
        child.signal(SIGINT);
        CHECK(child.wait().status == 130);
        const auto document = nlohmann::json::parse(contents_of(json), nullptr, false);
        REQUIRE(document.is_object());
        const std::string csv = contents_of(out);
        CHECK(document["frames"].size() >= 4);
        // A line for each, and one of names.
        CHECK(static_cast<std::size_t>(std::count(csv.begin(), csv.end(), '\n')) == document["frames"].size() + 1);
        CHECK(csv.rfind("index,", 0) == 0);
        CHECK(csv.find("index,", 1) == csv.npos);
    }

    TEST_CASE("a second Ctrl-C ends the program at once") {
        const std::string out = scratch().file("twice.csv");
        const Child child({"frames", "town", "--no-draw", "--frames", "1000000", "--csv", "-"}, out);
        REQUIRE(wait_for_lines(out, 2));
        child.signal(SIGINT);
        child.signal(SIGINT);
        const int status = child.wait().status;
        CHECK((status == 130 || status == -1));
    }

    TEST_CASE("radiosity and triangulate, interrupted, write what they have") {
        const std::string folder = fresh_folder("long");
        const std::string glb = folder + "/lit.glb", state = folder + "/state";
        const Child light({"study", "radiosity", "room", "--edge", "0.5", "--lines", "1000000000000", "--out", glb,
                           "--checkpoint", state},
                          "/dev/null");
        for (int i = 0; i < 3000 && !std::filesystem::exists(state); ++i)
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        light.signal(SIGINT);
        CHECK(light.wait().status == 130);
        CHECK(contents_of(glb).substr(0, 4) == "glTF");
        CHECK(names_in(folder) == std::vector<std::string>{"lit.glb", "state"});
        // Many polygons, of which the time of all is long.
        std::string text;
        for (int p = 0; p < 4000; ++p) {
            text += "P p" + std::to_string(p) + " 1\n200";
            for (int i = 0; i < 200; ++i) {
                const double angle = i * 0.031415926535897934;
                text += " " + std::to_string(std::cos(angle)) + " " + std::to_string(std::sin(angle));
            }
            text += "\n";
        }
        const std::string poly = folder + "/many.poly", json = folder + "/many.json";
        write_contents(poly, text);
        CHECK(interrupt({"triangulate", poly, "--json", json}) == 130);
        const auto document = nlohmann::json::parse(contents_of(json), nullptr, false);
        REQUIRE(document.is_object());
        CHECK(document["polygons"].size() == document["summary"]["polygons"].get<std::size_t>());
        CHECK(document["polygons"].size() < 4000);
    }

    TEST_CASE("pvs, interrupted, keeps its lines, and the next run goes on from there") {
        const std::string folder = fresh_folder("sets");
        const std::string state = folder + "/state", json = folder + "/figures.json";
        // More lines than hours have.
        const std::vector<std::string> bake{"pvs",       "room", "--cells", "4x1x4", "--epsilon", "1e-9",
                                            "--threads", "1",    "--state", state,   "--json",    json};
        const auto lines = [&] {
            const auto document = nlohmann::json::parse(contents_of(json), nullptr, false);
            return document.is_object() ? document["lines"].get<std::uint64_t>() : 0;
        };
        std::uint64_t before = 0;
        for (int run = 0; run < 2; ++run) {
            // Until it has had time for one line.
            for (int wait = 200; lines() == before && wait < 30'000; wait *= 2) CHECK(interrupt(bake, wait) == 130);
            CHECK(lines() > before);
            before = lines();
        }
        CHECK(names_in(folder) == std::vector<std::string>{"figures.json", "state"});
    }

    TEST_CASE("pictures of an earlier run are not left among new ones, other files are") {
        const std::string folder = fresh_folder("pictures");
        for (const char* name : {"frame_0000.png", "frame_0007.png", "frame_12345.png", "frame_0003.png.partial",
                                 "frame_1.png", "frame_0001.txt", "notes.png"})
            write_contents(folder + "/" + name, "old");
        const CliRun run = run_cli("frames room --frames 2 --size 32x32 --png '" + folder + "'");
        if (run.status == 2 && tells(run.err, "ulkan")) return;  // no driver here
        REQUIRE_MESSAGE(run.status == 0, run.err);
        CHECK(names_in(folder) == std::vector<std::string>{"frame_0000.png", "frame_0001.png", "frame_0001.txt",
                                                           "frame_1.png", "notes.png"});
        CHECK(contents_of(folder + "/frame_0000.png").substr(1, 3) == "PNG");
    }
}
