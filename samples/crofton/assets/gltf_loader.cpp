// SPDX-License-Identifier: MIT
// glTF 2.0, text and binary: the default scene's nodes, matrices and TRS, meshes shared by instances.
#include <tiny_gltf.h>

#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <map>

#include "assets/file.hpp"
#include "assets/gltf_accessor.hpp"
#include "assets/gltf_color.hpp"
#include "assets/gltf_elements.hpp"
#include "assets/gltf_primitive.hpp"
#include "assets/scene_source.hpp"

namespace crofton::assets {
namespace {

// Keeps the file's bytes; MaterialColors decodes what is used, and reports what cannot be.
bool keep_bytes(tinygltf::Image* image, const int, std::string*, std::string*, int, int, const unsigned char* bytes,
                int size, void*) {
    image->image.assign(bytes, bytes + size);
    image->as_is = true;
    return true;
}

bool exists(int index, std::size_t count) {
    return index >= 0 && static_cast<std::size_t>(index) < count;
}

std::string label(const char* what, int index, const std::string& name) {
    return what + (" " + std::to_string(index)) + (name.empty() ? "" : " '" + name + "'");
}

class GltfReader {
  public:
    GltfReader(const std::string& path, const tinygltf::Model& model, const LoadOptions& options)
        : model_(model), colors_(model), source_{file_name(path), scene::Scene({options.criterion}), {}, {}, {}, {}} {}

    Result<SceneSource> read() {
        if (auto walked = add_nodes(); !walked) return tl::unexpected(walked.error());
        if (source_.scene.instance_count() == 0)
            return fail(ErrorCode::empty, kNoItem,
                        "its scene shows no triangles, so there is nothing to draw" +
                            (source_.warnings.empty() ? "" : ": " + source_.warnings.front()));
        for (std::string& warning : colors_.warnings) source_.warnings.push_back(std::move(warning));
        return std::move(source_);
    }

  private:
    Result<void> roots(std::vector<int>& result) const {
        if (!model_.scenes.empty()) {
            const int index = model_.defaultScene < 0 ? 0 : model_.defaultScene;
            if (!exists(index, model_.scenes.size()))
                return fail(ErrorCode::out_of_range, kNoItem, "scene " + std::to_string(index) + " does not exist");
            result = model_.scenes[static_cast<std::size_t>(index)].nodes;
            return {};
        }
        std::vector<bool> is_child(model_.nodes.size(), false);
        for (const auto& node : model_.nodes)
            for (const int child : node.children)
                if (exists(child, is_child.size())) is_child[static_cast<std::size_t>(child)] = true;
        for (std::size_t i = 0; i < is_child.size(); ++i)
            if (!is_child[i]) result.push_back(static_cast<int>(i));
        return {};
    }

    Result<void> add_nodes() {
        struct Todo {
            int node;
            scene::NodeId parent;
        };
        std::vector<int> top;
        if (auto found = roots(top); !found) return found;
        std::vector<Todo> stack;
        for (auto root = top.rbegin(); root != top.rend(); ++root) stack.push_back({*root, scene::kNone});
        std::vector<bool> seen(model_.nodes.size(), false);
        while (!stack.empty()) {
            const Todo todo = stack.back();
            stack.pop_back();
            if (!exists(todo.node, seen.size()))
                return fail(ErrorCode::out_of_range, kNoItem, "node " + std::to_string(todo.node) + " does not exist");
            const auto& node = model_.nodes[static_cast<std::size_t>(todo.node)];
            if (seen[static_cast<std::size_t>(todo.node)])
                return fail(ErrorCode::parse, static_cast<std::uint64_t>(todo.node),
                            label("node", todo.node, node.name) + ": has two parents, or is its own ancestor");
            seen[static_cast<std::size_t>(todo.node)] = true;
            const auto local = transform_of(node);
            if (!local) {
                leave_out(label("node", todo.node, node.name) + " and all below it", local.error());
                continue;
            }
            const auto added = add_node(todo.node, node, *local, todo.parent);
            if (!added) return in_file(label("node", todo.node, node.name), "", added.error());
            for (auto child = node.children.rbegin(); child != node.children.rend(); ++child)
                stack.push_back({*child, *added});
        }
        return {};
    }

    void leave_out(const std::string& what, const Error& why) {
        source_.warnings.push_back(what + ": left out: " + why.message);
    }

