// SPDX-License-Identifier: MIT
// Views: checks the requests, then queries the tree, with or without occlusion.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <crofton/core/error.hpp>
#include <crofton/geometry/finite.hpp>
#include <optional>

#include "eye.hpp"
#include "occluded_view.hpp"
#include "require_ok.hpp"
#include "trace_zone.hpp"
#include "world_state.hpp"

namespace crofton {

namespace {

using world::Eye;

// An error of a request that is one of many names its place.
Error at_item(Error error, std::uint64_t item) {
    if (item != kNoItem) error.item = item;
    return error;
}

Result<void> check_volume(const Frustum& volume, std::uint64_t item) {
    if (volume.plane_count > Frustum::kMaxPlanes)
        return fail(ErrorCode::out_of_range, item, "view: a volume has at most 12 planes");
    if (!is_finite(volume.origin))
        return fail(ErrorCode::non_finite, item, "view: the volume's origin is NaN or infinite");
    for (std::size_t p = 0; p < volume.plane_count; ++p)
        if (!is_finite(volume.planes[p].normal) || !std::isfinite(volume.planes[p].offset))
            return fail(ErrorCode::non_finite, item, {"view: plane ", p, " of the volume is NaN or infinite"});
    return {};
}

Result<void> check_limits(const cull::DrawLimits& limits, std::uint64_t item) {
    if (!(limits.hysteresis >= 1.0))
        return fail(ErrorCode::out_of_range, item, "view: `hysteresis` of the limits is less than 1 or NaN");
    if (!limits.layer_distances.empty() && limits.layer_distances.size() != 32)
        return fail(ErrorCode::invalid_argument, item, "view: limits have 32 `layer_distances` or none");
    return {};
}

Result<void> check_occlusion(const OcclusionOptions& occlusion, std::uint64_t item) {
    if (auto good = occlude::validate(occlusion.size); !good) return at_item(good.error(), item);
    if (std::isnan(occlusion.least_cover))
        return fail(ErrorCode::non_finite, item, "view: `least_cover` of the occlusion is NaN");
    return {};
}

// After this, nothing of the request can be refused but its camera or matrix.
Result<void> check(const ViewRequest& request, std::uint64_t item) {
    const auto refuse = [&](const char* why) { return fail(ErrorCode::invalid_argument, item, why); };
    const bool has_eye = request.camera || request.matrix;
    if (!has_eye && !request.volume) return refuse("view: set `camera`, `matrix` or `volume`");
    if (request.camera && request.matrix) return refuse("view: set `camera` or `matrix`, not both");
    if (request.volume)
        if (auto good = check_volume(*request.volume, item); !good) return good;
    if (request.limits != nullptr)
        if (auto good = check_limits(*request.limits, item); !good) return good;
    if (auto good = world::check_picture(request, item); !good) return good;
    if (!request.occlusion) {
        if (has_eye && request.volume)
            return refuse("view: a volume beside a camera or matrix is for occlusion; set one of them");
        return {};
    }
    if (!has_eye) return refuse("view: occlusion needs a `camera` or a `matrix`, because a volume has no eye");
    return check_occlusion(*request.occlusion, item);
}

Result<Eye> eye_of(const ViewRequest& request, std::uint64_t item) {
    if (auto good = check(request, item); !good) return good.error();
    Eye eye;
    eye.plain.layer_mask = request.layers;
    if (request.occlusion) {
        const auto view = request.camera ? occlude::occlusion_view_of(*request.camera)
                                         : occlude::occlusion_view_of(request.matrix->to_clip, request.matrix->depth,
                                                                      request.matrix->origin);
        if (!view) return at_item(view.error(), item);
        eye.occluding = *view;
        if (request.volume) eye.occluding.frustum = *request.volume;
        eye.plain.frustum = eye.occluding.frustum;
        return eye;
    }
    if (request.volume) {
        eye.plain.frustum = *request.volume;
        return eye;
    }
    const auto frustum = request.camera
                             ? frustum_of(*request.camera)
                             : frustum_of(request.matrix->to_clip, request.matrix->depth, request.matrix->origin);
    if (!frustum) return at_item(frustum.error(), item);
    eye.plain.frustum = *frustum;
    return eye;
}

// Whether one walk through the tree answers all requests.
bool fit_one_walk(std::span<const ViewRequest> requests) {
    return std::all_of(requests.begin(), requests.end(), [&](const ViewRequest& request) {
        return !request.occlusion && !request.picture && request.candidate_mask.empty() &&
               request.limits == requests[0].limits && request.mode == requests[0].mode;
    });
}

}  // namespace

std::span<const std::uint64_t> World::State::candidates_and_changed(std::span<const std::uint64_t> candidate_mask,
                                                                    Vector<std::uint64_t>& both) const {
    if (candidate_mask.empty()) return {};
    both.assign(candidate_mask.begin(), candidate_mask.end());
    const std::span<const std::uint64_t> changed = index.changed();
    for (std::size_t w = 0; w < std::min(both.size(), changed.size()); ++w) both[w] |= changed[w];
    index.add_movers_that_moved(both);
    return both;
}

void World::State::find_triangles(const ViewRequest& request, const world::PictureView::InFrustum& in_frustum,
                                  world::OccludedView& result, Executor& executor) const {
    const world::TraceZone zone(options.trace, "view: list triangles");
    result.by_picture = true;
    const world::PictureView* const seen = request.receivers ? &request.receivers->seen->occluded_->picture : nullptr;
    result.picture.find(
        request, in_frustum, seen,
        [&](std::uint32_t id) -> world::PictureView::Drawn {
            if (world::is_region_index(id)) return regions.drawn(id);
            const world::Object& object = table.objects[id];
            // One that has been removed, in this World's list until the next update, hides nothing.
            const bool has_mesh = object.alive && object.kind == BoundKind::none;
            const auto* const clusters = has_mesh ? mesh_clusters.find(object.mesh) : nullptr;
            if (clusters == nullptr) return {.box = index.box(id)};
            const Transform& world = scene.world(scene.node_of(object.instance));
            return {.clusters = clusters,
                    .placed = {nullptr, &world.linear, world.translation},
                    .occludes = object.occludes};
        },
        executor);
    world::trace_count(options.trace, "triangles to draw", result.picture.statistics().triangles_listed);
}

void World::State::draw_and_ask(const occlude::OcclusionView& view, const OcclusionOptions& occlusion,
                                std::uint32_t layers, const cull::CullOptions& how, Executor& executor,
                                world::OccludedView& result) const {
    const world::TraceZone zone(options.trace, "World::view with occlusion");
    Vector<std::uint32_t>& ids = result.choice.ids;
    occlude::choose_occluders(occluders.candidates(), view,
                              {.max_occluders = occlusion.max_occluders,
                               .least_cover = occlusion.least_cover,
                               .objects = object_bounds,
                               .layer_mask = layers},
                              result.choice);
    // What the view does not draw hides nothing, and what has left the World.
    ids.erase(std::remove_if(ids.begin(), ids.end(), [&](std::uint32_t id) { return occluders.is_gone(id, regions); }),
              ids.end());
    if (how.limits)
        ids.erase(std::remove_if(ids.begin(), ids.end(),
                                 [&](std::uint32_t id) {
                                     const std::uint32_t object = occluders.object_of(id);
                                     const std::uint32_t common = occluders.candidates().layers(id) & layers;
                                     return !cull::is_worth_drawing(*how.limits, box_of_object(object), object, common);
                                 }),
                  ids.end());
    {
        const world::TraceZone part(options.trace, "view: draw occluders");
        result.buffer->draw(occluders.set(), ids, view, executor);
    }
    const world::TraceZone part(options.trace, "view: what is not hidden");
    occlude::find_visible(index.tree(), index.moving(), *result.buffer, result.visible,
                          {.layer_mask = layers,
                           .mode = how.mode,
                           .limits = how.limits,
                           .candidate_mask = how.candidate_mask,
                           .mask_moving = how.mask_moving});
    world::trace_count(options.trace, "objects not hidden", result.visible.size());
}

Result<void> World::check_receivers(const ViewRequest& request, const ViewResult* visible, std::uint64_t item) const {
    if (!request.receivers) return {};
    const auto refuse = [&](const char* why) { return fail(ErrorCode::invalid_argument, item, why); };
    const ViewResult* const seen = request.receivers->seen;
    if (!request.picture) return refuse("view: receivers need a `picture`, the shadow map");
    if (seen == nullptr || !seen->has_picture() || seen->names_ != &state_->table.names)
        return refuse("view: receivers need the answer to a view of this World with a picture");
    if (seen->revision_ != state_->revision)
        return refuse("view: the World has changed since the view that `receivers` has the answer to: view it again");
    if (seen == visible) return refuse("view: a light's answer cannot replace that of its receivers");
    if (request.picture->samples != 1)
        return fail(ErrorCode::out_of_range, item, "view: a shadow map has 1 sample per texel");
    if (!depth::DepthReceivers::has_radius(request.receivers->radius))
        return fail(ErrorCode::out_of_range, item, "view: the radius of lookups is 0.5 to 1,024 texels");
    return {};
}

Result<void> World::view(const ViewRequest& request, ViewResult& visible, Executor& executor) const {
    if (auto updated = state_->check_updated(); !updated) return updated;
    const State::Call call(*state_, false);
    const auto eye = eye_of(request, kNoItem);
    if (!eye) return eye.error();
    if (auto good = check_receivers(request, &visible, kNoItem); !good) return good;
    view_own(request, *eye, visible, executor);
    if (!state_->regions.is_empty()) add_regions(request, eye->plain, visible, executor);
    return {};
}

void World::view_own(const ViewRequest& request, const world::Eye& eye, ViewResult& visible, Executor& executor) const {
    visible.with_regions_ = false;
    cull::CullOptions how{request.mode, request.order, request.limits, {}};
    how.candidate_mask = state_->candidates_and_changed(request.candidate_mask, visible.candidates_);
    how.mask_moving = true;  // those that have moved are in the mask
    if (!request.occlusion) {
        const world::TraceZone zone(state_->options.trace, "World::view");
        visible.names_ = &state_->table.names;
        visible.revision_ = state_->revision;
        visible.hides_ = false;
        cull::find_visible(state_->index.tree(), state_->index.moving(), eye.plain, visible.set_, how, executor);
        world::trace_count(state_->options.trace, "objects in view", visible.set_.size());
        if (!request.picture) return;
        if (!visible.occluded_) visible.occluded_ = world::make_occluded_view();
        if (!state_->regions.is_empty()) return;  // the picture is of regions' objects as well
        state_->find_triangles(request, {visible.set_.ids(), visible.set_.verdicts(), visible.set_.inside_count()},
                               *visible.occluded_, executor);
        visible.hides_ = true;
        return;
    }
    if (!visible.occluded_) visible.occluded_ = world::make_occluded_view();
    world::OccludedView& result = *visible.occluded_;
    result.by_picture = false;
    result.resize(request.occlusion->size);
    state_->draw_and_ask(eye.occluding, *request.occlusion, request.layers, how, executor, result);
    visible.names_ = &state_->table.names;
    visible.revision_ = state_->revision;
    visible.hides_ = true;
    result.occluded.clear();
    result.by_tree = request.order == cull::ResultOrder::tree;
    if (!request.occlusion->list_occluded && !result.by_tree) return;
    cull::find_visible(state_->index.tree(), state_->index.moving(), eye.plain, visible.set_, how, executor);
    result.split(visible.set_, state_->index.size());
    if (!request.occlusion->list_occluded) result.occluded.clear();
}

Result<void> World::view(std::span<const ViewRequest> requests, MultiViewResult& visible, Executor& executor) const {
    if (auto updated = state_->check_updated(); !updated) return updated;
    const State::Call call(*state_, false);
    if (auto few = cull::check_view_count(requests.size()); !few) return few;
    std::array<Eye, cull::kMaxViews> eyes;
    for (std::size_t v = 0; v < requests.size(); ++v) {
        const auto eye = eye_of(requests[v], v);
        if (!eye) return eye.error();
        if (auto good = check_receivers(requests[v], nullptr, v); !good) return good;
        eyes[v] = *eye;
        if (requests[v].order != requests[0].order)
            return fail(ErrorCode::invalid_argument, v, "view: the views of one call are listed in one order");
    }
    const std::span<const Eye> of_requests = std::span(eyes).first(requests.size());
    if (auto own = view_own(requests, of_requests, visible, executor); !own) return own;
    visible.with_regions_ = false;
    if (!state_->regions.is_empty()) add_regions(requests, of_requests, visible);
    return {};
}

Result<void> World::view_own(std::span<const ViewRequest> requests, std::span<const world::Eye> eyes,
                             MultiViewResult& visible, Executor& executor) const {
    std::array<cull::View, cull::kMaxViews> volumes;
    for (std::size_t v = 0; v < eyes.size(); ++v) volumes[v] = eyes[v].plain;
    const std::span<const cull::View> views = std::span(volumes).first(requests.size());
    const bool ascending = requests.empty() || requests[0].order == cull::ResultOrder::ascending;
    const bool shared_out = ascending && requests.size() > 1 && executor.concurrency() > 1;
    const bool one_walk = fit_one_walk(requests) && !shared_out;
    visible.forget_ids();
    const std::size_t objects = state_->index.size();
    if (visible.masks_.size() < objects) visible.masks_.resize(objects, 0);
    visible.bits_.assign((objects + 63) / 64, 0);
    if (one_walk) {
        const world::TraceZone zone(state_->options.trace, "World::view of many");
        const ViewRequest& first = requests.empty() ? ViewRequest() : requests[0];
        const auto walked = cull::find_visible(state_->index.tree(), state_->index.moving(), views, visible.set_,
                                               first.mode, first.limits);
        if (!walked) return walked;
        for (std::size_t i = 0; ascending && i < visible.set_.size(); ++i)
            visible.add(visible.set_.ids()[i], visible.set_.view_mask(i));
    } else {
        view_each(requests, eyes, visible, executor);
    }
    visible.names_ = &state_->table.names;
    visible.view_count_ = requests.size();
    visible.one_walk_ = one_walk;
    visible.listed_ = ascending || !one_walk;
    if (ascending) visible.list_ascending();
    if (ascending || one_walk) return {};
    // In the order of a walk that finds all of them, and some more.
    const auto walked = cull::find_visible(state_->index.tree(), state_->index.moving(), views, visible.set_,
                                           cull::CullMode::conservative);
    if (!walked) return walked;
    for (const std::uint32_t id : visible.set_.ids())
        if (visible.masks_[id] != 0) visible.ids_.push_back(id);
    return {};
}

// Every request by itself. Buffers are made first, so that threads that share the requests make none. A picture has
// regions' objects in it from the beginning.
void World::view_each(std::span<const ViewRequest> requests, std::span<const world::Eye> eyes, MultiViewResult& visible,
                      Executor& executor) const {
    while (visible.each_.size() < requests.size()) visible.each_.emplace_back();
    for (std::size_t v = 0; v < requests.size(); ++v) {
        if (!requests[v].occlusion) continue;
        if (!visible.each_[v].occluded_) visible.each_[v].occluded_ = world::make_occluded_view();
        visible.each_[v].occluded_->resize(requests[v].occlusion->size);
    }
    const bool has_regions = !state_->regions.is_empty();
    executor.parallel_for(requests.size(), 1, [&](std::size_t begin, std::size_t end, unsigned) {
        const State::Call call(*state_, false);
        for (std::size_t v = begin; v < end; ++v) {
            const bool with_regions = has_regions && requests[v].picture;
            ViewRequest request = requests[v];
            request.order = request.occlusion || with_regions ? cull::ResultOrder::ascending
                                                              : cull::ResultOrder::tree;  // the quicker one
            view_own(request, eyes[v], visible.each_[v], serial_executor());
            if (with_regions) add_regions(request, eyes[v].plain, visible.each_[v], serial_executor());
        }
    });
    for (std::size_t v = 0; v < requests.size(); ++v)
        for (const std::uint32_t id : visible.each_[v].ids())
            if (id < kFirstRegionIndex) visible.add(id, std::uint32_t{1} << v);
}

void MultiViewResult::forget_ids() {
    for (const std::uint32_t id : ids_) masks_[id] = 0;
    ids_.clear();
}

void MultiViewResult::add(std::uint32_t id, std::uint32_t views) {
    masks_[id] |= views;
    bits_[id / 64] |= std::uint64_t{1} << (id % 64);
}

void MultiViewResult::list_ascending() {
    for (std::size_t w = 0; w < bits_.size(); ++w)
        for (std::uint64_t rest = bits_[w]; rest != 0; rest &= rest - 1)
            ids_.push_back(static_cast<std::uint32_t>(64 * w) + static_cast<std::uint32_t>(std::countr_zero(rest)));
}

std::span<const std::uint32_t> MultiViewResult::occluded_ids(std::size_t view) const {
    return view < view_count_ && !one_walk_ ? each_[view].occluded_ids() : std::span<const std::uint32_t>();
}

depth::DepthStatistics MultiViewResult::picture_statistics(std::size_t view) const {
    return view < view_count_ && !one_walk_ ? each_[view].picture_statistics() : depth::DepthStatistics();
}

std::span<const depth::VisibleCluster> MultiViewResult::triangles(std::size_t view) const {
    return view < view_count_ && !one_walk_ ? each_[view].triangles() : std::span<const depth::VisibleCluster>();
}

OcclusionStatistics MultiViewResult::occlusion_statistics(std::size_t view) const {
    return view < view_count_ && !one_walk_ ? each_[view].occlusion_statistics() : OcclusionStatistics();
}

const occlude::OcclusionBuffer* MultiViewResult::occlusion_buffer(std::size_t view) const {
    return view < view_count_ && !one_walk_ ? each_[view].occlusion_buffer() : nullptr;
}

}  // namespace crofton
