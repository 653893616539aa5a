// SPDX-License-Identifier: MIT
// A scene out of what `crofton bake` wrote.
#include <crofton/bake/baked_scene.hpp>

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
    std::vector<std::array<std::uint32_t, 3>> triangles;
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
        triangles.push_back({mesh.indices[i], mesh.indices[i + 1], mesh.indices[i + 2]});
    return scene.add_polygon(std::move(polygon), triangles, mesh.name);
}

// Nodes stand where they stood, each by itself: which was another's child does not matter to what is seen.
Result<void> fill(const bake::BakedScene& baked, scene::Scene& scene) {
    for (scene::MeshId i = 0; i < baked.mesh_count(); ++i) {
        const bake::MeshView view = baked.mesh(i);
        const auto polygon = view.colors.empty() ? baked.polygon(i) : std::nullopt;
        const auto added = polygon ? add_polygon(*polygon, view, scene) : scene.add_mesh(mesh_of(view), view.name);
        if (!added) return tl::unexpected(added.error());
    }
    for (const bake::NodeRecord& node : baked.nodes())
        if (auto added = scene.add_node(scene::kNone, node.world); !added) return tl::unexpected(added.error());
    const auto masks = baked.tree().layer_masks();
    for (std::size_t i = 0; i < baked.instances().size(); ++i) {
        const bake::InstanceRecord& instance = baked.instances()[i];
        if (instance.mesh == scene::kNone) continue;
        const auto added = scene.add_instance(instance.node, instance.mesh);
        if (!added) return tl::unexpected(added.error());
        if (i < masks.size())
            if (auto set = scene.set_instance_layers(*added, masks[i]); !set) return set;
    }
    return {};
}

}  // namespace

Result<SceneSource> load_baked(const std::string& path, const LoadOptions& options) {
    const auto baked = bake::BakedScene::open(path, serial_executor(),
                                              {.access = bake::FileAccess::read, .largest = options.limits.bytes});
    if (!baked)
        return fail(baked.error().code, baked.error().item,
                    std::string(baked.error().message) +
                        " ('crofton bake' writes scenes, and so does 'crofton pvs' with --with-scene)");
    SceneSource source{file_name(path), scene::Scene({options.criterion}), {}, {}, {}, {}};
    std::uint64_t triangles = 0;
    for (scene::MeshId i = 0; i < baked->mesh_count(); ++i) triangles += baked->mesh(i).indices.size() / 3;
    if (triangles > options.limits.triangles)
        return in_file(path, "", over_limit("triangles", options.limits.triangles).value());
    if (baked->nodes().size() > options.limits.nodes)
        return in_file(path, "", over_limit("nodes", options.limits.nodes).value());
    if (auto filled = fill(*baked, source.scene); !filled) return in_file(path, "", filled.error());
    source.in_metres = false;
    return source;
}

}  // namespace crofton::assets
