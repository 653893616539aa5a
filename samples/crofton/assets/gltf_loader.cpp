// SPDX-License-Identifier: MIT
// glTF 2.0, text and binary: the default scene's nodes that are visible, meshes shared by instances, morph targets and
// skins as they are before anything is animated.
#include <cmath>
#include <glm/common.hpp>
#include <limits>
#include <map>
#include <tuple>

#include "assets/file.hpp"
#include "assets/float_origin.hpp"
#include "assets/gltf_color.hpp"
#include "assets/gltf_compression.hpp"
#include "assets/gltf_document.hpp"
#include "assets/gltf_extensions.hpp"
#include "assets/gltf_node.hpp"
#include "assets/gltf_pose.hpp"
#include "assets/gltf_primitive.hpp"
#include "assets/scene_source.hpp"

namespace crofton::assets {
namespace {

using Json = nlohmann::ordered_json;

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

// A mesh of the file as its vertices are on some node.
struct Shape {
    std::size_t mesh = 0, skin = kNoNumber;
    std::vector<double> weights = {};  // of its morph targets; empty: none moves anything
    friend bool operator<(const Shape& a, const Shape& b) {
        return std::tie(a.mesh, a.skin, a.weights) < std::tie(b.mesh, b.skin, b.weights);
    }
};

// Its primitives in the scene.
struct ShapeMeshes {
    std::vector<scene::MeshId> ids;
    glm::dvec3 origin{0.0};  // of a skinned one: where it stands in the world
};

// A skinned mesh gets an origin of its own, as its vertices are those of the world.
glm::dvec3 origin_of(std::span<const glm::dvec3> positions) {
    glm::dvec3 low = positions[0], high = low;
    for (const glm::dvec3& p : positions) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    return float_origin(low, high);
}

class GltfReader {
  public:
    GltfReader(const std::string& path, const GltfDocument& document, const LoadOptions& options)
        : document_(document),
          root_(document.root),
          colors_(document, folder(path)),
          skins_(document),
          limits_(options.limits),
          deadline_(options.limits),
          source_{file_name(path), scene::Scene({options.criterion}), {}, {}, document.warnings, {}} {}

    Result<SceneSource> read() {
        auto lacks = check_extensions(document_);  // told last: it is no reason to show nothing
        if (!lacks) return lacks.error();
        if (auto walked = add_nodes(); !walked) return walked.error();
        if (source_.scene.instance_count() == 0)
            return fail(ErrorCode::empty, kNoItem,
                        "its scene shows no triangles, so there is nothing to draw: " + why_empty());
        for (auto* warnings : {&*lacks, &colors_.warnings})
            for (std::string& warning : *warnings) source_.warnings.push_back(std::move(warning));
        return std::move(source_);
    }

  private:
    std::string why_empty() const {
        if (!source_.warnings.empty()) return source_.warnings.front();
        const Json* meshes = member(root_, "meshes");
        if (!meshes || !meshes->is_array() || meshes->empty()) return "it has no meshes";
        if (hidden_) return "all nodes with meshes are hidden by KHR_node_visibility";
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

    // Returns the roots of the default scene, or of the first; without any scene, the nodes that have no parent.
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
            const auto visible = is_visible(*node);
            if (!visible) source_.warnings.push_back(name + ": " + visible.error().message + "; it is shown");
            if (visible && !*visible) {
                hidden_ = true;
                continue;
            }
            const auto local = transform_of(*node);
            if (!local) {
                leave_out(name + " and all below it", local.error());
                continue;
            }
            const auto added = add_node(name, *node, *local, todo.parent);
            if (!added) return added.error();
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
        if (!id || !member(node, "mesh")) return id;
        if (auto added = add_instances(name, node, *id); !added) return added.error();
        return id;
    }

