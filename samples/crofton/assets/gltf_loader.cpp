// SPDX-License-Identifier: MIT
// glTF 2.0, text and binary: the default scene's nodes, matrices and TRS, meshes shared by instances.
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <map>
#include <optional>

#include "assets/file.hpp"
#include "assets/gltf_color.hpp"
#include "assets/gltf_compression.hpp"
#include "assets/gltf_document.hpp"
#include "assets/gltf_primitive.hpp"
#include "assets/scene_source.hpp"

namespace crofton::assets {
namespace {

using Json = nlohmann::ordered_json;

// `count` numbers, or nothing where the member is not there. Errors: of another length, not numbers.
Result<std::optional<std::vector<double>>> numbers(const Json& object, const char* key, std::size_t count) {
    const Json* list = member(object, key);
    if (!list) return std::nullopt;
    std::vector<double> result;
    for (std::size_t i = 0; list->is_array() && i < list->size() && list->at(i).is_number(); ++i)
        result.push_back(list->at(i).get<double>());
    if (result.size() == count && list->size() == count) return result;
    return fail(ErrorCode::parse, kNoItem,
                std::string("its ") + key + " has not " + std::to_string(count) + " numbers");
}

Result<Transform> transform_of(const Json& node) {
    const auto matrix = numbers(node, "matrix", 16), translation = numbers(node, "translation", 3),
               turn = numbers(node, "rotation", 4), scale = numbers(node, "scale", 3);
    for (const auto* part : {&matrix, &translation, &turn, &scale})
        if (!*part) return tl::unexpected(part->error());
    if (*matrix) {
        glm::dmat4 m;
        for (int i = 0; i < 16; ++i) m[i / 4][i % 4] = (**matrix)[static_cast<std::size_t>(i)];
        return from_matrix(m);
    }
    const auto vector = [](const std::optional<std::vector<double>>& v, double otherwise) {
        return v ? glm::dvec3((*v)[0], (*v)[1], (*v)[2]) : glm::dvec3(otherwise);
    };
    glm::dquat rotation(1.0, 0.0, 0.0, 0.0);
    if (*turn) rotation = glm::dquat((**turn)[3], (**turn)[0], (**turn)[1], (**turn)[2]);
    const double length = glm::length(rotation);
    if (!(length > 1e-6) || !std::isfinite(length))
        return fail(ErrorCode::degenerate, kNoItem, "its rotation is no quaternion of length one");
    return from_trs(vector(*translation, 0.0), rotation / length, vector(*scale, 1.0));
}

// emissiveFactor · KHR_materials_emissive_strength; textures of it are not read.
glm::vec3 emission_of(const Json& material) {
    glm::vec3 result(0.0f);
    const Json* factor = member(material, "emissiveFactor");
    const Json* extensions = member(material, "extensions");
    const Json* strong = extensions ? member(*extensions, "KHR_materials_emissive_strength") : nullptr;
    const Json* strength = strong ? member(*strong, "emissiveStrength") : nullptr;
    const double times = strength && strength->is_number() ? strength->get<double>() : 1.0;
    for (std::size_t k = 0; k < 3 && factor && factor->is_array() && k < factor->size(); ++k)
        if (factor->at(k).is_number())
            result[static_cast<int>(k)] = static_cast<float>(factor->at(k).get<double>() * times);
    return result;
}

class GltfReader {
  public:
    GltfReader(const std::string& path, const GltfDocument& document, const LoadOptions& options)
        : document_(document),
          root_(document.root),
          colors_(document, folder(path)),
          limits_(options.limits),
          deadline_(options.limits),
          source_{file_name(path), scene::Scene({options.criterion}), {}, {}, document.warnings, {}} {}

    Result<SceneSource> read() {
        if (auto walked = add_nodes(); !walked) return tl::unexpected(walked.error());
        if (source_.scene.instance_count() == 0)
            return fail(ErrorCode::empty, kNoItem,
                        "its scene shows no triangles, so there is nothing to draw: " + why_empty());
        for (std::string& warning : colors_.warnings) source_.warnings.push_back(std::move(warning));
        return std::move(source_);
    }

  private:
    std::string why_empty() const {
        if (!source_.warnings.empty()) return source_.warnings.front();
        const Json* meshes = member(root_, "meshes");
        if (!meshes || !meshes->is_array() || meshes->empty()) return "it has no meshes";
        return "none of its " + std::to_string(meshes->size()) + " meshes has triangles and is on a node of the scene";
    }

