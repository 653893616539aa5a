// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <assets/gltf_builder.hpp>
#include <assets/gltf_patches.hpp>
#include <filesystem>

#include "gltf_asset.hpp"

using namespace crofton;
using test_files::Json;
using test_files::TemporaryFile;

namespace {

assets::GltfDocument convert(const std::string& text) {
    const TemporaryFile file("a.obj", text);
    const auto obj = assets::read_obj(file.path());
    REQUIRE(obj.has_value());
    return assets::gltf_from_obj(*obj, std::filesystem::temp_directory_path().string() + "/");
}

std::vector<float> floats(const assets::GltfDocument& document, const Json& accessor) {
    std::string storage;
    const auto elements = assets::accessor_elements(document, accessor.get<std::size_t>(), std::nullopt, storage);
    REQUIRE(elements.has_value());
    return assets::to_floats(*elements, elements->components);
}

const char* const kSquare =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 0.25\nvn 0 0 3\nvn 0 0 0\n";

}  // namespace

TEST_SUITE("assets/gltf_from_obj") {
    TEST_CASE("texture coordinates and normals that are not there are left out, with one warning") {
        const auto document = convert(std::string(kSquare) + "f 1/9/1 2/1/1 3/1/7\nf 1//-9 2 3/x\n");
        REQUIRE(document.warnings.size() == 1);
        CHECK(document.warnings[0].rfind("4 corners", 0) == 0);
        const Json& primitives = document.root["meshes"][0]["primitives"];
        REQUIRE(primitives.size() == 1);
        CHECK(primitives[0]["attributes"].size() == 1);
    }

    TEST_CASE("a vertex is a triple, corners with and without attributes are primitives of their own") {
        const auto document =
            convert(std::string(kSquare) + "f 1/1/1 2/2/1 3/3/1\nf 1/4/1 3/3/1 4/1/1\nf 1//1 2//1 3//2\n");
        const Json& primitives = document.root["meshes"][0]["primitives"];
        REQUIRE(primitives.size() == 2);
        // Neither texture nor, for a normal without direction, that.
        CHECK(primitives[0]["attributes"].size() == 1);
        const Json& attributes = primitives[1]["attributes"];
        CHECK(floats(document, attributes["POSITION"]) ==
              std::vector<float>{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 0, 1, 0});
        CHECK(floats(document, attributes["NORMAL"]) ==
              std::vector<float>{0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
        // Upside down.
        CHECK(floats(document, attributes["TEXCOORD_0"]) == std::vector<float>{0, 1, 1, 1, 1, 0, 0, 0.75f, 0, 1});
        CHECK(floats(document, primitives[1]["indices"]) == std::vector<float>{0, 1, 2, 3, 2, 4});
    }

    TEST_CASE("objects and groups are meshes, materials their primitives, with colour, emission and texture") {
        const TemporaryFile texture("picture.png", "\x89PNG and more");
        const std::string texture_name = std::filesystem::path(texture.path()).filename().string();
        const TemporaryFile library(
            "a.mtl", "newmtl brick\nKd 1 0 0.5\nmap_Kd -s 1 1 1 " + texture_name + "\nnewmtl lamp\nKe 4 2 0\n");
        const auto document =
            convert("mtllib " + std::filesystem::path(library.path()).filename().string() + "\n" + kSquare +
                    "o house\nusemtl brick\nf 1/1 2/2 3/3\nusemtl lamp\nf 1 2 3\nusemtl brick\n"
                    "f 1/1 3/3 4/4\ng roof\nf 1 2 3\n");
        CHECK(document.warnings.empty());
        const Json& root = document.root;
        REQUIRE(root["meshes"].size() == 2);
        CHECK(root["nodes"][0] == Json{{"name", "house"}, {"mesh", 0}});
        CHECK(root["meshes"][1]["name"] == "roof");
        REQUIRE(root["meshes"][0]["primitives"].size() == 3);
        CHECK(root["meshes"][0]["primitives"][2]["material"] == root["meshes"][0]["primitives"][0]["material"]);
        CHECK(root["meshes"][1]["primitives"][0]["material"] == 0);
        REQUIRE(root["materials"].size() == 2);
        const Json& brick = root["materials"][0]["pbrMetallicRoughness"];
        CHECK(root["materials"][0]["name"] == "brick");
        CHECK(brick["baseColorFactor"][0] == 1.0);
        CHECK(brick["baseColorFactor"][1] == 0.0);
        CHECK(brick["baseColorFactor"][2].get<double>() == doctest::Approx(0.21404).epsilon(1e-4));
        CHECK(brick["baseColorTexture"]["index"] == 0);
        CHECK(root["images"][0]["mimeType"] == "image/png");
        CHECK(root["materials"][1]["emissiveFactor"] == Json{1.0, 0.5, 0.0});
        CHECK(root["materials"][1]["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] == 4.0);
        CHECK(root["extensionsUsed"] == Json{"KHR_materials_emissive_strength"});
    }

    TEST_CASE("names may have blanks, and a number sign that is no comment") {
        const TemporaryFile library(
            "names.mtl",
            "newmtl red paint # seen at once\nKd 1 0 0\nmap_Kd wet paint.png\nnewmtl red glass\n"
            "Kd 0 1 0\nnewmtl wire #1\nKd 0 0 1\nnewmtl wire #2\t\nKd 0 0 0\nmap_Kd -s 1 1 1 a.png\n");
        const auto document =
            convert("mtllib " + std::filesystem::path(library.path()).filename().string() + "\n" + kSquare +
                    "o a house # mine\nusemtl red paint\nf 1 2 3\nusemtl  red glass # clear\nf 1 2 3\nusemtl wire #2\n"
                    "f 1 2 3\nusemtl wire #1 \nf 1 2 3\nusemtl red\nf 1 2 3\n");
        const Json& root = document.root;
        CHECK(root["meshes"][0]["name"] == "a house");
        REQUIRE(root["materials"].size() == 5);
        const auto color = [&](std::size_t i) {
            return root["materials"][i]["pbrMetallicRoughness"]["baseColorFactor"].get<std::vector<float>>();
        };
        CHECK(color(0) == std::vector<float>{1, 0, 0, 1});
        CHECK(color(1) == std::vector<float>{0, 1, 0, 1});
        CHECK(color(2) == std::vector<float>{0, 0, 0, 1});
        CHECK(color(3) == std::vector<float>{0, 0, 1, 1});
        CHECK(color(4)[1] == doctest::Approx(0.6));  // not there
        CHECK(root["materials"][1]["name"] == "red glass");
        CHECK(root["materials"][2]["name"] == "wire #2");
        CHECK(root["images"][0]["uri"] == "wet%20paint.png");
        CHECK(root["images"][1]["uri"] == "a.png");
    }

    TEST_CASE("vertex colours stand in the place of the material's") {
        const auto document =
            convert("usemtl red\nv 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nv 1 1 0\nf 1 2 3\nf 2 4 3\n");
        const Json& primitives = document.root["meshes"][0]["primitives"];
        REQUIRE(primitives.size() == 2);
        CHECK(floats(document, primitives[1]["attributes"]["COLOR_0"]) ==
              std::vector<float>{1, 0, 0, 0, 1, 0, 0, 0, 1});
        const Json& materials = document.root["materials"];
        CHECK(materials[primitives[1]["material"].get<std::size_t>()]["pbrMetallicRoughness"]["baseColorFactor"] ==
              Json{1.0, 1.0, 1.0, 1.0});
    }

    TEST_CASE("seams of texture coordinates and materials part patches, positions shared or not") {
        const std::string strip =
            "v 0 0 0\nv 4 0 0\nv 8 0 0\nv 8 1 0\nv 4 1 0\nv 0 1 0\nvt 0 0\nvt 0.5 0\nvt 1 0\n"
            "vt 1 0.125\nvt 0.5 0.125\nvt 0 0.125\nvt 0.75 0.75\n";
        const auto patches = [&](const std::string& faces) {
            auto document = convert(strip + faces);
            const auto outcomes = assets::retriangulate_patches(document, {});
            REQUIRE(outcomes.has_value());
            std::size_t count = 0, triangles = 0;
            for (const auto& outcome : *outcomes) {
                CHECK_FALSE(outcome.error.has_value());
                count += outcome.report.patches;
                triangles += outcome.report.triangles;
            }
            return std::pair(count, triangles);
        };
        CHECK(patches("f 1/1 2/2 5/5 6/6\nf 2/2 3/3 4/4 5/5\n") == std::pair<std::size_t, std::size_t>(1, 4));
        CHECK(patches("f 1/1 2/2 5/5 6/6\nf 2/1 3/2 4/5 5/6\n") == std::pair<std::size_t, std::size_t>(2, 4));
        // Only the triangle at the bent corner is left out.
        CHECK(patches("f 1/1 2/2 5/5 6/6\nf 2/2 3/13 4/4 5/5\n") == std::pair<std::size_t, std::size_t>(1, 3));
        CHECK(patches("usemtl a\nf 1/1 2/2 5/5 6/6\nusemtl b\nf 2/2 3/3 4/4 5/5\n") ==
              std::pair<std::size_t, std::size_t>(2, 4));
    }

    TEST_CASE("vertices too far out for floats are relative to a node's translation") {
        const auto document = convert(
            "v 500000.25 5400000.125 7\nv 500001 5400000.125 7\nv 500001 5400001.5 7.5\no a\nf 1 2 3\no b\nf 3 2 1\n");
        for (const Json& node : document.root["nodes"]) {
            const auto at = node["translation"].get<std::vector<double>>();
            const Json& position =
                document.root["meshes"][node["mesh"].get<std::size_t>()]["primitives"][0]["attributes"]["POSITION"];
            const std::vector<float> v = floats(document, position);
            const std::size_t first = node["name"] == "a" ? 0 : 6;
            CHECK(at[0] + static_cast<double>(v[first]) == 500000.25);
            CHECK(at[1] + static_cast<double>(v[first + 1]) == 5400000.125);
            CHECK(at[2] + static_cast<double>(v[first + 2]) == 7.0);
        }
        CHECK_FALSE(convert(std::string(kSquare) + "f 1 2 3\n").root["nodes"][0].contains("translation"));
    }
}
