// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "run_cli.hpp"

using namespace crofton::test;
using nlohmann::json;

namespace {

// A box of edges 4, 2 and 1, turned by a third of a right angle about z and moved; faces and other lines as exporters
// write them.
std::string turned_box(double offset = 10.0) {
    const double c = std::cos(0.5235987755982988), s = std::sin(0.5235987755982988);
    std::string text = "# box\no box\n";
    char line[128];
    for (unsigned i = 0; i < 8; ++i) {
        const double x = i & 1u ? 2.0 : -2.0, y = i & 2u ? 1.0 : -1.0, z = i & 4u ? 0.5 : -0.5;
        std::snprintf(line, sizeof line, "v %.17g %.17g %.17g\n", c * x - s * y + offset, s * x + c * y, z);
        text += line;
    }
    return text + "vn 0 0 1\nf 1//1 2//1 4//1 3//1\n";
}

std::string file(const char* name, const std::string& contents) {
    write_contents(scratch().file(name), contents);
    return " '" + scratch().file(name) + "'";
}

double number(const json& object, const char* key) {
    return object.at(key).get<double>();
}

}  // namespace

TEST_SUITE("cli/fit") {
    TEST_CASE("missing, empty and damaged files and bad options are refused with a reason and leave no output") {
        const std::string good = file("good.obj", turned_box());
        const std::string out = scratch().file("fit_out.json");
        const struct {
            std::string arguments, said;
        } cases[] = {{" '" + scratch().file("no_such.obj") + "'", "no_such.obj"},
                     {file("empty.obj", ""), "empty.obj"},
                     {file("short.obj", "v 0 0 0\nv 1 2\n"), "line 2"},
                     {file("letters.obj", "v 0 zero 0\n"), "line 1"},
                     {file("nan.obj", "v 0 0 0\nv 1 0 0\nv 0 nan 0\nv 0 0 1\n"), "line 3: vertex 3"},
                     {file("infinite.obj", "v 0 0 0\nv inf 0 0\n"), "line 2: vertex 2"},
                     {file("huge.obj", "v 0 0 0\nv 1 1 1\nv 1 1 2e30\n"), "point 2"},
                     {good + " --criterion shape", "--criterion shape"},
                     {good + " --criterion rays", "rays"},
                     {good + " --criterion rays:-1", "not negative"},
                     {good + " --criterion rays:1x", "rays"},
                     {good + " --criterion frustum:1,1,0.1", "four numbers"},
                     {good + " --criterion frustum:1,1,10,1", "frustum"},
                     {good + " --criterion weights:1,2", "three numbers"},
                     {good + " --criterion weights:0,0,0", "weights"},
                     {good + " --criterion weights:1,-1,0", "weights"},
                     {good + " --criterion partner:", "a partner needs a mesh file: partner:FILE"},
                     {good + " --criterion partner", "a partner needs a mesh file: partner:FILE"},
                     {good + " --criterion partner:/no/such/file.obj", "/no/such/file.obj"},
                     {good + " --quality best", "quality"},
                     {good + " --budget -1", "budget"},
                     {" ", "files"}};
        for (const auto& c : cases) {
            INFO(c.arguments);
            const CliRun run = run_cli("fit" + c.arguments + " --json '" + out + "'");
            CHECK(run.status == 2);
            INFO(run.err);
            CHECK(run.err.find(c.said) != std::string::npos);
            CHECK_FALSE(std::filesystem::exists(out));
        }
        CHECK(run_cli("fit" + good + " --json /no/such/folder/a.json").status == 2);
        CHECK(run_cli("fit" + good + " --svg /no/such/folder/a.svg").status == 2);
    }

    TEST_CASE("JSON holds every field, and they agree with each other") {
        const CliRun run = run_cli("fit" + file("box.obj", turned_box()) + " --criterion area --json -");
        REQUIRE(run.status == 0);
        const json all = run.json();
        CHECK(all["quality"] == "exact");
        CHECK(all["criterion"] == "area");
        REQUIRE(all["meshes"].size() == 1);
        const json mesh = all["meshes"][0];
        CHECK(mesh["file"].get<std::string>().find("box.obj") != std::string::npos);
        CHECK(mesh["vertices"] == 8);
        CHECK(mesh["hull_vertices"] == 8);
        CHECK(std::abs(mesh["center"][0].get<double>() - 10.0) < 1e-6);
        double half[3], product = 8.0, sum = 0.0;
        for (std::size_t k = 0; k < 3; ++k) {
            half[k] = mesh["half_extents"][k].get<double>();
            product *= half[k];
            sum += 2.0 * half[k];
            double length = 0.0;
            for (std::size_t j = 0; j < 3; ++j) length += std::pow(mesh["axes"][k][j].get<double>(), 2.0);
            CHECK(length == doctest::Approx(1.0).epsilon(1e-6));
        }
        CHECK(number(mesh, "volume") == doctest::Approx(product));
        CHECK(number(mesh, "volume") == doctest::Approx(8.0).epsilon(1e-5));
        CHECK(number(mesh, "area") == doctest::Approx(28.0).epsilon(1e-5));
        CHECK(number(mesh, "edge_sum") == doctest::Approx(sum));
        CHECK(number(mesh, "edge_sum") == doctest::Approx(7.0).epsilon(1e-5));
        CHECK(number(mesh, "value") == number(mesh, "area"));
        CHECK(number(mesh, "lower_bound") <= 28.0);
        CHECK(number(mesh, "gap") == doctest::Approx(1.0 - number(mesh, "lower_bound") / number(mesh, "value")));
        CHECK(number(mesh, "gap") <= 1e-6);
        CHECK(number(mesh, "rounding") <= number(mesh, "gap"));
        const json time = mesh["milliseconds"];
        CHECK(number(time, "hull") > 0.0);
        CHECK(number(time, "search") > 0.0);
        CHECK(number(time, "total") == doctest::Approx(number(time, "hull") + number(time, "search")));
    }

    TEST_CASE("every criterion gives the value of its formula at the box it found") {
        const std::string box = file("box.obj", turned_box());
        // The partner is a cube of edge 2: V 8, F 24, M 6π. Its weights: 1, M / 4π, F / 4π.
        const std::string cube =
            file("cube.obj", "v 0 0 0\nv 2 0 0\nv 0 2 0\nv 2 2 0\nv 0 0 2\nv 2 0 2\nv 0 2 2\nv 2 2 2\n");
        const std::string partner = "partner:" + scratch().file("cube.obj");
        const double pi = 3.14159265358979323846;
        const struct {
            std::string text;
            double volume, area, mean_curvature;
        } cases[] = {{"volume", 1, 0, 0},
                     {"area", 0, 1, 0},
                     {"perimeter", 0, 0, 1.0 / pi},
                     {"rays:8", 1, 2, 0},
                     {"weights:0.5,2,0.25", 0.5, 2, 0.25},
                     {partner, 1, 1.5, 6.0 / pi}};
        for (const auto& c : cases) {
            INFO(c.text);
            const CliRun run = run_cli("fit" + box + " --criterion '" + c.text + "' --json -");
            REQUIRE(run.status == 0);
            const json mesh = run.json()["meshes"][0];
            CHECK(mesh["criterion"] == c.text);
            CHECK(number(mesh, "value") ==
                  doctest::Approx(c.volume * number(mesh, "volume") + c.area * number(mesh, "area") +
                                  c.mean_curvature * pi * number(mesh, "edge_sum")));
            CHECK(number(mesh, "volume") == doctest::Approx(8.0).epsilon(1e-5));
        }
        const CliRun frustum = run_cli("fit" + box + " --criterion frustum:1.0472,1.7778,0.1,1000 --json -");
        REQUIRE(frustum.status == 0);
        CHECK(number(frustum.json()["meshes"][0], "gap") <= 1e-6);
    }

    TEST_CASE("every quality holds the box, only exact proves something") {
        const std::string box = file("box.obj", turned_box(1e5));
        for (const char* quality : {"fast", "tight", "exact"}) {
            INFO(std::string(quality));
            const CliRun run = run_cli("fit" + box + " --quality " + quality + " --json -");
            REQUIRE(run.status == 0);
            CHECK(run.json()["quality"] == quality);
            const json mesh = run.json()["meshes"][0];
            CHECK(number(mesh, "edge_sum") >= 7.0 - 1e-9);
            CHECK(number(mesh, "edge_sum") <= 7.0 * (1.0 + 1e-5));
            const bool proved = std::string(quality) == "exact";
            for (const char* key : {"lower_bound", "gap", "rounding"}) CHECK(mesh[key].is_null() != proved);
        }
    }

    TEST_CASE("a spent budget leaves a box and an honest gap") {
        std::string sphere;
        char line[96];
        for (int i = 0; i < 3000; ++i) {
            const double z = (2.0 * i + 1.0) / 3000.0 - 1.0, r = std::sqrt(1.0 - z * z), angle = 2.399963229728653 * i;
            std::snprintf(line, sizeof line, "v %.9g %.9g %.9g\n", r * std::cos(angle), r * std::sin(angle), z);
            sphere += line;
        }
        const CliRun run = run_cli("fit" + file("sphere.obj", sphere) + " --criterion area --budget 0.001 --json -");
        REQUIRE(run.status == 0);
        const json mesh = run.json()["meshes"][0];
        CHECK(number(mesh, "gap") > 1e-6);
        CHECK(number(mesh, "lower_bound") <= 24.0);
        CHECK(number(mesh, "value") >= 23.0);
    }

    TEST_CASE("flat, straight and single-point meshes are fitted") {
        const CliRun flat =
            run_cli("fit" + file("flat.obj", "v 0 0 0\nv 3 0 0\nv 3 4 0\nv 0 4 0\n") + " --criterion volume --json -");
        REQUIRE(flat.status == 0);
        CHECK(number(flat.json()["meshes"][0], "volume") == 0.0);
        CHECK(number(flat.json()["meshes"][0], "gap") == 0.0);
        const CliRun line = run_cli("fit" + file("line.obj", "v 0 0 0\nv 1 2 2\n") + " --json - --svg '" +
                                    scratch().file("line.svg") + "'");
        REQUIRE(line.status == 0);
        CHECK(number(line.json()["meshes"][0], "edge_sum") == doctest::Approx(3.0).epsilon(1e-5));
        CHECK(line.json()["meshes"][0]["hull_vertices"] == 2);
        const CliRun point = run_cli("fit" + file("point.obj", "v 5 6 7\n") + " --json -");
        REQUIRE(point.status == 0);
        CHECK(number(point.json()["meshes"][0], "edge_sum") == 0.0);
    }

    TEST_CASE("several files give a table of all criteria, in JSON as well") {
        const std::string files = file("a.obj", turned_box()) + file("b.obj", turned_box(3.0));
        const CliRun table = run_cli("fit" + files);
        REQUIRE(table.status == 0);
        for (const char* word :
             {"vertices", "hull", "volume", "area", "edge sum", "value", "gap", "ms", "a.obj", "b.obj"})
            CHECK(table.out.find(word) != std::string::npos);
        // A heading and three criteria a mesh: the chosen one is among them.
        CHECK(std::count(table.out.begin(), table.out.end(), '\n') == 7);
        const CliRun with_rays = run_cli("fit" + files + " --criterion rays:3");
        CHECK(std::count(with_rays.out.begin(), with_rays.out.end(), '\n') == 9);
        const json meshes = run_cli("fit" + files + " --quality tight --json -").json()["meshes"];
        REQUIRE(meshes.size() == 2);
        for (const char* criterion : {"volume", "area", "perimeter"})
            CHECK(meshes[1]["criteria"][criterion]["criterion"] == criterion);
        CHECK(number(meshes[1]["criteria"]["volume"], "value") == doctest::Approx(8.0).epsilon(1e-5));
    }

    TEST_CASE("SVG draws every mesh and its box, to a file or to standard output") {
        const std::string files = file("a.obj", turned_box()) + file("b.obj", turned_box(3.0));
        const CliRun run = run_cli("fit" + files + " --svg -");
        REQUIRE(run.status == 0);
        CHECK(run.out.rfind("<svg", 0) == 0);
        CHECK(run.out.find("</svg>") != std::string::npos);
        const auto occurrences = [&](const std::string& part) {
            std::size_t count = 0;
            for (std::size_t at = run.out.find(part); at != std::string::npos; at = run.out.find(part, at + 1)) ++count;
            return count;
        };
        CHECK(occurrences("<line ") == 24);
        CHECK(occurrences("stroke-dasharray") == 6);
        CHECK(occurrences("<path ") == 2 * 6);  // three faces of a box are seen, two triangles each
        CHECK(run.out.find("nan") == std::string::npos);
        const std::string path = scratch().file("boxes.svg");
        REQUIRE(run_cli("fit" + files + " --svg '" + path + "'").status == 0);
        CHECK(contents_of(path) == run.out);
    }

    TEST_CASE("scenes and maps are fitted like OBJ files") {
        const std::string folder = std::string(CROFTON_SHARED_DATA) + "/scenes/";
        for (const char* name : {"recast_dungeon.obj", "freedoom2_maps.wad", "stk_black_forest.glb"}) {
            if (!std::filesystem::exists(folder + name)) {
                MESSAGE("skipped: no shared data");
                continue;
            }
            INFO(std::string(name));
            const CliRun run = run_cli("fit '" + folder + name + "' --quality fast --json -");
            CHECK(run.status == 0);
            CHECK(number(run.json()["meshes"][0], "volume") > 0.0);
        }
    }

    TEST_CASE("--planar: bad polygons are named, the others done, a square's bounds are the ones one knows") {
        CHECK(run_cli("fit --planar" + file("cube.obj", turned_box())).status == 2);
        CHECK(run_cli("fit --planar '" + scratch().file("none.poly") + "'").status == 2);
        CHECK(run_cli("fit --planar" + file("torn.poly", "P a 1\n3 0 0 1\n")).status == 2);
        const std::string two = file("two.poly", "P huge 1\n3 0 0 1e300 0 0 1\nP square 1\n4 0 0 2 0 2 2 0 2\n");
        const CliRun run = run_cli("fit --planar --json -" + two);
        CHECK(run.status == 2);
        CHECK(run.err.find("huge") != std::string::npos);
        const auto document = run.json();
        CHECK(document.at("refused") == 1);
        REQUIRE(document.at("polygons").size() == 1);
        const auto& shapes = document.at("polygons")[0].at("shapes");
        REQUIRE(shapes.size() == 5);
        CHECK(number(shapes[0], "value") == doctest::Approx(8.0));
        CHECK(number(shapes[1], "value") == doctest::Approx(4.0));
        CHECK(number(shapes[2], "value") == doctest::Approx(std::sqrt(2.0)));
        CHECK(number(shapes[4], "value") == doctest::Approx(8.0));
        for (const auto& shape : shapes) CHECK(number(shape, "off") < 1e-7);
        const CliRun drawn = run_cli("fit --planar --svg -" + two);
        CHECK(drawn.out.find("<svg") == 0);
        CHECK(drawn.out.find("square") != std::string::npos);
    }
}
