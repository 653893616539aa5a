// SPDX-License-Identifier: MIT
// A glTF document that holds some of everything.
#pragma once
#include <cstdint>
#include <vector>

#include "gltf_asset.hpp"

namespace test_files {

// All that a vertex may carry, linear in the position or constant, and all that a document may hold besides.
inline Asset rich_asset() {
    constexpr int kCount = 8;
    Asset asset;
    const std::vector<float> xyz = strip_positions(kCount);
    std::vector<float> normals, tangents, uv, uv1, heat, weights, moves;
    std::vector<std::uint8_t> colors;
    std::vector<std::uint16_t> joints;
    for (std::size_t i = 0; i < xyz.size(); i += 3) {
        const float x = xyz[i], y = xyz[i + 1];
        normals.insert(normals.end(), {0.0f, 0.0f, 1.0f});
        tangents.insert(tangents.end(), {1.0f, 0.0f, 0.0f, 1.0f});
        uv.insert(uv.end(), {0.25f * x, 1.0f - y});
        uv1.insert(uv1.end(), {y, x + 0.5f * y});
        heat.push_back(300.0f + x);
        weights.insert(weights.end(), {0.75f, 0.25f, 0.0f, 0.0f});
        joints.insert(joints.end(), {1, 0, 0, 0});
        colors.insert(colors.end(), {static_cast<std::uint8_t>(20.0f * x), 9, 8, 255});
        moves.insert(moves.end(), {0.0f, 0.0f, 0.5f * x});
    }
    const std::size_t positions = asset.accessor(xyz, "VEC3");
    Json& primitive = asset.mesh(positions, asset.accessor(strip_indices<std::uint16_t>(kCount), "SCALAR"));
    Json& attributes = primitive["attributes"];
    attributes["NORMAL"] = asset.accessor(normals, "VEC3");
    attributes["TANGENT"] = asset.accessor(tangents, "VEC4");
    attributes["TEXCOORD_0"] = asset.accessor(uv, "VEC2");
    attributes["TEXCOORD_1"] = asset.accessor(uv1, "VEC2");
    attributes["COLOR_0"] = asset.accessor(colors, "VEC4", true);
    attributes["JOINTS_0"] = asset.accessor(joints, "VEC4");
    attributes["WEIGHTS_0"] = asset.accessor(weights, "VEC4");
    attributes["_HEAT"] = asset.accessor(heat, "SCALAR");
    primitive["targets"] = {{{"POSITION", asset.accessor(moves, "VEC3")}}};
    primitive["material"] = 0;
    primitive["extras"] = {{"by", "hand"}};
    primitive["extensions"]["KHR_materials_variants"]["mappings"] = Json::array();
    Json& root = asset.root;
    root["meshes"][0]["name"] = "flag";
    root["meshes"][0]["weights"] = {0.0};
    root["nodes"] = Json::parse(R"([{"name": "root", "children": [1, 2], "translation": [0.1, 2, 3]},
        {"name": "flag", "mesh": 0, "skin": 0}, {"name": "again", "mesh": 0, "camera": 0, "scale": [2, 2, 2]},
        {"name": "bone"}, {"name": "tip"}])");
    root["skins"] = Json::parse(R"([{"joints": [3, 4]}])");
    root["cameras"] = Json::parse(R"([{"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.01}}])");
    root["materials"] =
        Json::parse(R"([{"name": "cloth", "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}])");
    root["textures"] = Json::parse(R"([{"source": 0}])");
    root["images"] = {{{"bufferView", asset.view("a picture")}, {"mimeType", "image/png"}}};
    root["animations"] = {{{"channels", {{{"sampler", 0}, {"target", {{"node", 3}, {"path", "translation"}}}}}},
                           {"samplers",
                            {{{"input", asset.accessor(std::vector<float>{0.0f, 1.0f}, "SCALAR")},
                              {"output", asset.accessor(std::vector<float>(6, 0.0f), "VEC3")}}}}}};
    root["extensionsUsed"] = {"KHR_lights_punctual", "KHR_materials_variants"};
    root["extensions"] = Json::parse(R"({"KHR_lights_punctual": {"lights": [{"type": "point"}]}})");
    return asset;
}

}  // namespace test_files
