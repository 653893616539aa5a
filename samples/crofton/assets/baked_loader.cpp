// SPDX-License-Identifier: MIT
// A scene out of what `crofton bake` wrote.
#include <crofton/bake/baked_scene.hpp>

#include <algorithm>
#include <optional>

#include "assets/baked_source.hpp"
#include "assets/file.hpp"
#include "assets/scene_source.hpp"

namespace crofton::assets {
namespace {

TriangleMesh mesh_of(const bake::MeshView& view) {
    TriangleMesh mesh;
    mesh.positions.assign(view.positions.begin(), view.positions.end());
    mesh.colors.assign(view.colors.begin(), view.colors.end());
    mesh.indices.assign(view.indices.begin(), view.indices.end());
    return mesh;
}

Result<scene::MeshId> add_polygon(const bake::PolygonView& view, const bake::MeshView& mesh, scene::Scene& scene) {
    scene::PlanarPolygon polygon{{}, view.origin, view.u, view.v};
    polygon.polygon.points.assign(view.points.begin(), view.points.end());
    polygon.polygon.ring_ends.assign(view.ring_ends.begin(), view.ring_ends.end());
    if (!mesh.colors.empty()) polygon.color = mesh.colors.front();
    std::vector<std::array<std::uint32_t, 3>> triangles;
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
        triangles.push_back({mesh.indices[i], mesh.indices[i + 1], mesh.indices[i + 2]});
    return scene.add_polygon(std::move(polygon), triangles, mesh.name);
}

// A polygon has one colour; a mesh that was coloured otherwise stays a mesh.
bool has_one_color(const bake::MeshView& mesh) {
    return std::all_of(mesh.colors.begin(), mesh.colors.end(),
                       [&](const glm::vec3& color) { return color == mesh.colors.front(); });
}

void set_flag(std::vector<std::uint8_t>& flags, scene::MeshId mesh, bool set) {
    if (!set) return;
    flags.resize(std::max<std::size_t>(flags.size(), mesh + std::size_t{1}));
    flags[mesh] = 1;
}

void take_looks(const bake::BakedScene& baked, SceneSource& source) {
    for (scene::MeshId i = 0; i < baked.mesh_count(); ++i) {
        const bake::MeshLook look = baked.mesh(i).look;
        set_flag(source.unlit, i, look.unlit);
        set_flag(source.one_sided, i, look.one_sided);
        set_flag(source.flat, i, look.flat);
    }
}

// All meshes' or none.
void take_clusters(const bake::BakedScene& baked, SceneSource& source) {
    std::vector<depth::ClusteredMesh> clusters;
    for (scene::MeshId i = 0; i < baked.mesh_count(); ++i) {
        const depth::ClusteredMesh* const own = baked.clusters(i);
        if (own == nullptr) return;
        clusters.push_back(*own);
    }
    source.clusters = std::move(clusters);
}

// Nodes stand where they stood, each by itself: which was another's child does not matter to what is seen.
Result<void> fill(const bake::BakedScene& baked, scene::Scene& scene) {
    for (scene::MeshId i = 0; i < baked.mesh_count(); ++i) {
        const bake::MeshView view = baked.mesh(i);
        const auto polygon = has_one_color(view) ? baked.polygon(i) : std::nullopt;
        const auto added = polygon ? add_polygon(*polygon, view, scene) : scene.add_mesh(mesh_of(view), view.name);
        if (!added) return added.error();
    }
    for (const bake::NodeRecord& node : baked.nodes())
        if (auto added = scene.add_node(scene::kNone, node.world); !added) return added.error();
    const auto masks = baked.tree().layer_masks();
    for (std::size_t i = 0; i < baked.instances().size(); ++i) {
        const bake::InstanceRecord& instance = baked.instances()[i];
        if (instance.mesh == scene::kNone) continue;
        const auto added = scene.add_instance(instance.node, instance.mesh);
        if (!added) return added.error();
        if (i < masks.size())
            if (auto set = scene.set_instance_layers(*added, masks[i]); !set) return set;
    }
    return {};
}

}  // namespace

Result<SceneSource> load_baked(const std::string& path, const LoadOptions& options) {
    const auto refused = [](const Error& error) {
        return fail(error.code, error.item,
                    std::string(error.message) +
                        " ('crofton bake' writes scenes, and so does 'crofton pvs' with --with-scene)");
    };
    const auto file = bake::MappedFile::open(path, {.access = bake::FileAccess::read, .largest = options.limits.bytes});
    if (!file) return refused(file.error());
    const auto baked = bake::BakedScene::from_memory(file->bytes());
    if (!baked)
        return refused({baked.error().code, baked.error().item, path + ": " + std::string(baked.error().message)});
    SceneSource source{file_name(path), scene::Scene({options.criterion}), {}, {}, {}, {}};
    std::uint64_t triangles = 0;
    for (scene::MeshId i = 0; i < baked->mesh_count(); ++i) triangles += baked->mesh(i).indices.size() / 3;
    if (triangles > options.limits.triangles)
        return in_file(path, "", over_limit("triangles", options.limits.triangles));
    if (baked->nodes().size() > options.limits.nodes)
        return in_file(path, "", over_limit("nodes", options.limits.nodes));
    if (auto filled = fill(*baked, source.scene); !filled) return in_file(path, "", filled.error());
    take_looks(*baked, source);
    take_clusters(*baked, source);
    if (auto read = read_visit(file->bytes(), source); !read) return in_file(path, "", read.error());
    return source;
}

}  // namespace crofton::assets
