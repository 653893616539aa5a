// SPDX-License-Identifier: MIT
#include "mesh_world.hpp"

#include <utility>

namespace crofton::viewer {

MeshWorld::MeshWorld(const scene::Scene& scene, std::vector<scene::InstanceId> movers)
    : scene_(&scene), movers_(std::move(movers)) {}

Result<MeshWorld> MeshWorld::create(const scene::Scene& scene, std::vector<scene::InstanceId> movers) {
    MeshWorld result(scene, std::move(movers));
    auto made = result.add_meshes();
    if (made) made = result.add_objects();
    if (made) made = result.world_.update();
    if (!made) return tl::unexpected(std::move(made.error()));
    return result;
}

Result<void> MeshWorld::add_meshes() {
    meshes_.resize(scene_->mesh_count());
    for (scene::MeshId id = 0; id < meshes_.size(); ++id) {
        const TriangleMesh& mesh = scene_->mesh(id);
        if (mesh.indices.empty()) continue;
        const auto added = world_.add_mesh({.positions = mesh.positions, .indices = mesh.indices});
        if (!added) return fail(added.error().code, id, added.error().message);
        meshes_[id] = *added;
    }
    return {};
}

Result<void> MeshWorld::add_objects() {
    objects_.resize(scene_->instance_count());
    for (scene::InstanceId i = 0; i < objects_.size(); ++i) {
        if (scene_->is_removed(i) || meshes_[scene_->mesh_of(i)].is_null()) continue;
        const auto added = world_.add({.mesh = meshes_[scene_->mesh_of(i)],
                                       .transform = scene_->world(scene_->node_of(i)),
                                       .user = i,
                                       .collides_with = 0});
        if (!added) return fail(added.error().code, i, added.error().message);
        objects_[i] = *added;
    }
    return {};
}

Result<void> MeshWorld::update(bool contacts) {
    const bool changes = std::exchange(finds_contacts_, contacts) != contacts;
    for (const scene::InstanceId i : movers_) {
        if (objects_[i].is_null()) continue;
        if (auto set = world_.set_transform(objects_[i], scene_->world(scene_->node_of(i))); !set) return set;
        if (!changes) continue;
        if (auto set = world_.set_collides_with(objects_[i], contacts ? ~0u : 0u); !set) return set;
    }
    return world_.update();
}

}  // namespace crofton::viewer