    Result<scene::NodeId> add_node(int index, const tinygltf::Node& node, const scene::Transform& local,
                                   scene::NodeId parent) {
        const auto id = source_.scene.add_node(parent, local, ~0u, node.name);
        if (!id || node.mesh < 0) return id;
        if (!exists(node.mesh, model_.meshes.size()))
            return fail(ErrorCode::out_of_range, static_cast<std::uint64_t>(index),
                        "mesh " + std::to_string(node.mesh) + " does not exist");
        for (const scene::MeshId mesh : meshes_of(node.mesh))
            if (auto added = source_.scene.add_instance(*id, mesh); !added) return tl::unexpected(added.error());
        return id;
    }

    static Result<scene::Transform> transform_of(const tinygltf::Node& node) {
        if (!node.matrix.empty()) {
            if (node.matrix.size() != 16) return fail(ErrorCode::parse, kNoItem, "its matrix has not 16 numbers");
            glm::dmat4 matrix;
            for (int i = 0; i < 16; ++i) matrix[i / 4][i % 4] = node.matrix[static_cast<std::size_t>(i)];
            return scene::from_matrix(matrix);
        }
        const auto vector = [](const std::vector<double>& v, double otherwise) {
            return v.size() == 3 ? glm::dvec3(v[0], v[1], v[2]) : glm::dvec3(otherwise);
        };
        glm::dquat rotation(1.0, 0.0, 0.0, 0.0);
        if (node.rotation.size() == 4)
            rotation = glm::dquat(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]);
        const double length = glm::length(rotation);
        if (!(length > 1e-6) || !std::isfinite(length))
            return fail(ErrorCode::degenerate, kNoItem, "its rotation is no quaternion of length one");
        return scene::from_trs(vector(node.translation, 0.0), rotation / length, vector(node.scale, 1.0));
    }

    // One scene mesh per primitive, made when first used. Damaged primitives are left out.
    const std::vector<scene::MeshId>& meshes_of(int index) {
        const auto known = meshes_.find(index);
        if (known != meshes_.end()) return known->second;
        const auto& mesh = model_.meshes[static_cast<std::size_t>(index)];
        std::vector<scene::MeshId> ids;
        for (std::size_t p = 0; p < mesh.primitives.size(); ++p) {
            const std::string name = label("mesh", index, mesh.name) + ": primitive " + std::to_string(p);
            auto made = mesh_of(mesh.primitives[p], mesh.name, name);
            if (!made) {
                leave_out(name, made.error());
                continue;
            }
            if (made->indices.empty()) continue;
            const auto id = source_.scene.add_mesh(std::move(*made), mesh.name);
            if (!id) {
                leave_out(name, id.error());
                continue;
            }
            ids.push_back(*id);
            note_unlit(*id, mesh.primitives[p].material);
            note_sides(*id, mesh.primitives[p].material);
            const glm::vec3 emission = emission_of(mesh.primitives[p].material);
            if (emission == glm::vec3(0.0f)) continue;
            source_.emission.resize(*id + 1);
            source_.emission[*id].assign(source_.scene.mesh(*id).triangle_count(), emission);
        }
        return meshes_.emplace(index, std::move(ids)).first->second;
    }

    // emissiveFactor · KHR_materials_emissive_strength; textures of it are not read.
    [[nodiscard]] glm::vec3 emission_of(int material) const {
        glm::vec3 result(0.0f);
        if (!exists(material, model_.materials.size())) return result;
        const auto& m = model_.materials[static_cast<std::size_t>(material)];
        double strength = 1.0;
        if (const auto found = m.extensions.find("KHR_materials_emissive_strength"); found != m.extensions.end())
            if (const auto& value = found->second.Get("emissiveStrength"); value.IsNumber())
                strength = value.GetNumberAsDouble();
        for (std::size_t k = 0; k < 3 && k < m.emissiveFactor.size(); ++k)
            result[static_cast<int>(k)] = static_cast<float>(m.emissiveFactor[k] * strength);
        return result;
    }

    // Faces without a material are one-sided as well: it is glTF's default.
    void note_sides(scene::MeshId mesh, int material) {
        source_.one_sided.resize(mesh + std::size_t{1});
        source_.one_sided[mesh] = !exists(material, model_.materials.size()) ||
                                  !model_.materials[static_cast<std::size_t>(material)].doubleSided;
    }

    void note_unlit(scene::MeshId mesh, int material) {
        if (!exists(material, model_.materials.size())) return;
        if (model_.materials[static_cast<std::size_t>(material)].extensions.count("KHR_materials_unlit") == 0) return;
        source_.unlit.resize(mesh + std::size_t{1});
        source_.unlit[mesh] = 1;
    }

