// SPDX-License-Identifier: MIT
#include "assets/gltf_color.hpp"

#include <stb/stb_image.h>

#include <algorithm>
#include <cmath>

#include "assets/name_color.hpp"
#include "srgb.hpp"

namespace crofton::assets {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kMaxKeptSide = 1024;

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

// Fills a level with averages of texel(i), i from 0 to width * height, by blocks that leave none out.
template <class Texel, class Level>
void average_blocks(int width, int height, const Texel& texel, Level& level) {
    const auto size = [](int side) { return static_cast<std::size_t>(side); };
    level.texels.reserve(size(level.width) * size(level.height));
    for (std::size_t y = 0; y < size(level.height); ++y)
        for (std::size_t x = 0; x < size(level.width); ++x) {
            const std::size_t left = x * size(width) / size(level.width),
                              right = (x + 1) * size(width) / size(level.width);
            const std::size_t top = y * size(height) / size(level.height),
                              bottom = (y + 1) * size(height) / size(level.height);
            glm::vec4 sum(0.0f);
            for (std::size_t j = top; j < bottom; ++j)
                for (std::size_t i = left; i < right; ++i) sum += texel(j * size(width) + i);
            level.texels.push_back(sum / static_cast<float>((right - left) * (bottom - top)));
        }
}

}  // namespace

// One texel for a block of 2 × 2; of 3 where a side is odd, and of 1 where it has come down to that.
TexturePyramid::Level TexturePyramid::half(const Level& fine) {
    Level coarse{std::max(1, fine.width / 2), std::max(1, fine.height / 2), {}};
    average_blocks(
        fine.width, fine.height, [&](std::size_t i) { return fine.texels[i]; }, coarse);
    return coarse;
}

// The finest level that is kept: averages of blocks of about 2^n × 2^n pixels.
TexturePyramid::Level TexturePyramid::finest(const unsigned char* pixels, int width, int height) {
    float linear[256];
    for (int v = 0; v < 256; ++v) linear[v] = linear_from_srgb(static_cast<float>(v) / 255.0f);
    int block = 1;
    while (width / block > kMaxKeptSide || height / block > kMaxKeptSide) block *= 2;
    Level level{std::max(1, width / block), std::max(1, height / block), {}};
    const auto texel = [&](std::size_t i) {
        const unsigned char* p = pixels + 4 * i;
        const float alpha = static_cast<float>(p[3]) / 255.0f;
        return glm::vec4(linear[p[0]] * alpha, linear[p[1]] * alpha, linear[p[2]] * alpha, alpha);
    };
    average_blocks(width, height, texel, level);
    return level;
}

Result<void> TexturePyramid::decode(std::string_view bytes, const ReadLimits& limits) {
    int width = 0, height = 0, channels = 0;
    const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
    const int length = static_cast<int>(std::min(bytes.size(), std::size_t{1} << 30));
    if (!stbi_info_from_memory(data, length, &width, &height, &channels) || width < 1 || height < 1)
        return fail(ErrorCode::unsupported, kNoItem, "not an image we can read");
    if (static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height) > limits.pixels)
        return fail(ErrorCode::budget_exceeded, kNoItem,
                    std::to_string(width) + " x " + std::to_string(height) + " is " +
                        over_limit("pixels", limits.pixels).message);
    unsigned char* pixels = stbi_load_from_memory(data, length, &width, &height, &channels, 4);
    if (!pixels) return fail(ErrorCode::parse, kNoItem, "damaged, not an image we can read");
    levels_.push_back(finest(pixels, width, height));
    stbi_image_free(pixels);
    while (levels_.back().width > 1 || levels_.back().height > 1) levels_.push_back(half(levels_.back()));
    return {};
}

std::uint64_t TexturePyramid::texels() const {
    return levels_.empty() ? 0 : levels_[0].texels.size();
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

Result<void> MaterialColors::decode(std::size_t image, TexturePyramid& pyramid) {
    if (texels_ >= document_.limits.pixels) return over_limit("pixels", document_.limits.pixels);
    const auto bytes = image_bytes(document_, image, folder_, bytes_read_);
    if (!bytes) return bytes.error();
    if (auto decoded = pyramid.decode(*bytes, document_.limits); !decoded) return decoded;
    texels_ += pyramid.texels();
    return {};
}

const TexturePyramid* MaterialColors::texture(const Json& reference) {
    const auto index = whole_number(reference, "index", kNoNumber);
    const Json* texture = index ? entry(document_.root, "textures", *index) : nullptr;
    const auto source = texture ? whole_number(*texture, "source", kNoNumber) : Result<std::size_t>(kNoNumber);
    if (!source || *source == kNoNumber) return nullptr;
    const auto [found, added] = images_.try_emplace(*source);
    if (added)
        if (const auto decoded = decode(*source, found->second); !decoded)
            warnings.push_back("image " + std::to_string(*source) + ": " + decoded.error().message +
                               "; drawn without it");
    return found->second.empty() ? nullptr : &found->second;
}

void MaterialColors::apply(const Json* material, const std::vector<float>& uv, const std::vector<float>& rgba,
                           const std::string& name, TriangleMesh& mesh) {
    // A primitive without a material is white, as the format says: by its name only if it has no colour at all.
    const bool has_colors = rgba.size() == 4 * mesh.positions.size();
    glm::vec3 factor = has_colors ? glm::vec3(1.0f) : color_for_name(name);
    const TexturePyramid* image = nullptr;
    if (material) {
        factor = glm::vec3(1.0f);
        const Json* pbr = member(*material, "pbrMetallicRoughness");
        const Json* given = pbr ? member(*pbr, "baseColorFactor") : nullptr;
        for (std::size_t k = 0; k < 3 && given && given->is_array() && k < given->size(); ++k)
            if (given->at(k).is_number())
                factor[static_cast<int>(k)] = std::clamp(given->at(k).get<float>(), 0.0f, 1.0f);
        const Json* reference = pbr ? member(*pbr, "baseColorTexture") : nullptr;
        if (reference && uv.size() == 2 * mesh.positions.size()) image = texture(*reference);
    }
    mesh.colors.assign(mesh.positions.size(), factor);
    if (image) {
        const std::vector<float> widths = footprints(uv, mesh);
        for (std::size_t v = 0; v < mesh.colors.size(); ++v)
            mesh.colors[v] *= image->sample({uv[2 * v], uv[2 * v + 1]}, 0.5f * widths[v]);
    }
    if (has_colors)
        for (std::size_t v = 0; v < mesh.colors.size(); ++v)
            for (int k = 0; k < 3; ++k) {
                const float value = rgba[4 * v + static_cast<std::size_t>(k)];
                mesh.colors[v][k] *= std::isfinite(value) ? std::clamp(value, 0.0f, 1.0f) : 1.0f;
            }
}

}  // namespace crofton::assets
