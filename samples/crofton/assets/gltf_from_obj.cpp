// SPDX-License-Identifier: MIT
// Wavefront OBJ as glTF, with all that its corners carry.
#include <array>
#include <glm/geometric.hpp>
#include <map>
#include <unordered_map>

#include "assets/gltf_builder.hpp"

namespace crofton::assets {
namespace {

using Json = nlohmann::ordered_json;
using Corner = std::array<std::uint32_t, 3>;  // position, texture coordinate, normal

struct HashCorner {
    std::size_t operator()(const Corner& c) const {
        std::uint64_t h = 0;
        for (const std::uint32_t i : c) h = (h ^ i) * 0x9E3779B97F4A7C15u ^ h >> 29;
        return static_cast<std::size_t>(h ^ h >> 32);
    }
};

// Attributes that all three corners of a triangle have.
enum Attributes : unsigned { kTexcoord = 1, kNormal = 2, kColor = 4 };

// Triangles of one part whose corners have the same attributes.
struct Batch {
    std::unordered_map<Corner, std::uint32_t, HashCorner> known;
    std::vector<glm::vec3> positions, normals, colors;
    std::vector<glm::vec2> texcoords;
    std::vector<std::uint32_t> indices;
};

std::string to_uri(const std::string& path) {
    std::string uri;
    for (const char c : path) {
        const auto byte = static_cast<unsigned char>(c);
        if (c == '\\') {
            uri += '/';
        } else if (c == '%' || c == '#' || c == '?' || byte <= ' ' || byte >= 127) {
            constexpr char kHex[] = "0123456789ABCDEF";
            uri += {'%', kHex[byte >> 4], kHex[byte & 15u]};
        } else {
            uri += c;
        }
    }
    return uri;
}

class Converter {
  public:
    explicit Converter(const ObjFile& file) : file_(file) {}

    GltfDocument convert(const std::string& folder) {
        Json meshes = Json::array(), nodes = Json::array(), roots = Json::array();
        const std::string* name = nullptr;
        for (const ObjFile::Part& part : file_.parts) {
            if (part.indices.empty()) continue;
            if (!name || *name != part.name) {
                roots.push_back(nodes.size());
                nodes.push_back({{"name", part.name}, {"mesh", meshes.size()}});
                if (const glm::dvec3& o = file_.origin; o != glm::dvec3(0.0))
                    nodes.back()["translation"] = {o.x, o.y, o.z};
                meshes.push_back({{"name", part.name}, {"primitives", Json::array()}});
            }
            name = &part.name;
            add_primitives(part, meshes.back()["primitives"]);
        }
        Json& root = document_.root;
        root["asset"] = {{"version", "2.0"}, {"generator", "crofton"}};
        root["scene"] = 0;
        root["scenes"] = Json::array({{{"nodes", std::move(roots)}}});
        root["nodes"] = std::move(nodes);
        root["meshes"] = std::move(meshes);
        for (const auto& [key, list] :
             {std::pair("materials", &materials_), {"textures", &textures_}, {"images", &images_}})
            if (!list->empty()) root[key] = std::move(*list);
        document_.warnings = file_.warnings;
        document_.warnings.insert(document_.warnings.end(), file_.odd_lines.begin(), file_.odd_lines.end());
        document_.limits = file_.limits;
        document_.bytes_read = file_.bytes_read;
        take_in_images(document_, folder);
        return std::move(document_);
    }

  private:
    [[nodiscard]] static std::uint32_t at(const std::vector<std::uint32_t>& list, std::size_t corner) {
        return list.empty() ? ObjFile::kNone : list[corner];
    }

    [[nodiscard]] bool has_direction(std::uint32_t normal) const {
        return normal != ObjFile::kNone && glm::length(glm::dvec3(file_.normals[normal])) > 0.0;
    }

    [[nodiscard]] unsigned attributes_of(const ObjFile::Part& part, std::size_t first) const {
        unsigned all = kTexcoord | kNormal | kColor;
        for (std::size_t i = first; i < first + 3; ++i) {
            if (at(part.texcoord_indices, i) == ObjFile::kNone) all &= ~unsigned{kTexcoord};
            if (!has_direction(at(part.normal_indices, i))) all &= ~unsigned{kNormal};
            if (file_.colors[part.indices[i]].x < 0.0f) all &= ~unsigned{kColor};
        }
        return all;
    }

