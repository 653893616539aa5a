// SPDX-License-Identifier: MIT
// glTF assets made piece by piece, without the code under test.
#pragma once
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "test_files.hpp"

namespace test_files {

using Json = nlohmann::ordered_json;

struct Asset {
    Json root = {{"asset", {{"version", "2.0"}}}, {"scene", 0},
                 {"scenes", {{{"nodes", {0}}}}},  {"nodes", {{{"mesh", 0}}}},
                 {"meshes", Json::array()},       {"accessors", Json::array()},
                 {"bufferViews", Json::array()},  {"buffers", {{{"byteLength", 0}}}}};
    std::string binary;

    std::size_t view(const std::string& bytes) {
        binary.resize((binary.size() + 3) / 4 * 4, '\0');
        root["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", bytes.size()}});
        binary += bytes;
        root["buffers"][0]["byteLength"] = binary.size();
        return root["bufferViews"].size() - 1;
    }

    template <class T>
    std::size_t accessor(const std::vector<T>& values, const std::string& type, bool normalized = false) {
        constexpr int kComponent = std::is_same_v<T, float>           ? 5126
                                   : std::is_same_v<T, std::uint32_t> ? 5125
                                   : std::is_same_v<T, std::uint16_t> ? 5123
                                   : std::is_same_v<T, std::int16_t>  ? 5122
                                   : std::is_same_v<T, std::int8_t>   ? 5120
                                                                      : 5121;
        const std::size_t components = type == "SCALAR" ? 1
                                       : type == "MAT4" ? 16
                                                        : static_cast<std::size_t>(type.back() - '0');
        std::string bytes(values.size() * sizeof(T), '\0');
        std::memcpy(bytes.data(), values.data(), bytes.size());
        root["accessors"].push_back({{"bufferView", view(bytes)},
                                     {"componentType", kComponent},
                                     {"count", values.size() / components},
                                     {"type", type}});
        if (normalized) root["accessors"].back()["normalized"] = true;
        return root["accessors"].size() - 1;
    }

    // A new mesh of one primitive.
    Json& mesh(std::size_t positions, std::size_t indices) {
        root["meshes"].push_back({{"primitives", {{{"attributes", {{"POSITION", positions}}}, {"indices", indices}}}}});
        return root["meshes"].back()["primitives"][0];
    }

    [[nodiscard]] std::string glb(const std::string& more_chunks = {}) const {
        std::string json = root.dump(), data = binary;
        json.resize((json.size() + 3) / 4 * 4, ' ');
        data.resize((data.size() + 3) / 4 * 4, '\0');
        const auto u32 = [](std::size_t v) { return bytes_of(static_cast<std::uint32_t>(v)); };
        return "glTF" + u32(2) + u32(12 + 8 + json.size() + 8 + data.size() + more_chunks.size()) + u32(json.size()) +
               "JSON" + json + u32(data.size()) + std::string("BIN\0", 4) + data + more_chunks;
    }
};

// A flat strip of `count` unit squares along x at height z, its corners 0 … count below and count + 1 … back again.
inline std::vector<float> strip_positions(int count, float z = 0.0f) {
    std::vector<float> xyz;
    for (int i = 0; i <= count; ++i) xyz.insert(xyz.end(), {static_cast<float>(i), 0.0f, z});
    for (int i = count; i >= 0; --i) xyz.insert(xyz.end(), {static_cast<float>(i), 1.0f, z});
    return xyz;
}

// Long thin triangles from two of its corners: far from the lightest way.
template <class T>
std::vector<T> strip_indices(int count) {
    std::vector<T> indices;
    const auto add = [&](int i) { indices.push_back(static_cast<T>(i)); };
    for (int i = count + 1; i < 2 * count + 1; ++i) add(0), add(i), add(i + 1);
    for (int i = 0; i < count; ++i) add(i), add(i + 1), add(count + 1);
    return indices;
}

}  // namespace test_files