    // Adds the instances of the node's mesh. Leaves out invalid ones.
    Result<void> add_instances(const std::string& name, const Json& node, scene::NodeId id) {
        const auto shape = shape_of(node);
        if (!shape) {
            leave_out(name + ": mesh " + member(node, "mesh")->dump().substr(0, 40), shape.error());
            return {};
        }
        const auto made = meshes_of(*shape);
        if (!made) return made.error();
        const ShapeMeshes& meshes = **made;
        const Json* instancing = instancing_of(node);
        if (instancing && shape->skin != kNoNumber) {
            source_.warnings.push_back(name + ": EXT_mesh_gpu_instancing of a skinned mesh: shown once");
            instancing = nullptr;
        }
        if (instancing) return add_placements(name, *instancing, id, meshes);
        if (shape->skin == kNoNumber) return add_meshes(id, meshes);
        // A skinned mesh stands where its joints are; its node's own transform says nothing.
        return add_placed({glm::dmat3(1.0), meshes.origin}, scene::kNone, id, meshes);
    }

    // Finds the mesh that a node shows, with its skin and morph weights.
    Result<Shape> shape_of(const Json& node) const {
        const auto mesh = as_whole_number(*member(node, "mesh"));
        if (!mesh || !entry(root_, "meshes", *mesh)) return fail(ErrorCode::out_of_range, kNoItem, "does not exist");
        auto weights = morph_weights(node, *entry(root_, "meshes", *mesh));
        if (!weights) return weights.error();
        const auto skin = whole_number(node, "skin", kNoNumber);
        if (!skin) return skin.error();
        return Shape{*mesh, *skin, std::move(*weights)};
    }

    Result<void> add_meshes(scene::NodeId node, const ShapeMeshes& meshes) {
        for (const scene::MeshId part : meshes.ids) {
            if (source_.scene.instance_count() >= limits_.nodes) return over_limit("nodes", limits_.nodes);
            if (auto added = source_.scene.add_instance(node, part); !added) return added.error();
        }
        return {};
    }

    // On a node of their own, which is called as `like` is.
    Result<void> add_placed(const Transform& place, scene::NodeId parent, scene::NodeId like,
                            const ShapeMeshes& meshes) {
        if (meshes.ids.empty()) return {};
        if (source_.scene.node_count() >= limits_.nodes) return over_limit("nodes", limits_.nodes);
        const std::string name(source_.scene.node_name(like));
        const auto node = source_.scene.add_node(parent, place, ~0u, name);
        if (!node) return node.error();
        return add_meshes(*node, meshes);
    }

    Result<void> add_placements(const std::string& name, const Json& instancing, scene::NodeId node,
                                const ShapeMeshes& meshes) {
        if (meshes.ids.empty()) return {};
        const auto places = placements(document_, instancing);
        if (!places && places.error().code == ErrorCode::budget_exceeded) return places.error();
        if (!places) {
            leave_out(name + ": EXT_mesh_gpu_instancing", places.error());
            return {};
        }
        // Those that are left out count as well, so that many nodes cannot ask for many each.
        instances_asked_ += places->transforms.size() + places->left_out;
        if (instances_asked_ > limits_.nodes) return over_limit("nodes", limits_.nodes);
        if (places->left_out > 0)
            source_.warnings.push_back(name + ": EXT_mesh_gpu_instancing: " + std::to_string(places->left_out) +
                                       " instances left out: " + places->why);
        for (const Transform& place : places->transforms)
            if (auto added = add_placed(place, node, node, meshes); !added) return added;
        return {};
    }

    // One scene mesh per primitive, made when first used. Damaged primitives are left out.
    Result<const ShapeMeshes*> meshes_of(const Shape& shape) {
        const auto known = meshes_.find(shape);
        if (known != meshes_.end()) return &known->second;
        const Json& mesh = *entry(root_, "meshes", shape.mesh);
        const Json* own = member(mesh, "name");
        const std::string mesh_name = own && own->is_string() ? own->get<std::string>() : "";
        ShapeMeshes made;
        for (std::size_t p = 0; const Json* primitive = entry(mesh, "primitives", p); ++p) {
            if (auto in_time = deadline_.check(); !in_time) return in_time.error();
            const std::string name = label("mesh", shape.mesh, mesh) + ": primitive " + std::to_string(p);
            auto read = mesh_of(*primitive, shape, mesh_name, name, made);
            if (triangles_ > limits_.triangles || vertices_ / 3 > limits_.triangles)
                return over_limit("triangles", limits_.triangles);
            auto id = read ? source_.scene.add_mesh(std::move(*read), mesh_name) : read.error();
            if (!id) {
                leave_out(name, id.error());
                continue;
            }
            made.ids.push_back(*id);
            note_looks(*id, *primitive);
        }
        return &meshes_.emplace(shape, std::move(made)).first->second;
    }

