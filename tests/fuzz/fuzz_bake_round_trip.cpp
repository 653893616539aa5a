// SPDX-License-Identifier: MIT
// A scene, baked and read again: all of it is there, its tree sees what a plain list does, and a damaged byte is
// noticed or without effect.
#include <algorithm>
#include <crofton/bake/baked_scene.hpp>
#include <crofton/cull/cull.hpp>

#include "scene_model.hpp"

namespace {

using namespace crofton;
using fuzz::demand;

template <class T>
bool same_bytes(std::span<const T> a, std::span<const T> b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size_bytes()) == 0);
}

void compare(const scene::Scene& scene, const bake::BakedScene& baked) {
    demand(baked.mesh_count() == scene.mesh_count() && baked.instances().size() == scene.instance_count() &&
               baked.nodes().size() == scene.node_count(),
           "counts of a baked scene");
    for (scene::MeshId m = 0; m < scene.mesh_count(); ++m) {
        const bake::MeshView view = baked.mesh(m);
        const TriangleMesh& mesh = scene.mesh(m);
        demand(same_bytes(view.positions, std::span<const glm::vec3>(mesh.positions)) &&
                   same_bytes(view.indices, std::span<const std::uint32_t>(mesh.indices)),
               "a baked mesh");
        if (!scene.is_mesh_removed(m))
            demand(view.name == scene.mesh_name(m) && std::memcmp(&view.box, &scene.mesh_box(m), sizeof(Obb)) == 0,
                   "a baked mesh's name and box");
    }
    for (scene::InstanceId i = 0; i < scene.instance_count(); ++i) {
        const bake::InstanceRecord& record = baked.instances()[i];
        demand(record.mesh == scene.mesh_of(i) && record.node == scene.node_of(i), "a baked instance");
        demand(baked.tree().layer_masks()[i] == scene.layer_masks()[i], "a baked instance's layers");
        if (!scene.is_removed(i))
            demand(std::memcmp(&baked.tree().boxes()[i], &scene.world_boxes()[i], sizeof(Obb)) == 0, "a baked box");
    }
    for (scene::NodeId n = 0; n < scene.node_count(); ++n) {
        if (scene.is_node_removed(n)) continue;
        demand(baked.nodes()[n].parent == scene.parent_of(n), "a baked node's parent");
        demand(std::memcmp(&baked.nodes()[n].world, &scene.world(n), sizeof(Transform)) == 0, "a baked node");
    }
}

}  // namespace

CROFTON_FUZZ(in) {
    fuzz::LivingScene living(in);
    const auto orientation = static_cast<boxtree::Orientation>(in.below(3));
    for (int step = 0; step < 40 && in.more(); ++step) living.change(in);
    living.settle();
    auto file = bake::bake(living.scene, serial_executor(), {.tree = orientation});
    demand(file.has_value(), "bake");
    const auto again = bake::bake(living.scene, serial_executor(), {.tree = orientation});
    demand(again.has_value() && same_bytes<std::byte>(*file, *again), "baking is deterministic");
    {
        const auto baked = bake::BakedScene::from_memory(*file);
        demand(baked.has_value(), "a baked scene is read");
        compare(living.scene, *baked);
        cull::VisibleSet of_list, of_tree;
        const cull::View view{in.frustum(), in.layers()};
        cull::find_visible(living.scene.world_boxes(), living.scene.layer_masks(), view, of_list);
        cull::find_visible(baked->tree(), view, of_tree);
        demand(std::equal(of_list.ids().begin(), of_list.ids().end(), of_tree.ids().begin(), of_tree.ids().end()),
               "what a baked scene shows");
    }
    const std::size_t at = in.word() % file->size();
    (*file)[at] ^= static_cast<std::byte>(1u << in.below(8));
    if (const auto damaged = bake::BakedScene::from_memory(*file)) compare(living.scene, *damaged);
}
