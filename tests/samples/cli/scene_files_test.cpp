// SPDX-License-Identifier: MIT
// What the command line makes of scene files that other programs write.
#include <doctest/doctest.h>

#include "run_cli.hpp"

using namespace crofton::test;

namespace {

// A pentagon with a notch from its right side to its middle: (2, 1) lies inside the hull.
constexpr const char* kNotched = "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 2 1 0\nv 0 4 0\n";

std::string cube_at(double x, double y, double half) {
    std::string text;
    for (int i = 0; i < 8; ++i)
        text += "v " + std::to_string(i & 1 ? x + half : x - half) + " " + std::to_string(i & 2 ? y + half : y - half) +
                " " + std::to_string(i & 4 ? half : -half) + "\n";
    return text + "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
}

}  // namespace

TEST_SUITE("cli/scene_files") {
    TEST_CASE("a concave face collides where it is, and not in its notch, whatever corner is named first") {
        const std::string face = scratch().file("notched.obj"), cube = scratch().file("small_cube.obj");
        for (const char* order : {"1 2 3 4 5", "2 3 4 5 1", "4 5 1 2 3", "5 4 3 2 1", "3 2 1 5 4"}) {
            write_contents(face, std::string(kNotched) + "f " + order + "\n");
            const auto hit = [&](double x, double y) {
                write_contents(cube, cube_at(x, y, 0.1));
                const CliRun run = run_cli("collide '" + face + "' '" + cube + "' --json -");
                REQUIRE(run.status == 0);
                return run.json()["hit"].get<bool>();
            };
            CAPTURE(order);
            CHECK_FALSE(hit(2.3, 2.2));
            CHECK_FALSE(hit(2.0, 1.4));
            CHECK(hit(2.0, 0.5));
            CHECK(hit(0.3, 2.5));
            CHECK(hit(3.8, 2.5));
            const auto rows = run_cli("study measure '" + face + "' --json -").json()["rows"];
            CHECK(rows[0]["predicted"].get<double>() == doctest::Approx(10.0));  // 16 less the notch's 0.5 · 4 · 3
        }
    }

    TEST_CASE("a face that crosses itself is named, and refused with --strict") {
        const std::string file = scratch().file("bow_tie.obj");
        write_contents(file, "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 3 2 4\n");
        for (const char* command : {"study measure", "triangulate", "frames --no-draw --frames 1"}) {
            CAPTURE(command);
            const CliRun run = run_cli(command + (" '" + file + "'"));
            CHECK(run.err.find("line 5: face: crosses itself or has no area") != std::string::npos);
            const CliRun strict = run_cli(command + (" '" + file + "' --strict"));
            CHECK(strict.status == 2);
            CHECK(strict.err.find("refused: --strict") != std::string::npos);
        }
    }

    TEST_CASE("the default installation has the decoders of compressed glTF") {
        // Where apt-get is not found, it says what it would install.
        const auto script = std::filesystem::path(__FILE__).parent_path() / "../../third_party/install.sh";
        if (!std::filesystem::exists(script)) return;
        const std::string said = scratch().file("install.txt");
        REQUIRE(std::system(("PATH=/nonexistent /bin/bash '" + script.string() + "' 2>'" + said + "'").c_str()) == 0);
        CHECK(contents_of(said).find("libdraco-dev") != std::string::npos);
        CHECK(contents_of(said).find("libmeshoptimizer-dev") != std::string::npos);
    }

    TEST_CASE("help names what is read of each format") {
        const CliRun run = run_cli("frames --help");
        CHECK(run.out.find("EXT_mesh_gpu_instancing") != std::string::npos);
        CHECK(run.out.find("UDMF") != std::string::npos);
    }
}
