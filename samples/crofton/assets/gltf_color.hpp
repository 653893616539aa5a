// SPDX-License-Identifier: MIT
// One colour per vertex out of glTF materials: factors, textures, vertex colours.
#pragma once
#include <crofton/geometry/mesh.hpp>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <string>
#include <unordered_map>
#include <vector>

#include "assets/gltf_document.hpp"

namespace crofton::assets {

// A texture with ever smaller averages of itself, linear RGB; transparent texels count less. Of a large one only
// averages of at most 1,024 on a side are kept.
class TexturePyramid {
  public:
    // Errors: bytes that are no image that we can read; more than `limits.pixels`.
    Result<void> decode(std::string_view bytes, const ReadLimits& limits);
    [[nodiscard]] std::uint64_t texels() const;  // that are kept
    [[nodiscard]] bool empty() const { return levels_.empty(); }
    // The average over about `width` (in texture widths) around `uv`; wraps around.
    [[nodiscard]] glm::vec3 sample(const glm::vec2& uv, float width) const;

  private:
    struct Level {
        int width = 0, height = 0;
        std::vector<glm::vec4> texels;  // premultiplied by alpha
    };
    static Level finest(const unsigned char* pixels, int width, int height);
    static Level half(const Level& fine);
    std::vector<Level> levels_;
};

// Decodes each image once. Files beside the document are in `folder`.
class MaterialColors {
  public:
    MaterialColors(const GltfDocument& document, std::string folder)
        : document_(document), folder_(std::move(folder)), bytes_read_(document.bytes_read) {}

    // Fills mesh.colors for a primitive of this material (null: none), whose uv and colour arrays may be empty.
    // A texture is averaged over what lies between a vertex and its neighbours: palettes stay crisp, photographs calm.
    void apply(const nlohmann::ordered_json* material, const std::vector<float>& uv, const std::vector<float>& rgba,
               const std::string& name, TriangleMesh& mesh);
    std::vector<std::string> warnings;

  private:
    const TexturePyramid* texture(const nlohmann::ordered_json& reference);
    Result<void> decode(std::size_t image, TexturePyramid& pyramid);

    const GltfDocument& document_;
    std::string folder_;
    std::unordered_map<std::size_t, TexturePyramid> images_;
    std::uint64_t bytes_read_;  // of all files
    std::uint64_t texels_ = 0;  // of all images, of the limit
};

}  // namespace crofton::assets
