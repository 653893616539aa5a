// SPDX-License-Identifier: MIT
// Small files of every format, made on the spot, and ways to damage them.
#pragma once
#include <unistd.h>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

namespace test_files {

// A file that is gone with its object.
class TemporaryFile {
  public:
    TemporaryFile(const std::string& name, const std::string& contents) {
        static int counter = 0;
        path_ = std::filesystem::temp_directory_path() /
                ("crofton_" + std::to_string(getpid()) + "_" + std::to_string(counter++) + "_" + name);
        std::ofstream(path_, std::ios::binary) << contents;
    }
    ~TemporaryFile() {
        std::error_code ignored;
        std::filesystem::remove(path_, ignored);
    }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;
    [[nodiscard]] std::string path() const { return path_.string(); }

  private:
    std::filesystem::path path_;
};

template <class T>
std::string bytes_of(T value) {
    std::string result(sizeof value, '\0');
    std::memcpy(result.data(), &value, sizeof value);
    return result;
}

// One triangle (0,0,0) (1,0,0) (0,1,0) with 16-bit indices: 36 + 6 bytes.
inline std::string gltf_buffer() {
    std::string buffer;
    for (const float x : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f}) buffer += bytes_of(x);
    for (int i = 0; i < 3; ++i) buffer += bytes_of(static_cast<std::uint16_t>(i));
    return buffer + std::string(2, '\0');
}

// `nodes` is the value of "nodes"; node 0 is the scene's only root. `indices` replaces the index accessor's fields.
inline std::string gltf_json(const std::string& nodes, const std::string& indices = "\"bufferView\":1,\"count\":3",
                             const std::string& buffer = "\"byteLength\":44") {
    return "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":" + nodes +
           ",\"meshes\":[{\"name\":\"sail\",\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1}]}],"
           "\"buffers\":[{" +
           buffer +
           "}],\"bufferViews\":[{\"buffer\":0,\"byteOffset\":0,\"byteLength\":36},"
           "{\"buffer\":0,\"byteOffset\":36,\"byteLength\":6}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,"
           "\"count\":3,\"type\":\"VEC3\"},{\"componentType\":5123,\"type\":\"SCALAR\"," +
           indices + "}]}";
}

inline std::string glb(std::string json) {
    while (json.size() % 4 != 0) json += ' ';
    const std::string buffer = gltf_buffer();
    const auto u32 = [](std::size_t v) { return bytes_of(static_cast<std::uint32_t>(v)); };
    return "glTF" + u32(2) + u32(12 + 8 + json.size() + 8 + buffer.size()) + u32(json.size()) + "JSON" + json +
           u32(buffer.size()) + std::string("BIN\0", 4) + buffer;
}

inline std::string name8(const std::string& name) {
    return (name + std::string(8, '\0')).substr(0, 8);
}

inline std::string wad_file(const std::vector<std::pair<std::string, std::string>>& lumps) {
    std::string body, directory;
    const auto u32 = [](std::size_t v) { return bytes_of(static_cast<std::uint32_t>(v)); };
    for (const auto& [name, data] : lumps) {
        directory += u32(12 + body.size()) + u32(data.size()) + name8(name);
        body += data;
    }
    return "PWAD" + u32(lumps.size()) + u32(12 + body.size()) + body + directory;
}

// A room of 256 × 256 with a column of 64 × 64 whose inside is no sector: 8 lines, 8 sides, 1 sector.
struct Wad {
    std::string vertices, lines, sides, sectors;
    Wad() {
        const std::int16_t corner[8][2] = {{0, 0},   {0, 256},  {256, 256}, {256, 0},
                                           {96, 96}, {160, 96}, {160, 160}, {96, 160}};
        for (const auto& c : corner) vertices += bytes_of(c[0]) + bytes_of(c[1]);
        for (int ring = 0; ring < 2; ++ring)
            for (int k = 0; k < 4; ++k) line(4 * ring + k, 4 * ring + (k + 1) % 4, 4 * ring + k, 0xFFFF);
        for (int k = 0; k < 8; ++k) side(0);
        sectors = bytes_of(std::int16_t{0}) + bytes_of(std::int16_t{128}) + name8("FLOOR4_8") + name8("CEIL3_5") +
                  bytes_of(std::int16_t{160}) + std::string(4, '\0');
    }
    void line(int from, int to, int right, int left) {
        lines += bytes_of(static_cast<std::uint16_t>(from)) + bytes_of(static_cast<std::uint16_t>(to)) +
                 std::string(6, '\0') + bytes_of(static_cast<std::uint16_t>(right)) +
                 bytes_of(static_cast<std::uint16_t>(left));
    }
    void side(int sector) {
        sides += std::string(4, '\0') + name8("-") + name8("-") + name8("BRICK1") +
                 bytes_of(static_cast<std::uint16_t>(sector));
    }
    [[nodiscard]] std::string file() const {
        return wad_file(
            {{"E1M1", ""}, {"LINEDEFS", lines}, {"SIDEDEFS", sides}, {"VERTEXES", vertices}, {"SECTORS", sectors}});
    }
};

}  // namespace test_files
