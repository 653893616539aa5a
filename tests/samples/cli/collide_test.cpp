// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "run_cli.hpp"

using namespace crofton::test;
using nlohmann::json;

namespace {

// A cube from −half to half, as an OBJ file.
std::string cube_file(const std::string& name, double half) {
    std::string text;
    for (int i = 0; i < 8; ++i)
        text += "v " + std::to_string(i & 1 ? half : -half) + " " + std::to_string(i & 2 ? half : -half) + " " +
                std::to_string(i & 4 ? half : -half) + "\n";
    text += "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
    const std::string path = scratch().file(name);
    write_contents(path, text);
    return path;
}

json answer(const std::string& arguments) {
    const CliRun run = run_cli("collide " + arguments + " --json -");
    CAPTURE(run.err);
    REQUIRE(run.status == 0);
    return run.json();
}

}  // namespace

TEST_SUITE("cli/collide") {
    TEST_CASE("a file that cannot be read or understood ends with status 2 and is named") {
        const std::string cube = cube_file("cube.obj", 1.0), pose = scratch().file("bad_pose.txt");
        const auto refused = [](const std::string& arguments, const std::string& culprit) {
            const CliRun run = run_cli("collide " + arguments);
            CAPTURE(arguments);
            CAPTURE(run.err);
            CHECK(run.status == 2);
            CHECK(run.out.empty());
            CHECK(run.err.find(culprit) != std::string::npos);
        };
        refused("no-such-file.obj " + cube, "no-such-file.obj");
        refused(cube + " no-such-other.obj", "no-such-other.obj");
        refused(cube, "B");
        refused(cube + " " + cube + " --mode sometimes", "sometimes");
        refused(cube + " " + cube + " --pose 1,2,3", "1,2,3");
        refused(cube + " " + cube + " --pose 1,2,3,1,0,0,0,9", "more than seven");
        refused(cube + " " + cube + " --pose 0,0,0,0,0,0,0", "no direction");
        refused(cube + " " + cube + " --pose nan,0,0,1,0,0,0", "NaN");
        refused(cube + " " + cube + " --pose 0,inf,0,1,0,0,0", "infinite");
        refused(cube + " " + cube + " --pose no-such-pose.txt", "no-such-pose.txt");
        write_contents(pose, "1 2 3 four 0 0 0");
        refused(cube + " " + cube + " --pose " + pose, "bad_pose.txt");
        write_contents(scratch().file("nan.obj"), contents_of(cube) + "v 0 nan 0\nf 1 2 9\n");
        refused(cube + " " + scratch().file("nan.obj"), "vertex 9");
        write_contents(scratch().file("empty.obj"), "v 0 0 0\n");
        refused(scratch().file("empty.obj") + " " + cube, "empty.obj");
    }

    TEST_CASE("a bad triangle is named and left out, and the others are answered") {
        const std::string cube = cube_file("cube.obj", 1.0), torn = scratch().file("torn.obj");
        write_contents(torn, contents_of(cube) + "v 1e20 0 0\nf 1 2 9\n");
        const CliRun run = run_cli("collide " + torn + " " + cube + " --pose 1.5,0,0,1,0,0,0 --json -");
        CHECK(run.status == 0);
        CHECK(run.err.find("torn.obj") != std::string::npos);
        CHECK(run.err.find("the first is 12") != std::string::npos);  // the thirteenth triangle
        CHECK(run.json()["hit"] == true);
    }

    TEST_CASE("any: hit or not, with the pose inline or in a file") {
        const std::string cube = cube_file("cube.obj", 1.0), pair = cube + " " + cube,
                          file = scratch().file("pose.txt");
        const json hit = answer(pair + " --pose 1.5,0.25,0,1,0,0,0");
        CHECK(hit["hit"] == true);
        CHECK(hit["distance"].is_null());
        CHECK(hit["contained"] == "none");
        CHECK(hit["triangle_tests"].get<int>() > 0);
        CHECK(hit["milliseconds"]["build"].get<double>() >= 0.0);
        CHECK(hit["milliseconds"]["query"].get<double>() >= 0.0);
        for (const char* key : {"hit", "pairs", "contacts", "depth", "distance", "contained", "bv_tests",
                                "triangle_tests", "milliseconds"})
            CHECK(hit.contains(key));
        CHECK(answer(pair + " --pose 2,0,0,1,0,0,0")["hit"] == true);  // touching
        CHECK(answer(pair + " --pose 2.0000001,0,0,1,0,0,0")["hit"] == false);
        CHECK(answer(pair)["hit"] == true);                            // no pose: as the files have them
        write_contents(file, "2.5 0 0\n0.92387953 0 0 0.38268343\n");  // an eighth of a turn brings the corner nearer
        CHECK(answer(pair + " --pose " + file)["hit"] == false);
        write_contents(file, "2.4 0 0\n0.92387953 0 0 0.38268343\n");
        CHECK(answer(pair + " --pose " + file)["hit"] == true);
        const CliRun text = run_cli("collide " + pair + " --pose 5,0,0,1,0,0,0");
        CHECK(text.status == 0);
        CHECK(text.out.find("no hit") != std::string::npos);
        const std::string written = scratch().file("answer.json");
        CHECK(run_cli("collide " + pair + " --json " + written).status == 0);
        CHECK(json::parse(contents_of(written))["hit"] == true);
    }

    TEST_CASE("all: pairs of triangles, contacts on both surfaces, and the depth") {
        const std::string cube = cube_file("cube.obj", 1.0);
        const json all = answer(cube + " " + cube + " --pose 1.5,0.25,0.125,1,0,0,0 --mode all");
        CHECK(all["hit"] == true);
        CHECK(all["depth"].get<double>() == doctest::Approx(0.5).epsilon(1e-4));
        REQUIRE(all["pairs"].size() > 4);
        CHECK(all["contacts"].size() == all["pairs"].size());
        for (std::size_t i = 0; i < all["contacts"].size(); ++i) {
            const json& contact = all["contacts"][i];
            CHECK(contact["triangles"] == all["pairs"][i]);
            CHECK(all["pairs"][i][0].get<int>() < 12);
            for (const char* end : {"begin", "end", "position"}) {
                const auto p = contact[end].get<std::vector<double>>();
                const double in_a = std::max({std::fabs(p[0]), std::fabs(p[1]), std::fabs(p[2])});
                const double in_b = std::max({std::fabs(p[0] - 1.5), std::fabs(p[1] - 0.25), std::fabs(p[2] - 0.125)});
                CHECK(in_a <= 1.0 + 1e-9);
                CHECK(in_b <= 1.0 + 1e-9);
            }
            const auto n = contact["normal"].get<std::vector<double>>();
            CHECK(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] == doctest::Approx(1.0));
        }
        const json apart = answer(cube + " " + cube + " --pose 9,0,0,1,0,0,0 --mode all");
        CHECK(apart["hit"] == false);
        CHECK(apart["pairs"].empty());
        CHECK(apart["depth"] == 0.0);
    }

    // A tetrahedron with a corner at the origin and its faces counter-clockwise from outside, or a mirror image of it.
    TEST_CASE("all: normals of a mesh that a scene mirrors point outward as well") {
        const auto tetrahedron = [](const std::string& name, bool mirrored) {
            const std::string path = scratch().file(name);
            const float s = mirrored ? -1.0f : 1.0f;
            std::string bytes;
            for (const float x : {0.0f, 0.0f, 0.0f, s, 0.0f, 0.0f, 0.0f, 1.0f, 0.0f, 0.0f, 0.0f, 1.0f})
                bytes.append(reinterpret_cast<const char*>(&x), sizeof x);
            for (const int i : {0, 2, 1, 0, 3, 2, 0, 1, 3, 1, 2, 3}) bytes += {static_cast<char>(i), '\0'};
            // Counter-clockwise from outside before it is mirrored, too.
            if (mirrored)
                for (std::size_t t = 48; t < bytes.size(); t += 6)
                    std::swap_ranges(bytes.begin() + static_cast<std::ptrdiff_t>(t + 2),
                                     bytes.begin() + static_cast<std::ptrdiff_t>(t + 4),
                                     bytes.begin() + static_cast<std::ptrdiff_t>(t + 4));
            json root;
            root["asset"]["version"] = "2.0";
            root["scenes"] = json::array({{{"nodes", {0}}}});
            root["nodes"] = json::array({{{"mesh", 0}, {"scale", {mirrored ? -1 : 1, 1, 1}}}});
            root["meshes"] =
                json::array({{{"primitives", json::array({{{"attributes", {{"POSITION", 0}}}, {"indices", 1}}})}}});
            root["buffers"] = json::array({{{"byteLength", bytes.size()}, {"uri", name + ".bin"}}});
            root["bufferViews"] = json::array(
                {{{"buffer", 0}, {"byteLength", 48}}, {{"buffer", 0}, {"byteOffset", 48}, {"byteLength", 24}}});
            root["accessors"] =
                json::array({{{"bufferView", 0}, {"componentType", 5126}, {"count", 4}, {"type", "VEC3"}},
                             {{"bufferView", 1}, {"componentType", 5123}, {"count", 12}, {"type", "SCALAR"}}});
            write_contents(scratch().file(name + ".bin"), bytes);
            write_contents(path, root.dump());
            return path;
        };
        const std::string plain = tetrahedron("plain.gltf", false), mirrored = tetrahedron("mirrored.gltf", true);
        const std::string rest = " --pose -0.25,-0.2,-0.15,1,0,0,0 --mode all";
        const json expected = answer(plain + " " + plain + rest), got = answer(plain + " " + mirrored + rest);
        REQUIRE(expected["contacts"].size() > 2);
        CHECK(got["pairs"] == expected["pairs"]);
        for (std::size_t i = 0; i < expected["contacts"].size(); ++i)
            CHECK(got["contacts"][i]["normal"] == expected["contacts"][i]["normal"]);
    }

    TEST_CASE("distance: how far, and between which points") {
        const std::string cube = cube_file("cube.obj", 1.0);
        const json apart = answer(cube + " " + cube + " --pose 5,6,0.5,1,0,0,0 --mode distance");
        CHECK(apart["hit"] == false);
        CHECK(apart["distance"].get<double>() == doctest::Approx(5.0));
        CHECK(apart["nearest"]["on_a"][0].get<double>() == doctest::Approx(1.0));
        CHECK(apart["nearest"]["on_b"][0].get<double>() == doctest::Approx(4.0));
        CHECK(answer(cube + " " + cube + " --pose 1,1,0,1,0,0,0 --mode distance")["distance"] == 0.0);
    }

    TEST_CASE("contain: of loose triangles each is a piece, and the text says what lies where") {
        const std::string cube = cube_file("cube.obj", 1.0), soup = scratch().file("soup.obj");
        const auto text = [](const std::string& arguments) { return run_cli("collide " + arguments).out; };
        const std::string first = "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nf 1 2 3\n";
        write_contents(soup, first + "v 0.5 0 0\nv 0.6 0 0\nv 0.5 0.1 0\nf 4 5 6\n");
        CHECK(answer(cube + " " + soup)["contained"] == "b_inside_a");
        CHECK(text(cube + " " + soup).find("hit, B lies inside A") == 0);
        CHECK(text(soup + " " + cube).find("hit, A lies inside B") == 0);
        write_contents(soup, first + "v 5 0 0\nv 6 0 0\nv 5 0.1 0\nf 4 5 6\n");
        CHECK(answer(cube + " " + soup)["contained"] == "partly");
        CHECK(answer(soup + " " + cube + " --mode distance")["contained"] == "partly");
        CHECK(text(cube + " " + soup).find("hit, some pieces of one lie inside the other") == 0);
        write_contents(soup, "v 5 0 0\nv 6 0 0\nv 5 0.1 0\nf 1 2 3\n");
        CHECK(answer(cube + " " + soup)["contained"] == "none");
        CHECK(text(cube + " " + soup + " --mode contain").find("no hit, neither lies inside the other") == 0);
        write_contents(soup, "v 0 0 0\nv 6 0 0\nv 5 0.1 0\nf 1 2 3\n");  // through the wall
        CHECK(answer(cube + " " + soup + " --mode contain")["contained"] == "none");
        CHECK(text(cube + " " + soup + " --mode contain").find("hit, neither lies inside the other") == 0);
    }

    TEST_CASE("contain: a mesh inside the other is a hit, and which is inside is said") {
        const std::string cube = cube_file("cube.obj", 1.0), small = cube_file("small.obj", 0.25);
        CHECK(answer(cube + " " + small + " --mode contain")["contained"] == "b_inside_a");
        CHECK(answer(small + " " + cube + " --mode contain")["contained"] == "a_inside_b");
        CHECK(answer(small + " " + cube + " --mode contain")["hit"] == true);
        CHECK(answer(cube + " " + small + " --pose 3,0,0,1,0,0,0 --mode contain")["contained"] == "none");
        CHECK(answer(cube + " " + small + " --pose 1,0,0,1,0,0,0 --mode contain")["contained"] == "none");
        CHECK(answer(cube + " " + small)["hit"] == true);  // in every mode
    }

    TEST_CASE("hulls: distance, depth with bounds, contact points, and a budget of vertices") {
        const std::string pair = cube_file("hull_a.obj", 1.0) + " " + cube_file("hull_b.obj", 1.0) + " --hulls";
        const json apart = answer(pair + " --pose 5,0,0,1,0,0,0 --mode distance");
        CHECK(apart["hit"] == false);
        CHECK(apart["distance"].get<double>() == doctest::Approx(3.0));
        CHECK(apart["bounds"][0].get<double>() <= 3.0);
        CHECK(apart["bounds"][1].get<double>() >= 3.0);
        const json deep = answer(pair + " --pose 1.75,0,0,1,0,0,0 --mode all");
        CHECK(deep["hit"] == true);
        CHECK(deep["depth"].get<double>() == doctest::Approx(0.25));
        CHECK(deep["normal"][0].get<double>() == doctest::Approx(1.0));
        CHECK(deep["contacts"].size() == 4);
        CHECK(deep["hulls"][0]["vertices"] == 8);
        CHECK(deep["hulls"][1]["volume"].get<double>() == doctest::Approx(8.0));
        CHECK(answer(pair + " --max-vertices 4 --pose 9,0,0,1,0,0,0")["hulls"][0]["max_overshoot"].get<double>() > 0.0);
        CHECK(run_cli("collide " + pair + " --mode contain").status == 2);
    }

    TEST_CASE("casts: of meshes and of hulls, with a hit, a proven miss, and what is refused") {
        const std::string pair = cube_file("cast_a.obj", 1.0) + " " + cube_file("cast_b.obj", 1.0);
        for (const std::string& shapes : {pair, pair + " --hulls"}) {
            const std::string from_five = shapes + " --pose 5,0,0,1,0,0,0 --mode cast --velocity ";
            const json hit = answer(from_five + "-10,0,0");
            CHECK(hit["result"] == "hit");
            CHECK(hit["time"].get<double>() == doctest::Approx(0.3).epsilon(1e-5));
            CHECK(std::abs(hit["normal"][0].get<double>()) == doctest::Approx(1.0));
            CHECK(answer(from_five + "-10,0,0 --duration 0.25")["result"] == "miss");
            CHECK(answer(from_five + "10,0,0 --spin 0,30,0")["result"] == "miss");
        }
        CHECK(run_cli("collide " + pair + " --mode cast --velocity 1,2").status == 2);
        CHECK(run_cli("collide " + pair + " --mode cast --velocity 1,nan,2").status == 2);
        CHECK(run_cli("collide " + pair + " --mode cast --spin 0,1e9,0").status == 2);
        CHECK(run_cli("collide " + pair + " --mode cast --duration -1").status == 2);
    }

    TEST_CASE("files of surveys, whose coordinates are too large for floats, are answered as files at the origin") {
        // Steps of floats are half a unit there; the cubes are a tenth of that.
        const auto far_cube = [](const std::string& name, double x) {
            const std::string path = scratch().file(name);
            std::string text;
            for (int i = 0; i < 8; ++i)
                text += "v " + std::to_string(500000.0 + x + 0.05 * (i & 1)) + " " +
                        std::to_string(5400000.25 + 0.05 * (i >> 1 & 1)) + " " + std::to_string(0.05 * (i >> 2)) + "\n";
            write_contents(path, text + "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n");
            return path;
        };
        const auto near = [](double value) { return doctest::Approx(value).epsilon(1e-6); };
        const std::string a = far_cube("survey_a.obj", 0.0), b = far_cube("survey_b.obj", 0.08), pair = a + " " + b,
                          there = " --pose -0.05,0,0,1,0,0,0";
        for (const std::string& kind : {std::string(), std::string(" --hulls")}) {
            CAPTURE(kind);
            CHECK(answer(pair + kind)["hit"] == false);
            const json apart = answer(pair + kind + " --mode distance");
            CHECK(apart["distance"].get<double>() == near(0.03));
            CHECK(apart["nearest"]["on_a"][0].get<double>() - 500000.0 == near(0.05));
            CHECK(apart["nearest"]["on_b"][0].get<double>() - 500000.0 == near(0.08));
            const json deep = answer(pair + kind + there + " --mode all");
            CHECK(deep["hit"] == true);
            CHECK(deep["depth"].get<double>() == doctest::Approx(0.02).epsilon(1e-4));
            for (const json& contact : deep["contacts"]) {
                CHECK(contact["position"][0].get<double>() - 500000.0 >= 0.0299);
                CHECK(contact["position"][1].get<double>() - 5400000.25 <= 0.0501);
            }
            const json cast = answer(pair + kind + " --mode cast --velocity -0.06,0,0");
            CHECK(cast["time"].get<double>() == doctest::Approx(0.5).epsilon(1e-3));
            CHECK(cast["on_a"][0].get<double>() - 500000.0 == near(0.05));
            // A turn about the origin of the files, which is far away: half of one takes the cube there and back.
            CHECK(answer(a + " " + a + kind + " --pose 1000000.15,10800000.55,0,0,0,0,1 --mode distance")["distance"]
                      .get<double>() == doctest::Approx(0.05).epsilon(1e-4));
        }
        CHECK(answer(a + " " + cube_file("near.obj", 1.0) + " --mode distance")["distance"].get<double>() ==
              doctest::Approx(std::hypot(499999.0, 5399999.25)).epsilon(1e-12));
        const CliRun fitted = run_cli("study measure " + a + " --lines 1000 --json -");
        CHECK(fitted.status == 0);
        CHECK(fitted.json()["rows"][0]["predicted"].get<double>() == doctest::Approx(6 * 0.05 * 0.05).epsilon(1e-5));
    }
}