    void leave_out(const std::string& what, const Error& why) {
        source_.warnings.push_back(what + ": left out: " + why.message);
    }

    // The whole numbers of an array; others are left out, with a warning.
    std::vector<std::size_t> indices_of(const Json& object, const char* key, const std::string& where) {
        std::vector<std::size_t> result;
        for (std::size_t i = 0; const Json* value = entry(object, key, i); ++i) {
            if (const auto index = as_whole_number(*value))
                result.push_back(*index);
            else
                leave_out(where, {ErrorCode::parse, kNoItem, "one of its " + std::string(key) + " is no index"});
        }
        return result;
    }

    // Of the default scene; without one the first; without any scene, the nodes that are nobody's child.
    std::vector<std::size_t> roots() {
        const auto wanted = whole_number(root_, "scene", 0);
        const Json* scene = wanted ? entry(root_, "scenes", *wanted) : nullptr;
        if (!scene && (scene = entry(root_, "scenes", 0)))
            source_.warnings.push_back("its default scene does not exist; the first one is shown");
        if (scene) return indices_of(*scene, "nodes", "scene");
        std::vector<bool> is_child(entry_count(root_, "nodes"), false);
        for (std::size_t n = 0; const Json* node = entry(root_, "nodes", n); ++n)
            for (std::size_t i = 0; const Json* child = entry(*node, "children", i); ++i)
                if (const auto index = as_whole_number(*child); index && *index < is_child.size())
                    is_child[*index] = true;
        std::vector<std::size_t> result;
        for (std::size_t i = 0; i < is_child.size(); ++i)
            if (!is_child[i]) result.push_back(i);
        return result;
    }

    Result<void> add_nodes() {
        struct Todo {
            std::size_t node;
            scene::NodeId parent;
        };
        const auto top = roots();
        std::vector<Todo> stack;
        for (auto root = top.rbegin(); root != top.rend(); ++root) stack.push_back({*root, scene::kNone});
        std::vector<bool> seen(entry_count(root_, "nodes"), false);
        while (!stack.empty()) {
            if (auto in_time = deadline_.check(); !in_time) return in_time;
            const Todo todo = stack.back();
            stack.pop_back();
            const Json* node = entry(root_, "nodes", todo.node);
            if (!node) {
                leave_out("node " + std::to_string(todo.node), {ErrorCode::out_of_range, kNoItem, "does not exist"});
                continue;
            }
            const std::string name = label("node", todo.node, *node);
            if (seen[todo.node]) {
                leave_out(name, {ErrorCode::parse, kNoItem, "has two parents, or is its own ancestor"});
                continue;
            }
            seen[todo.node] = true;
            const auto local = transform_of(*node);
            if (!local) {
                leave_out(name + " and all below it", local.error());
                continue;
            }
            const auto added = add_node(name, *node, *local, todo.parent);
            if (!added) return tl::unexpected(added.error());
            const auto children = indices_of(*node, "children", name);
            for (auto child = children.rbegin(); child != children.rend(); ++child) stack.push_back({*child, *added});
        }
        return {};
    }

    Result<scene::NodeId> add_node(const std::string& name, const Json& node, const Transform& local,
                                   scene::NodeId parent) {
        const Json* own = member(node, "name");
        const auto id =
            source_.scene.add_node(parent, local, ~0u, own && own->is_string() ? own->get<std::string>() : "");
        const Json* mesh = member(node, "mesh");
        if (!id || !mesh) return id;
        const auto number = as_whole_number(*mesh);
        if (!number || !entry(root_, "meshes", *number)) {
            leave_out(name + ": mesh " + mesh->dump().substr(0, 40),
                      {ErrorCode::out_of_range, kNoItem, "does not exist"});
            return id;
        }
        const auto meshes = meshes_of(*number);
        if (!meshes) return tl::unexpected(meshes.error());
        for (const scene::MeshId part : **meshes) {
            if (source_.scene.instance_count() >= limits_.nodes) return over_limit("nodes", limits_.nodes);
            if (auto added = source_.scene.add_instance(*id, part); !added) return tl::unexpected(added.error());
        }
        return id;
    }

