// SPDX-License-Identifier: MIT
// One colour per vertex out of glTF materials: factors, textures, vertex colours.
#pragma once
#include <crofton/geometry/mesh.hpp>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <string>
#include <unordered_map>
#include <vector>

namespace tinygltf {
class Model;
}

namespace crofton::assets {

// A texture with ever smaller averages of itself, linear RGB; transparent texels count less.
class TexturePyramid {
  public:
    // False where the bytes are no image that we can read, or larger than 16,384 on a side.
    bool decode(const unsigned char* bytes, std::size_t size);
    [[nodiscard]] bool empty() const { return levels_.empty(); }
    // The average over about `width` (in texture widths) around `uv`; wraps around.
    [[nodiscard]] glm::vec3 sample(const glm::vec2& uv, float width) const;

  private:
    struct Level {
        int width = 0, height = 0;
        std::vector<glm::vec4> texels;  // premultiplied by alpha
    };
    std::vector<Level> levels_;
};

// Decodes each image once. `model.images[i].image` holds the file's bytes.
class MaterialColors {
  public:
    explicit MaterialColors(const tinygltf::Model& model) : model_(model) {}

    // Fills mesh.colors for a primitive of this material (−1: none), whose uv and colour arrays may be empty.
    // A texture is averaged over what lies between a vertex and its neighbours: palettes stay crisp, photographs calm.
    void apply(int material, const std::vector<float>& uv, const std::vector<float>& rgba, const std::string& name,
               TriangleMesh& mesh);
    std::vector<std::string> warnings;

  private:
    const TexturePyramid* texture(int index);

    const tinygltf::Model& model_;
    std::unordered_map<int, TexturePyramid> images_;
};

}  // namespace crofton::assets
