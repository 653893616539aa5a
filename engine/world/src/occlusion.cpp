// SPDX-License-Identifier: MIT
// Views that leave out what is hidden; which occluders there are, and which hide an object.
#include <algorithm>
#include <array>
#include <bit>
#include <crofton/boxtree/structure.hpp>
#include <crofton/core/error.hpp>
#include <crofton/cull/classify.hpp>
#include <optional>

#include "must.hpp"
#include "occluded_view.hpp"
#include "trace_zone.hpp"
#include "world_state.hpp"

namespace crofton {

Result<void> World::State::set_found_occluders(scene::MeshId mesh, const occlude::FindOptions& how) {
    const auto found = occlude::find_occluders(scene.mesh(mesh), how);
    if (!found) return tl::unexpected(found.error());
    return occluders.set(mesh, found->occluders);
}

Result<void> World::find_occluders(MeshHandle mesh, const occlude::FindOptions& options) {
    if (auto known = state_->check(mesh, mesh.index); !known) return known;
    return state_->set_found_occluders(mesh.index, options);
}

Result<void> World::set_occluders(MeshHandle mesh, std::span<const occlude::FoundOccluder> occluders) {
    if (auto known = state_->check(mesh, mesh.index); !known) return known;
    return state_->occluders.set(mesh.index, occluders);
}

std::span<const occlude::FoundOccluder> World::occluders_of(MeshHandle mesh) const {
    if (!contains(mesh)) return {};
    return state_->occluders.occluders_of(mesh.index);
}

Result<void> World::set_occludes(ObjectHandle object, bool occludes) {
    if (auto known = state_->check(object, object.index); !known) return known;
    world::Object& changed = state_->table.objects[object.index];
    if (changed.instance == kNoIndex)
        return fail(ErrorCode::invalid_argument, object.index,
                    "world: the object is a bound and hides nothing: add an object with a mesh that only occludes");
    changed.occludes = occludes;
    state_->stage(object.index);
    return {};
}

void World::State::update_occluders() {
    if (!occluders.any()) return;
    occluders.update(table, scene);
    // Roughly: the bounds only tell how much lies behind an occluder.
    object_bounds = {};
    const boxtree::Structure& tree = index.tree().structure();
    if (index.tree().item_count() > 0)
        for (unsigned lane = 0; lane < tree.nodes()[0].count; ++lane) object_bounds.include(tree.child_bounds(0, lane));
    for (const Obb& box : index.moving().boxes()) {
        const glm::dvec3 l1_radius(double{box.half_extents.x} + double{box.half_extents.y} +
                                   double{box.half_extents.z});
        object_bounds.include({box.center - l1_radius, box.center + l1_radius});
    }
}

Result<void> World::State::find_visible(const OccludingView& view, const OcclusionOptions& occlusion,
                                        const cull::CullOptions& how, Executor& executor,
                                        world::OccludedView& result) const {
    if (auto sized = result.resize(occlusion.size); !sized) return sized;
    const world::TraceZone zone(options.trace, "World::view with occlusion");
    Vector<std::uint32_t>& ids = result.choice.ids;
    occlude::choose_occluders(occluders.candidates(), view.view,
                              {.max_occluders = occlusion.max_occluders,
                               .least_cover = occlusion.least_cover,
                               .objects = object_bounds,
                               .layer_mask = view.layer_mask},
                              result.choice);
    // What the view does not draw hides nothing.
    if (how.limits)
        ids.erase(std::remove_if(ids.begin(), ids.end(),
                                 [&](std::uint32_t id) {
                                     const std::uint32_t object = occluders.object_of(id);
                                     const std::uint32_t common = occluders.candidates().layers(id) & view.layer_mask;
                                     return !cull::is_worth_drawing(*how.limits, index.box(object), object, common);
                                 }),
                  ids.end());
    {
        const world::TraceZone part(options.trace, "view: draw occluders");
        result.buffer->draw(occluders.set(), ids, view.view, executor);
    }
    const world::TraceZone part(options.trace, "view: what is not hidden");
    occlude::find_visible(index.tree(), index.moving(), *result.buffer, result.visible,
                          {.layer_mask = view.layer_mask, .mode = how.mode, .limits = how.limits, .among = how.among});
    world::trace_count(options.trace, "objects not hidden", result.visible.size());
    return {};
}

Result<void> World::view(const Camera& camera, const OcclusionOptions& occlusion, VisibleObjects& visible,
                         const cull::CullOptions& options, Executor& executor) const {
    if (!occlusion.enabled) return view(camera, visible, options, executor);
    const auto occlusion_view = occlude::occlusion_view_of(camera);
    if (!occlusion_view) return tl::unexpected(occlusion_view.error());
    return view(OccludingView{*occlusion_view}, occlusion, visible, options, executor);
}

Result<void> World::view(const OccludingView& view, const OcclusionOptions& occlusion, VisibleObjects& visible,
                         const cull::CullOptions& options, Executor& executor) const {
    const cull::View plain{view.view.frustum, view.layer_mask};
    if (!occlusion.enabled) {
        this->view(plain, visible, options, executor);
        return {};
    }
    if (!visible.occluded_) visible.occluded_ = world::make_occluded_view();
    world::OccludedView& result = *visible.occluded_;
    cull::CullOptions how = options;
    how.among = state_->among_and_changed(options.among, visible.among_);
    if (auto found = state_->find_visible(view, occlusion, how, executor, result); !found) return found;
    visible.names_ = &state_->table.names;
    visible.hides_ = true;
    result.occluded.clear();
    result.by_tree = how.order == cull::ResultOrder::tree;
    if (!occlusion.list_occluded && !result.by_tree) return {};
    cull::find_visible(state_->index.tree(), state_->index.moving(), plain, visible.set_, how, executor);
    result.split(visible.set_, state_->index.size());
    if (!occlusion.list_occluded) result.occluded.clear();
    return {};
}

Result<void> World::view(std::span<const OccludingView> views, const OcclusionOptions& occlusion,
                         VisibleInViews& visible, const cull::CullOptions& options, Executor& executor) const {
    if (auto few = cull::check_view_count(views.size()); !few) return few;
    std::array<cull::View, cull::kMaxViews> plain;
    for (std::size_t v = 0; v < views.size(); ++v) plain[v] = {views[v].view.frustum, views[v].layer_mask};
    if (!occlusion.enabled) return view(std::span(plain).first(views.size()), visible, options, executor);
    while (visible.occluded_.size() < views.size()) visible.occluded_.push_back(world::make_occluded_view());
    for (std::size_t v = 0; v < views.size(); ++v)
        if (auto sized = visible.occluded_[v]->resize(occlusion.size); !sized) return sized;
    cull::CullOptions how = options;
    how.among = state_->among_and_changed(options.among, visible.among_);
    executor.parallel_for(views.size(), 1, [&](std::size_t begin, std::size_t end, unsigned) {
        for (std::size_t v = begin; v < end; ++v)
            world::must(state_->find_visible(views[v], occlusion, how, serial_executor(), *visible.occluded_[v]));
    });
    visible.names_ = &state_->table.names;
    visible.hides_ = true;
    visible.view_count_ = views.size();
    visible.start_list(state_->index.size());
    for (std::size_t v = 0; v < views.size(); ++v) visible.add(visible.occluded_[v]->visible.ids(), v);
    if (how.order == cull::ResultOrder::ascending) {
        visible.sort();
        return {};
    }
    if (auto asked = cull::find_visible(state_->index.tree(), state_->index.moving(),
                                        std::span<const cull::View>(plain).first(views.size()), visible.set_, how.mode,
                                        how.limits);
        !asked)
        return asked;
    visible.ids_.clear();
    for (const std::uint32_t id : visible.set_.ids())
        if (visible.masks_[id] != 0) visible.ids_.push_back(id);
    return {};
}

Result<void> World::State::check_viewed(const world::ObjectNames* viewed) const {
    if (!viewed || viewed == &table.names) return {};
    return fail(ErrorCode::invalid_argument, kNoItem,
                "world: the visible objects are of a view of another World: ask the one that was viewed");
}

Result<void> World::hidden_by(ObjectHandle object, const VisibleObjects& visible,
                              Vector<OccluderRef>& occluders) const {
    occluders.clear();
    if (auto known = state_->check(object, object.index); !known) return known;
    if (auto own = state_->check_viewed(visible.names_); !own) return own;
    if (!visible.hides_ || !state_->index.has_box(object.index)) return {};
    Vector<occlude::OccluderId> ids;
    visible.occluded_->buffer->hidden_by(state_->index.box(object.index), ids);
    for (const occlude::OccluderId id : ids) {
        const ObjectRef ref = state_->table.ref(state_->occluders.object_of(id));
        occluders.push_back({ref.object, ref.user, state_->occluders.place_of(id)});
    }
    return {};
}

Result<void> World::drawn_occluders(const VisibleObjects& visible, Vector<OccluderRef>& occluders) const {
    occluders.clear();
    if (auto own = state_->check_viewed(visible.names_); !own) return own;
    if (!visible.hides_) return {};
    for (const occlude::OccluderId id : visible.occluded_->choice.ids) {
        const ObjectRef ref = state_->table.ref(state_->occluders.object_of(id));
        occluders.push_back({ref.object, ref.user, state_->occluders.place_of(id)});
    }
    return {};
}

}  // namespace crofton