    Result<TriangleMesh> mesh_of(const tinygltf::Primitive& primitive, const std::string& name,
                                 const std::string& where) {
        TriangleMesh mesh;
        const auto position = primitive.attributes.find("POSITION");
        if (position == primitive.attributes.end()) {
            source_.warnings.push_back(where + ": has no positions; left out");
            return mesh;
        }
        const auto xyz = read_floats(model_, position->second, 3);
        if (!xyz) return tl::unexpected(xyz.error());
        std::vector<std::uint32_t> indices;
        if (primitive.indices >= 0) {
            auto read = read_indices(model_, primitive.indices);
            if (!read) return tl::unexpected(read.error());
            indices = std::move(*read);
        } else {
            for (std::uint32_t i = 0; i < xyz->size() / 3; ++i) indices.push_back(i);
        }
        indices = triangle_list(primitive.mode < 0 ? kGltfTriangles : primitive.mode, std::move(indices));
        if (indices.empty()) source_.warnings.push_back(where + ": is not made of triangles; left out");
        mesh.indices.assign(indices.begin(), indices.end());
        for (std::size_t i = 0; i < xyz->size(); i += 3)
            mesh.positions.emplace_back((*xyz)[i], (*xyz)[i + 1], (*xyz)[i + 2]);
        if (auto valid = validate(mesh); !valid) return tl::unexpected(valid.error());
        const auto optional = [&](const char* attribute, int components) -> std::vector<float> {
            const auto found = primitive.attributes.find(attribute);
            if (found == primitive.attributes.end()) return {};
            auto values = read_floats(model_, found->second, components);
            if (values) return std::move(*values);
            source_.warnings.push_back(where + ": " + attribute + ": " + values.error().message + "; drawn without it");
            return {};
        };
        colors_.apply(primitive.material, optional("TEXCOORD_0", 2), optional("COLOR_0", 4), name, mesh);
        return mesh;
    }

    const tinygltf::Model& model_;
    MaterialColors colors_;
    SceneSource source_;
    std::map<int, std::vector<scene::MeshId>> meshes_;
};

std::string first_line(const std::string& text) {
    const std::string line = text.substr(0, text.find('\n'));
    return line.empty() ? "damaged, or no glTF file" : line.substr(0, 300);
}

// Which mesh and primitive the parser could not take, or else what it said itself.
Error why_unreadable(const std::string& path, const std::string& said) {
    const auto document = read_gltf_document(path);
    if (!document) return document.error();
    const auto checked = check_primitives(*document);
    return in_file(path, "", checked ? Error{ErrorCode::parse, kNoItem, first_line(said)} : checked.error()).value();
}

}  // namespace

Result<SceneSource> load_gltf(const std::string& path, const LoadOptions& options) {
    const auto contents = read_file(path);
    if (!contents) return tl::unexpected(contents.error());
    if (contents->size() >= std::size_t{1} << 32)
        return fail(ErrorCode::out_of_range, kNoItem, path + ": larger than glTF's limit of 4 GiB");
    // The parser walks its tree recursively.
    if (const auto json = gltf_json(*contents, path); !json) return in_file(path, "", json.error());
    tinygltf::TinyGLTF parser;
    parser.SetImageLoader(keep_bytes, nullptr);
    tinygltf::Model model;
    std::string error, warning;
    bool parsed = false;
    const auto size = static_cast<unsigned int>(contents->size());
    const std::string base = folder(path).empty() ? "." : folder(path);
    try {
        parsed = extension(path) == "glb"
                     ? parser.LoadBinaryFromMemory(&model, &error, &warning,
                                                   reinterpret_cast<const unsigned char*>(contents->data()), size, base)
                     : parser.LoadASCIIFromString(&model, &error, &warning, contents->data(), size, base);
    } catch (const std::exception& exception) {
        error = exception.what();
    }
    if (!parsed) return tl::unexpected<Error>(why_unreadable(path, error));
    for (const std::string& extension : model.extensionsRequired)
        if (extension != "KHR_mesh_quantization" && extension.rfind("KHR_materials", 0) != 0 &&
            extension != "KHR_texture_transform")
            return fail(ErrorCode::unsupported, kNoItem,
                        path + ": needs the extension " + extension + ", which is not supported");
    auto source = GltfReader(path, model, options).read();
    if (!source) return in_file(path, "", source.error());
    return source;
}

}  // namespace crofton::assets
