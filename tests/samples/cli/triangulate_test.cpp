// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>

#include "run_cli.hpp"

using namespace crofton::test;

TEST_SUITE("cli/triangulate") {
    TEST_CASE("missing, damaged and unknown files, and wrong options, are refused and leave no output behind") {
        write_contents(scratch().file("broken.poly"), "P a 1\n3 0 0 1 0 x");
        write_contents(scratch().file("broken.json"), "[[[0,0],[1,");
        write_contents(scratch().file("odd.json"), "[[[0,0],[1,0],7]]");
        write_contents(scratch().file("empty.geojson"), R"({"type": "FeatureCollection", "features": []})");
        write_contents(scratch().file("number.geojson"), R"({"type": 1, "features": []})");
        write_contents(scratch().file("list.geojson"), R"({"type": "Feature", "geometry": {"type": []}})");
        write_contents(scratch().file("broken.wad"), "PWAD????");
        const std::string out = scratch().file("out.json");
        for (const char* name : {"missing.poly", "broken.poly", "broken.json", "odd.json", "empty.geojson",
                                 "number.geojson", "list.geojson", "broken.wad", "what.xyz"}) {
            const CliRun run = run_cli("triangulate '" + scratch().file(name) + "' --json '" + out + "'");
            CHECK(run.status == 2);
            CHECK(run.err.find(name) != std::string::npos);
            CHECK_FALSE(std::filesystem::exists(out));
        }
        write_contents(scratch().file("good.poly"), "P a 1\n3 0 0 1 0 0 1\n");
        const std::string good = "triangulate '" + scratch().file("good.poly") + "' ";
        CHECK(run_cli(good + "--method best").status == 2);
        CHECK(run_cli(good + "--json - --svg -").status == 2);
        CHECK(run_cli(good + "--out x.glb").status == 2);
        CHECK(run_cli(good + "--json /no/such/folder/a.json").status == 2);
        CHECK(run_cli("triangulate").status == 2);
    }

    TEST_CASE("--strict refuses a mesh whose material library is missing") {
        const std::string in = scratch().file("bare.obj"), out = scratch().file("bare.glb");
        write_contents(in, "mtllib nowhere.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
        const CliRun run = run_cli("triangulate '" + in + "' --strict --out '" + out + "'");
        CHECK(run.status == 2);
        CHECK(run.err.find("nowhere.mtl") != std::string::npos);
        CHECK(run.err.find("(refused: --strict)") != std::string::npos);
        CHECK_FALSE(std::filesystem::exists(out));
        CHECK(run_cli("triangulate '" + in + "' --out '" + out + "'").status == 0);
    }

    TEST_CASE("names that are no UTF-8 do not keep a mesh from being written") {
        write_contents(scratch().file("latin.mtl"),
                       "newmtl gr\xfcn\nKd 0 1 0\nmap_Kd \xfc.png\nnewmtl gr\xf6n\nKd 0 1 0\n");
        write_contents(scratch().file("latin.obj"),
                       "mtllib latin.mtl\no stra\xdf"
                       "e\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nusemtl gr\xfcn\nf 1 2 3\n"
                       "usemtl gr\xf6n\nf 1 3 4\n");
        const CliRun run =
            run_cli("triangulate '" + scratch().file("latin.obj") + "' --out '" + scratch().file("latin.glb") + "'");
        CHECK(run.status == 0);
        CHECK(std::filesystem::exists(scratch().file("latin.glb")));
    }

    TEST_CASE("more points than --max-triangles are refused in every format") {
        const std::string square = "[[0,0],[2,0],[2,2],[0,2]]";
        const std::pair<const char*, std::string> files[] = {
            {"four.poly", "P square 1\n4 0 0 2 0 2 2 0 2\n"},
            {"four.json", "[" + square + "]"},
            {"four.geojson", "{\"type\":\"Polygon\",\"coordinates\":[" + square + "]}"}};
        for (const auto& file : files) {
            const std::string name = file.first;
            CAPTURE(name);
            write_contents(scratch().file(name), file.second);
            CHECK(run_cli("triangulate '" + scratch().file(name) + "' --max-triangles 4").status == 0);
            const CliRun run = run_cli("triangulate '" + scratch().file(name) + "' --max-triangles 3");
            CHECK(run.status == 2);
            CHECK(run.err.find("more than 3 triangles, the limit: --max-triangles raises it") != std::string::npos);
        }
    }

    TEST_CASE("counts in a .poly file are whole numbers, and a byte that is 0 does not end it") {
        const std::pair<std::string, const char*> files[] = {
            {"P a 1\n3.5 0 0 1 0 0 1 1 1\n", "line 2: expected a ring's number of points"},
            {"P a nan\n", "line 1: expected 'P name rings'"},
            {"P a 1\n3 0 0 1 0 0 1\n" + std::string(1, '\0') + "P b 1\n3 0 0 1 0 0 1\n", "line 3: is no text"}};
        for (const auto& [text, message] : files) {
            write_contents(scratch().file("counts.poly"), text);
            const CliRun run = run_cli("triangulate '" + scratch().file("counts.poly") + "'");
            CHECK(run.status == 2);
            CHECK(run.err.find(message) != std::string::npos);
        }
    }

    TEST_CASE("an invalid polygon is named with ring, point and position, the others are done") {
        write_contents(scratch().file("two.poly"), "P bow 1\n4 0 0 2 2 2 0 0 2\nP square 1\n4 0 0 2 0 2 2 0 2\n");
        const CliRun run = run_cli("triangulate '" + scratch().file("two.poly") + "' --json -");
        CHECK(run.status == 2);
        CHECK(run.err.find("bow: ring 0, point") != std::string::npos);
        const auto polygons = run.json()["polygons"];
        REQUIRE(polygons.size() == 2);
        CHECK(polygons[0].contains("error"));
        CHECK(polygons[1]["triangles"].size() == 2);
        CHECK(polygons[1]["weight"].get<double>() == std::sqrt(8.0));
        CHECK(polygons[1]["optimal"] == true);
        CHECK(polygons[1]["gap"] == 0.0);
        for (const char* key : {"name", "vertices", "holes", "microseconds"}) CHECK(polygons[1].contains(key));
    }

    TEST_CASE(
        "GeoJSON: features, collections, multi-polygons, closing points left out, points skipped with a warning") {
        write_contents(scratch().file("map.geojson"), R"({"type": "FeatureCollection", "features": [
            {"type": "Feature", "properties": {"name": "lake"}, "geometry": {"type": "MultiPolygon", "coordinates": [
                [[[0,0],[4,0],[4,4],[0,4],[0,0]], [[1,1],[2,1],[2,2],[1,1]]], [[[9,9],[10,9],[9,10],[9,9]]]]}},
            {"type": "Feature", "properties": {}, "geometry": {"type": "Point", "coordinates": [0, 0]}},
            {"type": "Feature", "geometry": null}]})");
        const CliRun run = run_cli("triangulate '" + scratch().file("map.geojson") + "' --json - --method delaunay");
        CHECK(run.status == 0);
        CHECK(run.err.find("Point") != std::string::npos);
        const auto polygons = run.json()["polygons"];
        REQUIRE(polygons.size() == 2);
        CHECK(polygons[0]["name"] == "lake_0");
        CHECK(polygons[0]["vertices"] == 7);
        CHECK(polygons[0]["holes"] == 1);
        CHECK(polygons[0]["optimal"] == false);
        CHECK(polygons[0]["gap"].is_null());
        CHECK(polygons[0]["triangles"].size() == 7);
        CHECK(polygons[1]["vertices"] == 3);
    }

    TEST_CASE("JSON has a triangle a line, and brackets in names stay as they are") {
        write_contents(scratch().file("brackets.poly"), "P [1,\\\"[2] 1\n4 0 0 2 0 2 2 0 2\n");
        const CliRun run = run_cli("triangulate '" + scratch().file("brackets.poly") + "' --json -");
        REQUIRE(run.json()["polygons"].size() == 1);
        CHECK(run.json()["polygons"][0]["name"] == "[1,\\\"[2]");
        CHECK(run.json()["polygons"][0]["triangles"].size() == 2);
        CHECK(std::count(run.out.begin(), run.out.end(), '\n') < 35);
    }

    TEST_CASE("options that do not fit the file, or have no sense, are refused") {
        write_contents(scratch().file("fit.poly"), "P square 1\n4 0 0 2 0 2 2 0 2\n");
        const std::string file = "triangulate '" + scratch().file("fit.poly") + "' ";
        for (const char* options :
             {"--map MAP01", "--tolerance -1", "--tolerance nan", "--time-limit -1", "--work-limit -1", "--out x.glb"})
            CHECK(run_cli(file + options).status == 2);
    }

    TEST_CASE("after a time limit, unproved polygons are reported with a bound of their weight") {
        std::string points;
        for (int i = 0; i < 2000; ++i)
            points += " " + std::to_string(i % 2 * 3 + i) + " " + std::to_string((i - 1000) * (i - 1000));
        write_contents(scratch().file("late.poly"), "P late 1\n2000" + points + "\n");
        for (const char* limit : {"--time-limit 0", "--work-limit 0"}) {
            const CliRun run = run_cli("triangulate '" + scratch().file("late.poly") + "' " + limit);
            CHECK(run.status == 0);
            CHECK(run.out.find("1 polygon is not proven minimal") != std::string::npos);
            CHECK(run.out.find("memory") == std::string::npos);
        }
        const CliRun full =
            run_cli("triangulate '" + scratch().file("late.poly") + "' --time-limit 1000 --memory-limit 1");
        CHECK(full.status == 0);
        CHECK(full.out.find("1 polygon reached the limit of memory before that of time: --memory-limit 4 is more") !=
              std::string::npos);
        const CliRun by_default = run_cli("triangulate '" + scratch().file("late.poly") + "' --memory-limit 1");
        CHECK(by_default.out.find("Larger limits may prove more: --memory-limit") != std::string::npos);
    }

    TEST_CASE("a time limit is the only limit, and work is not limited as well") {
        // A smooth ring that needs more than the work that is granted without limits.
        std::string points;
        constexpr int kPoints = 2400;
        for (int i = 0; i < kPoints; ++i) {
            const double a = 2.0 * 3.141592653589793 * i / kPoints, r = 1.0 + 0.1 * std::sin(3.0 * a);
            points += " " + std::to_string(r * std::cos(a)) + " " + std::to_string(r * std::sin(a));
        }
        write_contents(scratch().file("smooth.poly"), "P smooth 1\n" + std::to_string(kPoints) + points + "\n");
        const std::string file = "triangulate '" + scratch().file("smooth.poly") + "' --json - ";
        const CliRun cut = run_cli(file + "--work-limit 1");
        CHECK(cut.json()["polygons"][0]["optimal"] == false);
        const CliRun both = run_cli(file + "--work-limit 1 --time-limit 100");
        CHECK(both.json()["polygons"][0]["optimal"] == false);
        CHECK(both.json()["polygons"][0]["weight"] == cut.json()["polygons"][0]["weight"]);
        CHECK(both.json()["polygons"][0]["gap"].get<double>() < 1.0);
    }

    TEST_CASE("SVG goes to a file or stdout") {
        write_contents(scratch().file("hole.json"), "[[[0,0],[4,0],[4,4],[0,4]],[[1,1],[2,1],[2,2]]]");
        const CliRun run = run_cli("triangulate '" + scratch().file("hole.json") + "' --svg -");
        CHECK(run.status == 0);
        CHECK(run.out.rfind("<svg", 0) == 0);
        CHECK(run.out.find("</svg>") != std::string::npos);
    }

    TEST_CASE("a mesh is written as GLB with its patches lighter, and reads back") {
        // A flat strip as a fan from one corner.
        std::string obj;
        for (int i = 0; i <= 8; ++i) obj += "v " + std::to_string(i) + " 0 0\n";
        for (int i = 8; i >= 0; --i) obj += "v " + std::to_string(i) + " 1 0\n";
        for (int i = 10; i < 18; ++i) obj += "f 1 " + std::to_string(i) + " " + std::to_string(i + 1) + "\n";
        for (int i = 1; i < 9; ++i) obj += "f " + std::to_string(i) + " " + std::to_string(i + 1) + " 10\n";
        write_contents(scratch().file("strip.obj"), obj);
        const std::string glb = scratch().file("strip.glb");
        const CliRun run = run_cli("triangulate '" + scratch().file("strip.obj") + "' --out '" + glb + "' --json -");
        CHECK(run.status == 0);
        const auto before = run.json()["summary"];
        CHECK(before["patches"] == 1);
        CHECK(before["improved"] == 1);
        // Eight unit squares: seven uprights of length 1 and eight diagonals of length √2.
        CHECK(before["weight_after"].get<double>() == doctest::Approx(7.0 + 8.0 * std::sqrt(2.0)));
        // Each patch has the keys that a polygon has; its triangles are in the mesh's own indices.
        const auto polygons = run.json()["meshes"][0]["polygons"];
        REQUIRE(polygons.size() == 1);
        CHECK(polygons[0]["triangles"].size() == 16);
        CHECK(polygons[0]["vertices"] == 18);
        CHECK(polygons[0]["optimal"] == true);
        for (const char* key : {"name", "holes", "weight", "gap", "microseconds"}) CHECK(polygons[0].contains(key));
        const CliRun again = run_cli("triangulate '" + glb + "' --json -");
        CHECK(again.status == 0);
        CHECK(again.json()["summary"]["improved"] == 0);
        CHECK(again.json()["summary"]["weight_before"].get<double>() ==
              doctest::Approx(before["weight_after"].get<double>()).epsilon(1e-6));
    }

    TEST_CASE("a damaged glTF file leaves no output, a damaged primitive is named, and the others are written") {
        using Json = nlohmann::ordered_json;
        // Two flat strips of three squares, cut the long way.
        std::string binary;
        const auto put = [&](auto value) { binary.append(reinterpret_cast<const char*>(&value), sizeof value); };
        for (int mesh = 0; mesh < 2; ++mesh)
            for (int i = 0; i < 8; ++i)
                for (const float c : {static_cast<float>(i < 4 ? i : 7 - i), i < 4 ? 0.0f : 1.0f, 0.0f}) put(c);
        for (int mesh = 0; mesh < 2; ++mesh)
            for (const int i : {0, 4, 5, 0, 5, 6, 0, 6, 7, 0, 1, 4, 1, 2, 4, 2, 3, 4})
                put(static_cast<std::uint16_t>(i));
        Json root =
            Json::parse(R"({"asset": {"version": "2.0", "extras": {"kept": true}}, "meshes": [], "accessors": [],
            "bufferViews": [], "buffers": [{}], "nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}]})");
        for (int i = 0; i < 4; ++i) {
            const bool indices = i >= 2;
            root["bufferViews"].push_back({{"buffer", 0},
                                           {"byteOffset", indices ? 192 + 36 * (i - 2) : 96 * i},
                                           {"byteLength", indices ? 36 : 96}});
            root["accessors"].push_back({{"bufferView", i},
                                         {"componentType", indices ? 5123 : 5126},
                                         {"count", indices ? 18 : 8},
                                         {"type", indices ? "SCALAR" : "VEC3"}});
        }
        for (int i = 0; i < 2; ++i)
            root["meshes"].push_back({{"name", i ? "bad" : "good"},
                                      {"primitives", {{{"attributes", {{"POSITION", i}}}, {"indices", 2 + i}}}}});
        root["buffers"][0] = {{"byteLength", binary.size()}, {"uri", "strips.bin"}};
        write_contents(scratch().file("strips.bin"), binary);
        const std::string in = scratch().file("strips.gltf"), out = scratch().file("strips.glb");
        const auto command = "triangulate '" + in + "' --json - --out '" + out + "'";

        write_contents(in, root.dump());
        const CliRun sound = run_cli(command);
        CHECK(sound.status == 0);
        CHECK(sound.json()["summary"]["improved"] == 2);
        CHECK(sound.json()["meshes"][1]["name"] == "bad");
        for (const char* key : {"primitives", "triangles_before", "triangles_after", "patches", "weight_before",
                                "weight_after", "left_alone", "errors"})
            CHECK(sound.json()["meshes"][0].contains(key));
        CHECK(contents_of(out).find("\"kept\":true") != std::string::npos);
        CHECK(contents_of(out).find("strips.bin") == std::string::npos);
        std::filesystem::remove(out);

        root["accessors"][3]["count"] = 18'000;
        write_contents(in, root.dump());
        const CliRun half = run_cli(command);
        CHECK(half.status == 2);
        CHECK(half.err.find("mesh 1 'bad': primitive 0: indices: accessor 3") != std::string::npos);
        CHECK(half.json()["summary"]["improved"] == 1);
        CHECK(half.json()["meshes"][1]["errors"][0]["code"] == "out of range");
        CHECK(std::filesystem::exists(out));
        std::filesystem::remove(out);

        for (const auto& damaged : {root.dump().substr(0, 100), std::string("{}"), std::string()}) {
            write_contents(in, damaged);
            const CliRun run = run_cli(command);
            CHECK(run.status == 2);
            CHECK(run.err.find("strips.gltf") != std::string::npos);
            CHECK_FALSE(std::filesystem::exists(out));
        }
        write_contents(in, root.dump());
        CHECK(run_cli("triangulate '" + in + "' --out '" + scratch().file("strips.obj") + "'").status == 2);
        CHECK(run_cli("triangulate '" + in + "' --attribute-tolerance -1").status == 2);
        CHECK(run_cli("triangulate '" + in + "' --json - --out -").status == 2);
        CHECK_FALSE(std::filesystem::exists(scratch().file("strips.obj")));
        // The other commands that read scenes.
        for (const std::string& other :
             {"bake '" + in + "' -o '" + out + "'", "frames '" + in + "' --frames 1 --no-draw --csv '" + out + "'"}) {
            root["nodes"][0]["mesh"] = 1;
            write_contents(in, root.dump());
            const CliRun run = run_cli(other);
            CHECK(run.status == 2);
            CHECK(run.err.find("mesh 1 'bad': primitive 0") != std::string::npos);
            CHECK_FALSE(std::filesystem::exists(out));
        }
    }
}