    [[nodiscard]] const Json* material_of(const Json& primitive) const {
        const auto number = whole_number(primitive, "material", kNoNumber);
        return number ? entry(root_, "materials", *number) : nullptr;
    }

    // Faces without a material are one-sided as well, and without normals flat: it is glTF's default.
    void note_looks(scene::MeshId mesh, const Json& primitive) {
        if (!member(primitive.at("attributes"), "NORMAL")) {
            source_.flat.resize(mesh + std::size_t{1});
            source_.flat[mesh] = 1;
        }
        const Json* material = material_of(primitive);
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

    Result<TriangleMesh> mesh_of(const Json& primitive, const Shape& shape, const std::string& name,
                                 const std::string& where, ShapeMeshes& siblings) {
        if (const std::string reason = reason_to_draw_nothing(primitive); !reason.empty())
            return fail(ErrorCode::unsupported, kNoItem, reason);
        auto read = read_primitive(document_, primitive, {0.0, std::numeric_limits<double>::infinity()});
        if (!read) return read.error();
        if (read->mesh.indices.empty()) return fail(ErrorCode::empty, kNoItem, "has no triangles");
        TriangleMesh mesh = std::move(read->mesh);
        // Each way in which a mesh is bent is a mesh of its own.
        triangles_ += mesh.triangle_count();
        vertices_ += mesh.positions.size();
        if (auto bent = bend(primitive, shape, siblings, mesh); !bent) return bent.error();
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

    // Moves the vertices as morph targets and the skin say. The first primitive of a skinned mesh chooses its origin.
    Result<void> bend(const Json& primitive, const Shape& shape, ShapeMeshes& siblings, TriangleMesh& mesh) {
        const bool morphs = !shape.weights.empty() && entry_count(primitive, "targets") > 0;
        if (!morphs && shape.skin == kNoNumber) return {};
        std::vector<glm::dvec3> positions(mesh.positions.begin(), mesh.positions.end());
        if (morphs)
            if (auto done = apply_morph(document_, primitive, shape.weights, deadline_, positions); !done) return done;
        if (shape.skin != kNoNumber) {
            const auto joints = skins_.joints(shape.skin);
            if (!joints) return joints.error();
            if (auto done = apply_skin(document_, primitive, *joints, positions); !done) return done;
            if (siblings.ids.empty()) siblings.origin = origin_of(positions);
        }
        for (std::size_t v = 0; v < positions.size(); ++v)
            mesh.positions[v] = glm::vec3(positions[v] - siblings.origin);
        return validate(mesh);
    }

    const GltfDocument& document_;
    const Json& root_;
    MaterialColors colors_;
    SkinPoses skins_;
    ReadLimits limits_;
    Deadline deadline_;
    SceneSource source_;
    std::map<Shape, ShapeMeshes> meshes_;
    std::uint64_t triangles_ = 0, vertices_ = 0, instances_asked_ = 0;
    bool hidden_ = false;
};

}  // namespace

Result<SceneSource> load_gltf(const std::string& path, const LoadOptions& options) {
    const auto document = read_gltf_document(
        path, {.limits = options.limits, .images = false, .whole_buffers = options.strict, .plain_copies = true});
    if (!document) return document.error();
    auto source = GltfReader(path, *document, options).read();
    if (!source) return in_file(path, "", source.error());
    return source;
}

}  // namespace crofton::assets