    void add_primitives(const ObjFile::Part& part, Json& primitives) {
        std::map<unsigned, Batch> batches;
        for (std::size_t i = 0; i + 2 < part.indices.size(); i += 3) {
            const unsigned attributes = attributes_of(part, i);
            for (std::size_t k = i; k < i + 3; ++k) add_corner(part, k, attributes, batches[attributes]);
        }
        for (const auto& [attributes, batch] : batches) {
            Json json{{"attributes", {{"POSITION", append_positions(document_, batch.positions)}}}};
            if (attributes & kNormal) json["attributes"]["NORMAL"] = append_vectors(document_, batch.normals);
            if (attributes & kTexcoord) json["attributes"]["TEXCOORD_0"] = append_vectors(document_, batch.texcoords);
            if (attributes & kColor) json["attributes"]["COLOR_0"] = append_vectors(document_, batch.colors);
            json["indices"] = append_indices(document_, batch.indices);
            if (!part.material.empty()) json["material"] = material_of(part, (attributes & kColor) != 0);
            primitives.push_back(std::move(json));
        }
    }

    void add_corner(const ObjFile::Part& part, std::size_t i, unsigned attributes, Batch& batch) {
        const std::uint32_t position = part.indices[i];
        const std::uint32_t texcoord = attributes & kTexcoord ? part.texcoord_indices[i] : ObjFile::kNone;
        const std::uint32_t normal = attributes & kNormal ? part.normal_indices[i] : ObjFile::kNone;
        const auto next = static_cast<std::uint32_t>(batch.positions.size());
        const auto [entry, added] = batch.known.try_emplace({position, texcoord, normal}, next);
        batch.indices.push_back(entry->second);
        if (!added) return;
        batch.positions.emplace_back(file_.positions[position] - file_.origin);
        if (attributes & kColor) batch.colors.push_back(file_.colors[position]);
        if (attributes & kNormal) batch.normals.emplace_back(glm::normalize(glm::dvec3(file_.normals[normal])));
        // glTF's images begin at the top.
        if (attributes & kTexcoord)
            batch.texcoords.emplace_back(file_.texcoords[texcoord].x, 1.0f - file_.texcoords[texcoord].y);
    }

    std::size_t material_of(const ObjFile::Part& part, bool colored) {
        const glm::vec3 color = colored ? glm::vec3(1.0f) : part.color;
        Json surface{{"baseColorFactor", {color.x, color.y, color.z, 1.0f}}, {"metallicFactor", 0.0f}};
        if (!part.texture.empty()) surface["baseColorTexture"] = {{"index", texture_of(part.texture)}};
        Json material{{"name", part.material}, {"pbrMetallicRoughness", std::move(surface)}};
        const float strength = std::max({part.emission.x, part.emission.y, part.emission.z});
        if (strength > 0.0f) {
            const glm::vec3 e = glm::max(part.emission, glm::vec3(0.0f)) / std::max(strength, 1.0f);
            material["emissiveFactor"] = {e.x, e.y, e.z};
            if (strength > 1.0f) {
                material["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = strength;
                document_.root["extensionsUsed"] = {"KHR_materials_emissive_strength"};
            }
        }
        // Names are any bytes: those that are no UTF-8 look alike in the JSON, and are told apart as they stand.
        const std::string key =
            part.material + '\0' + part.texture + '\0' + material.dump(-1, ' ', false, Json::error_handler_t::replace);
        const auto [entry, added] = material_numbers_.try_emplace(key, materials_.size());
        if (added) materials_.push_back(std::move(material));
        return entry->second;
    }

    std::size_t texture_of(const std::string& path) {
        const auto [entry, added] = texture_numbers_.try_emplace(path, textures_.size());
        if (added) {
            textures_.push_back({{"source", images_.size()}});
            images_.push_back({{"uri", to_uri(path)}});
        }
        return entry->second;
    }

    const ObjFile& file_;
    GltfDocument document_;
    Json materials_ = Json::array(), textures_ = Json::array(), images_ = Json::array();
    std::map<std::string, std::size_t> material_numbers_, texture_numbers_;
};

}  // namespace

GltfDocument gltf_from_obj(const ObjFile& file, const std::string& folder) {
    return Converter(file).convert(folder);
}

}  // namespace crofton::assets