    // One scene mesh per primitive, made when first used. Damaged primitives are left out.
    Result<const std::vector<scene::MeshId>*> meshes_of(std::size_t index) {
        const auto known = meshes_.find(index);
        if (known != meshes_.end()) return &known->second;
        const Json& mesh = *entry(root_, "meshes", index);
        const Json* own = member(mesh, "name");
        const std::string mesh_name = own && own->is_string() ? own->get<std::string>() : "";
        std::vector<scene::MeshId> ids;
        for (std::size_t p = 0; const Json* primitive = entry(mesh, "primitives", p); ++p) {
            if (auto in_time = deadline_.check(); !in_time) return tl::unexpected(in_time.error());
            const std::string name = label("mesh", index, mesh) + ": primitive " + std::to_string(p);
            auto made = mesh_of(*primitive, mesh_name, name);
            auto id = made ? source_.scene.add_mesh(std::move(*made), mesh_name) : tl::unexpected(made.error());
            if (!id) {
                leave_out(name, id.error());
                continue;
            }
            ids.push_back(*id);
            note_material(*id, material_of(*primitive));
        }
        return &meshes_.emplace(index, std::move(ids)).first->second;
    }

    [[nodiscard]] const Json* material_of(const Json& primitive) const {
        const auto number = whole_number(primitive, "material", kNoNumber);
        return number ? entry(root_, "materials", *number) : nullptr;
    }

    // Faces without a material are one-sided as well: it is glTF's default.
    void note_material(scene::MeshId mesh, const Json* material) {
        source_.one_sided.resize(mesh + std::size_t{1});
        const Json* twice = material ? member(*material, "doubleSided") : nullptr;
        source_.one_sided[mesh] = !(twice && twice->is_boolean() && twice->get<bool>());
        if (!material) return;
        const Json* extensions = member(*material, "extensions");
        if (extensions && member(*extensions, "KHR_materials_unlit")) {
            source_.unlit.resize(mesh + std::size_t{1});
            source_.unlit[mesh] = 1;
        }
        const glm::vec3 emission = emission_of(*material);
        if (emission == glm::vec3(0.0f)) return;
        source_.emission.resize(mesh + std::size_t{1});
        source_.emission[mesh].assign(source_.scene.mesh(mesh).triangle_count(), emission);
    }

    Result<TriangleMesh> mesh_of(const Json& primitive, const std::string& name, const std::string& where) {
        if (const std::string reason = reason_to_draw_nothing(primitive); !reason.empty())
            return fail(ErrorCode::unsupported, kNoItem, reason);
        auto read = read_primitive(document_, primitive, {0.0, std::numeric_limits<double>::infinity()});
        if (!read) return tl::unexpected(read.error());
        if (read->mesh.indices.empty()) return fail(ErrorCode::empty, kNoItem, "has no triangles");
        TriangleMesh mesh = std::move(read->mesh);
        const auto values = [&](const char* attribute, int components) -> std::vector<float> {
            const Json* accessor = member(primitive.at("attributes"), attribute);
            if (!accessor) return {};
            std::string storage;
            const auto number = as_whole_number(*accessor);
            const auto elements =
                accessor_elements(document_, number.value_or(kNoNumber), mesh.positions.size(), storage);
            if (elements) return to_floats(*elements, components);
            source_.warnings.push_back(where + ": " + attribute + ": " + elements.error().message +
                                       "; drawn without it");
            return {};
        };
        colors_.apply(material_of(primitive), values("TEXCOORD_0", 2), values("COLOR_0", 4), name, mesh);
        return mesh;
    }

    const GltfDocument& document_;
    const Json& root_;
    MaterialColors colors_;
    ReadLimits limits_;
    Deadline deadline_;
    SceneSource source_;
    std::map<std::size_t, std::vector<scene::MeshId>> meshes_;
};

// The first extension that the file cannot be shown without; empty where there is none.
std::string missing_extension(const Json& root) {
    for (std::size_t i = 0; const Json* name = entry(root, "extensionsRequired", i); ++i) {
        if (!name->is_string()) continue;
        const auto& extension = name->get_ref<const std::string&>();
        if (extension != "KHR_mesh_quantization" && extension.rfind("KHR_materials", 0) != 0 &&
            extension != "KHR_texture_transform" && !decodes(extension))
            return extension;
    }
    return {};
}

}  // namespace

Result<SceneSource> load_gltf(const std::string& path, const LoadOptions& options) {
    const auto document =
        read_gltf_document(path, {.limits = options.limits, .images = false, .whole_buffers = options.strict});
    if (!document) return tl::unexpected(document.error());
    if (const std::string missing = missing_extension(document->root); !missing.empty())
        return fail(ErrorCode::unsupported, kNoItem,
                    path + ": needs the extension " + missing + ", which is not supported");
    auto source = GltfReader(path, *document, options).read();
    if (!source) return in_file(path, "", source.error());
    return source;
}

}  // namespace crofton::assets
