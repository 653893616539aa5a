// SPDX-License-Identifier: MIT
// Views of a World with attached regions: first its own objects, then those of regions.
#include <algorithm>

#include "eye.hpp"
#include "occluded_view.hpp"
#include "region_view.hpp"
#include "trace_zone.hpp"
#include "world_state.hpp"

namespace crofton {

namespace world {

void WholeViewDeleter::operator()(WholeView* view) const {
    Destroy<WholeView>()(view);
}
void WholeViewsDeleter::operator()(WholeViews* views) const {
    Destroy<WholeViews>()(views);
}

ObjectRef region_ref(const ObjectNames& names, std::uint32_t index) {
    return names.regions->ref(index);
}

}  // namespace world

void World::add_regions(const ViewRequest& request, const cull::View& view, ViewResult& visible,
                        Executor& executor) const {
    if (!visible.whole_) visible.whole_ = world::WholeViewOwner(Owner<world::WholeView>::make().release());
    world::WholeView& whole = *visible.whole_;
    whole.clear();
    whole.inside_count = visible.inside_count();
    const bool by_tree = visible.verdicts().empty() && request.order == cull::ResultOrder::tree;
    const std::span<const std::uint32_t> own = visible.ids();
    whole.ids.add(by_tree ? own.first(whole.inside_count) : own);
    if (by_tree) whole.straddling.add(own.subspan(whole.inside_count));
    whole.verdicts.add(visible.verdicts());
    find_in_regions(request, view, visible);
    if (request.picture) keep_in_picture(request, visible, executor);
}

// Of an answer that has all that the frustum sees.
void World::keep_in_picture(const ViewRequest& request, ViewResult& visible, Executor& executor) const {
    world::WholeView& whole = *visible.whole_;
    world::OccludedView& result = *visible.occluded_;
    state_->find_triangles(request, {whole.ids.values(), whole.verdicts.values(), whole.inside_count}, result,
                           executor);
    whole.ids.clear();
    whole.verdicts.clear();
    whole.ids.add(result.picture.ids());
    whole.verdicts.add(result.picture.verdicts());
    whole.inside_count = result.picture.inside_count();
    visible.hides_ = true;
}

void World::find_in_regions(const ViewRequest& request, const cull::View& view, ViewResult& visible) const {
    const world::TraceZone zone(state_->options.trace, "view: regions");
    world::WholeView& whole = *visible.whole_;
    whole.statistics = visible.statistics();
    whole.occlusion = visible.occlusion_statistics();
    whole.occluded.add(visible.occluded_ids());
    const bool lists_occluded = request.occlusion && request.occlusion->list_occluded;
    state_->regions.find_visible(
        {view, request.mode, request.order, request.limits, visible.occlusion_buffer(), lists_occluded}, whole);
    visible.with_regions_ = true;
}

void World::add_regions(std::span<const ViewRequest> requests, std::span<const world::Eye> eyes,
                        MultiViewResult& visible) const {
    if (!visible.whole_) visible.whole_ = world::WholeViewsOwner(Owner<world::WholeViews>::make().release());
    while (visible.each_.size() < requests.size()) visible.each_.emplace_back();
    for (std::size_t v = 0; v < requests.size(); ++v) {
        if (requests[v].picture) continue;  // view_each() has added them
        ViewResult& each = visible.each_[v];
        if (!each.whole_) each.whole_ = world::WholeViewOwner(Owner<world::WholeView>::make().release());
        if (visible.one_walk_) each.hides_ = each.with_regions_ = false;  // what it has is of an earlier call
        each.whole_->clear();
        ViewRequest request = requests[v];
        request.order = cull::ResultOrder::ascending;
        find_in_regions(request, eyes[v].plain, each);
    }
    world::WholeViews& whole = *visible.whole_;
    whole.ids.clear();
    whole.masks.clear();
    for (std::size_t i = 0; i < visible.size(); ++i) {
        whole.ids.push_back(visible.ids()[i]);
        whole.masks.push_back(visible.view_mask(i));
    }
    // Region by region, so that a mask for each of its objects is enough.
    const auto ids_of = [&](std::size_t v) { return visible.each_[v].whole_->ids.values(); };
    std::size_t next[cull::kMaxViews] = {};
    for (std::size_t v = 0; v < requests.size(); ++v)
        while (next[v] < ids_of(v).size() && ids_of(v)[next[v]] < kFirstRegionIndex) ++next[v];
    const auto first_left = [&] {
        std::uint32_t least = kNoIndex;
        for (std::size_t v = 0; v < requests.size(); ++v)
            if (next[v] < ids_of(v).size()) least = std::min(least, ids_of(v)[next[v]]);
        return least;
    };
    for (std::uint32_t id = first_left(); id != kNoIndex; id = first_left()) {
        const world::Attachment& region = state_->regions.of(id);
        whole.object_masks.assign(region.size(), 0);
        for (std::size_t v = 0; v < requests.size(); ++v) {
            const std::span<const std::uint32_t> ids = ids_of(v);
            for (; next[v] < ids.size() && ids[next[v]] - region.first < region.size(); ++next[v])
                whole.object_masks[ids[next[v]] - region.first] |= std::uint32_t{1} << v;
        }
        for (std::uint32_t item = 0; item < region.size(); ++item) {
            if (whole.object_masks[item] == 0) continue;
            whole.ids.push_back(region.first + item);
            whole.masks.push_back(whole.object_masks[item]);
        }
    }
    visible.with_regions_ = true;
}

std::span<const std::uint32_t> ViewResult::whole_ids() const {
    return whole_->ids.values();
}
std::size_t ViewResult::whole_inside_count() const {
    return whole_->inside_count;
}
std::span<const cull::Verdict> ViewResult::whole_verdicts() const {
    return whole_->verdicts.values();
}
std::span<const std::uint32_t> ViewResult::whole_occluded_ids() const {
    return whole_->occluded.values();
}
const cull::Statistics& ViewResult::whole_statistics() const {
    return whole_->statistics;
}
OcclusionStatistics ViewResult::whole_occlusion_statistics() const {
    return whole_->occlusion;
}

// Finds an object of a region. Searches ids in tree order one by one.
occlude::Verdict ViewResult::region_verdict_of(std::uint32_t index) const {
    if (!with_regions_) return occlude::Verdict::outside;
    const std::span<const std::uint32_t> listed = ids(), hidden = occluded_ids();
    const bool ascending = !verdicts().empty();
    const auto at = ascending ? std::lower_bound(listed.begin(), listed.end(), index)
                              : std::find(listed.begin(), listed.end(), index);
    if (at != listed.end() && *at == index) {
        const auto place = static_cast<std::size_t>(at - listed.begin());
        if (ascending) return static_cast<occlude::Verdict>(verdicts()[place]);
        return place < inside_count() ? occlude::Verdict::inside : occlude::Verdict::straddling;
    }
    return std::binary_search(hidden.begin(), hidden.end(), index) ? occlude::Verdict::occluded
                                                                   : occlude::Verdict::outside;
}

std::span<const std::uint32_t> MultiViewResult::whole_ids() const {
    return whole_->ids;
}
std::uint32_t MultiViewResult::whole_mask(std::size_t i) const {
    return whole_->masks[i];
}

}  // namespace crofton
