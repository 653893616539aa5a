// SPDX-License-Identifier: MIT
#include "assets/gltf_color.hpp"

#include <stb/stb_image.h>
#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>

#include "assets/name_color.hpp"
#include "srgb.hpp"

namespace crofton::assets {
namespace {

constexpr int kMaxSide = 16384;

int wrap(float coordinate, int size) {
    const float turns = coordinate - std::floor(coordinate);
    return std::clamp(static_cast<int>(turns * static_cast<float>(size)), 0, size - 1);
}

// The mean length of the edges at each vertex in texture space: the width over which its colour speaks.
std::vector<float> footprints(const std::vector<float>& uv, const TriangleMesh& mesh) {
    std::vector<float> sum(mesh.positions.size(), 0.0f);
    std::vector<float> count(mesh.positions.size(), 0.0f);
    for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3)
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t a = mesh.indices[t + k], b = mesh.indices[t + (k + 1) % 3];
            const float length = std::hypot(uv[2 * a] - uv[2 * b], uv[2 * a + 1] - uv[2 * b + 1]);
            for (const std::uint32_t v : {a, b}) {
                sum[v] += length;
                count[v] += 1.0f;
            }
        }
    for (std::size_t v = 0; v < sum.size(); ++v) sum[v] = count[v] > 0.0f ? sum[v] / count[v] : 0.0f;
    return sum;
}

}  // namespace

bool TexturePyramid::decode(const unsigned char* bytes, std::size_t size) {
    int width = 0, height = 0, channels = 0;
    if (size > std::size_t{1} << 30) return false;
    const int length = static_cast<int>(size);
    if (!stbi_info_from_memory(bytes, length, &width, &height, &channels)) return false;
    if (width < 1 || height < 1 || width > kMaxSide || height > kMaxSide) return false;
    unsigned char* pixels = stbi_load_from_memory(bytes, length, &width, &height, &channels, 4);
    if (!pixels) return false;
    Level level{width, height, {}};
    level.texels.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    float linear[256];
    for (int v = 0; v < 256; ++v) linear[v] = linear_from_srgb(static_cast<float>(v) / 255.0f);
    for (std::size_t i = 0; i < level.texels.size(); ++i) {
        const unsigned char* p = pixels + 4 * i;
        const float alpha = static_cast<float>(p[3]) / 255.0f;
        level.texels[i] = glm::vec4(linear[p[0]] * alpha, linear[p[1]] * alpha, linear[p[2]] * alpha, alpha);
    }
    stbi_image_free(pixels);
    levels_.push_back(std::move(level));
    while (levels_.back().width > 1 || levels_.back().height > 1) {
        const Level& fine = levels_.back();
        Level coarse{std::max(1, fine.width / 2), std::max(1, fine.height / 2), {}};
        coarse.texels.reserve(static_cast<std::size_t>(coarse.width) * static_cast<std::size_t>(coarse.height));
        const auto at = [&](int x, int y) {
            return fine
                .texels[static_cast<std::size_t>(std::min(y, fine.height - 1)) * static_cast<std::size_t>(fine.width) +
                        static_cast<std::size_t>(std::min(x, fine.width - 1))];
        };
        for (int y = 0; y < coarse.height; ++y)
            for (int x = 0; x < coarse.width; ++x)
                coarse.texels.push_back(0.25f * (at(2 * x, 2 * y) + at(2 * x + 1, 2 * y) + at(2 * x, 2 * y + 1) +
                                                 at(2 * x + 1, 2 * y + 1)));
        levels_.push_back(std::move(coarse));
    }
    return true;
}

glm::vec3 TexturePyramid::sample(const glm::vec2& uv, float width) const {
    if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) return glm::vec3(0.5f);
    const float texels = std::max(1.0f, width * static_cast<float>(std::max(levels_[0].width, levels_[0].height)));
    // A texel of level n covers 2^n: half the footprint to each side.
    const float wanted = std::isfinite(texels) ? std::floor(std::log2(texels)) : 30.0f;
    const Level& level = levels_[std::min(static_cast<std::size_t>(wanted), levels_.size() - 1)];
    const int x = wrap(uv.x, level.width), y = wrap(uv.y, level.height);
    const glm::vec4 texel =
        level.texels[static_cast<std::size_t>(y) * static_cast<std::size_t>(level.width) + static_cast<std::size_t>(x)];
    if (texel.w > 1e-3f) return glm::vec3(texel) / texel.w;
    const glm::vec4& all = levels_.back().texels[0];
    return all.w > 1e-3f ? glm::vec3(all) / all.w : glm::vec3(0.5f);
}

const TexturePyramid* MaterialColors::texture(int index) {
    if (index < 0 || static_cast<std::size_t>(index) >= model_.textures.size()) return nullptr;
    const int source = model_.textures[static_cast<std::size_t>(index)].source;
    if (source < 0 || static_cast<std::size_t>(source) >= model_.images.size()) return nullptr;
    const auto [entry, added] = images_.try_emplace(source);
    if (added) {
        const auto& bytes = model_.images[static_cast<std::size_t>(source)].image;
        if (bytes.empty() || !entry->second.decode(bytes.data(), bytes.size()))
            warnings.push_back("image " + std::to_string(source) +
                               ": missing or not an image we can read; drawn without it");
    }
    return entry->second.empty() ? nullptr : &entry->second;
}

void MaterialColors::apply(int material, const std::vector<float>& uv, const std::vector<float>& rgba,
                           const std::string& name, TriangleMesh& mesh) {
    glm::vec3 factor = color_for_name(name);
    const TexturePyramid* image = nullptr;
    if (material >= 0 && static_cast<std::size_t>(material) < model_.materials.size()) {
        const auto& pbr = model_.materials[static_cast<std::size_t>(material)].pbrMetallicRoughness;
        factor = glm::vec3(1.0f);
        for (int k = 0; k < 3 && static_cast<std::size_t>(k) < pbr.baseColorFactor.size(); ++k) {
            const float value = static_cast<float>(pbr.baseColorFactor[static_cast<std::size_t>(k)]);
            factor[k] = std::isfinite(value) ? std::clamp(value, 0.0f, 1.0f) : 1.0f;
        }
        if (uv.size() == 2 * mesh.positions.size()) image = texture(pbr.baseColorTexture.index);
    }
    mesh.colors.assign(mesh.positions.size(), factor);
    if (image) {
        const std::vector<float> widths = footprints(uv, mesh);
        for (std::size_t v = 0; v < mesh.colors.size(); ++v)
            mesh.colors[v] *= image->sample({uv[2 * v], uv[2 * v + 1]}, 0.5f * widths[v]);
    }
    if (rgba.size() == 4 * mesh.positions.size())
        for (std::size_t v = 0; v < mesh.colors.size(); ++v)
            for (int k = 0; k < 3; ++k) {
                const float value = rgba[4 * v + static_cast<std::size_t>(k)];
                mesh.colors[v][k] *= std::isfinite(value) ? std::clamp(value, 0.0f, 1.0f) : 1.0f;
            }
}

}  // namespace crofton::assets
