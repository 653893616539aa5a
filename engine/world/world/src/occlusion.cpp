// SPDX-License-Identifier: MIT
// Finds, sets and lists occluders, and names those that hide an object.
#include <crofton/boxtree/structure.hpp>
#include <crofton/core/error.hpp>
#include <crofton/cull/classify.hpp>

#include "occluded_view.hpp"
#include "world_state.hpp"

namespace crofton {

Result<void> World::State::set_found_occluders(scene::MeshId mesh, const occlude::FindOptions& how) {
    const auto found = occlude::find_occluders(scene.mesh(mesh), how);
    if (!found) return found.error();
    return occluders.set(mesh, found->occluders);
}

Result<void> World::find_occluders(MeshHandle mesh, const occlude::FindOptions& options) {
    if (auto outside = state_->check_outside(); !outside) return outside.error();
    if (auto known = state_->check(mesh, mesh.index); !known) return known;
    return state_->set_found_occluders(mesh.index, options);
}

Result<void> World::set_occluders(MeshHandle mesh, std::span<const occlude::FoundOccluder> occluders) {
    if (auto outside = state_->check_outside(); !outside) return outside.error();
    if (auto known = state_->check(mesh, mesh.index); !known) return known;
    return state_->occluders.set(mesh.index, occluders);
}

std::span<const occlude::FoundOccluder> World::occluders_of(MeshHandle mesh) const {
    if (!contains(mesh)) return {};
    return state_->occluders.occluders_of(mesh.index);
}

const depth::ClusteredMesh* World::clusters_of(MeshHandle mesh) const {
    if (!contains(mesh)) return nullptr;
    const world::MeshClusters::Mesh* const clusters = state_->mesh_clusters.find(mesh.index);
    return clusters != nullptr ? &clusters->cut : nullptr;
}

Result<void> World::set_occludes(ObjectHandle object, bool occludes) {
    if (auto outside = state_->check_outside(); !outside) return outside.error();
    if (auto known = state_->check(object, object.index); !known) return known;
    world::Object& changed = state_->table.objects.edit(object.index);
    if (changed.instance == kNoIndex || state_->is_shape_alone(changed))
        return fail(ErrorCode::invalid_argument, object.index,
                    "world: the object has no mesh and hides nothing: add an object with a mesh that only occludes");
    changed.occludes = occludes;
    state_->stage(object.index);
    return {};
}

bool World::State::update_occluders() {
    bool changed = occluders.update_regions(regions);
    statistics.occluders_waiting = occluders.waiting_count();
    if (!occluders.any()) return changed;
    changed |= occluders.update(table, scene);
    // Roughly: the bounds only tell how much lies behind an occluder.
    object_bounds = regions.bounds();
    const boxtree::Structure& tree = index.tree().structure();
    if (index.tree().item_count() > 0)
        for (unsigned lane = 0; lane < tree.nodes()[0].count; ++lane) object_bounds.include(tree.child_bounds(0, lane));
    for (const Obb& box : index.moving().boxes()) {
        const glm::dvec3 l1_radius(double{box.half_extents.x} + double{box.half_extents.y} +
                                   double{box.half_extents.z});
        object_bounds.include({box.center - l1_radius, box.center + l1_radius});
    }
    return changed;
}

Result<void> World::State::check_viewed(const ViewResult& visible) const {
    if (!visible.names_ || visible.revision_.update == revision.update) return {};
    return fail(ErrorCode::invalid_argument, kNoItem,
                visible.names_ != &table.names
                    ? "world: the visible objects are of a view of another World: ask the one that was viewed"
                    : "world: the World has changed since the view: view again");
}

Result<void> World::hidden_by(ObjectHandle object, const ViewResult& visible, Vector<OccluderRef>& occluders) const {
    if (auto updated = state_->check_updated(); !updated) return updated;
    const bool of_region = state_->regions.contains(object);
    if (auto known = state_->check(object, object.index); !of_region && !known) return known;
    if (auto own = state_->check_viewed(visible); !own) return own;
    occluders.clear();
    if (!visible.has_occlusion() || (!of_region && !state_->index.has_box(object.index))) return {};
    Vector<occlude::OccluderId> ids;
    const Obb box = of_region ? state_->regions.box(object.index) : state_->index.box(object.index);
    visible.occluded_->buffer->hidden_by(box, ids);
    for (const occlude::OccluderId id : ids) {
        const ObjectRef ref = state_->ref_of(state_->occluders.object_of(id));
        occluders.push_back({ref.object, ref.user, state_->occluders.place_of(id)});
    }
    return {};
}

Result<void> World::drawn_occluders(const ViewResult& visible, Vector<OccluderRef>& occluders) const {
    if (auto updated = state_->check_updated(); !updated) return updated;
    if (auto own = state_->check_viewed(visible); !own) return own;
    occluders.clear();
    if (!visible.has_occlusion()) return {};
    for (const occlude::OccluderId id : visible.occluded_->choice.ids) {
        const ObjectRef ref = state_->ref_of(state_->occluders.object_of(id));
        occluders.push_back({ref.object, ref.user, state_->occluders.place_of(id)});
    }
    return {};
}

}  // namespace crofton
