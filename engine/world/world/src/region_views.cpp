// SPDX-License-Identifier: MIT
// Views of a World that regions are attached to: its own objects', then the regions'.
#include <algorithm>

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

namespace {

template <class T>
void join(Vector<T>& all, std::span<const T> first, std::span<const T> second) {
    all.assign(first.begin(), first.end());
    all.insert(all.end(), second.begin(), second.end());
}

// Two lists, of each of which so many are to come before the rest of both.
void join_parts(Vector<std::uint32_t>& all, std::span<const std::uint32_t> a, std::size_t a_first,
                std::span<const std::uint32_t> b, std::size_t b_first) {
    join(all, a.first(a_first), b.first(b_first));
    for (const auto rest : {a.subspan(a_first), b.subspan(b_first)}) all.insert(all.end(), rest.begin(), rest.end());
}

}  // namespace

void World::find_in_regions(const ViewRequest& request, const cull::View& view, ViewResult& visible) const {
    const world::TraceZone zone(state_->options.trace, "view: regions");
    if (!visible.whole_) visible.whole_ = world::WholeViewOwner(Owner<world::WholeView>::make().release());
    const bool lists_occluded = request.occlusion && request.occlusion->list_occluded;
    state_->regions.find_visible({view, request.mode, request.order, request.limits,
                                  request.occlusion ? visible.occlusion_buffer() : nullptr, lists_occluded},
                                 visible.whole_->of_regions);
}

void World::add_regions(const ViewRequest& request, const cull::View& view, ViewResult& visible) const {
    find_in_regions(request, view, visible);
    world::WholeView& whole = *visible.whole_;
    const world::RegionView& found = whole.of_regions;
    join<std::uint32_t>(whole.occluded, visible.occluded_ids(), found.occluded);
    whole.statistics = visible.statistics();
    whole.statistics += found.statistics;
    whole.occlusion = visible.occlusion_statistics();
    whole.occlusion.asked.items_tested += found.asked.items_tested;
    whole.occlusion.asked.items_hidden += found.asked.items_hidden;
    if (visible.verdicts().empty() && request.order == cull::ResultOrder::tree)
        join_parts(whole.ids, visible.ids(), visible.inside_count(), found.ids, found.inside_count);
    else
        join<std::uint32_t>(whole.ids, visible.ids(), found.ids);
    join<cull::Verdict>(whole.verdicts, visible.verdicts(), found.verdicts);
    whole.inside_count = visible.inside_count() + found.inside_count;
    visible.with_regions_ = true;
}

void World::add_regions(std::span<const cull::View> views, MultiViewResult& visible) const {
    if (!visible.whole_) visible.whole_ = world::WholeViewsOwner(Owner<world::WholeViews>::make().release());
    world::WholeViews& whole = *visible.whole_;
    whole.ids.clear();
    whole.masks.clear();
    for (std::size_t i = 0; i < visible.size(); ++i) {
        whole.ids.push_back(visible.ids()[i]);
        whole.masks.push_back(visible.view_mask(i));
    }
    // Region by region, so that a mask for each of its objects is enough.
    const auto ids_of = [&](std::size_t v) -> Vector<std::uint32_t>& {
        return visible.each_[v].whole_->of_regions.ids;
    };
    for (std::size_t v = 0; v < views.size(); ++v)
        if (!std::is_sorted(ids_of(v).begin(), ids_of(v).end())) std::sort(ids_of(v).begin(), ids_of(v).end());
    std::size_t next[cull::kMaxViews] = {};
    const auto first_left = [&] {
        std::uint32_t least = kNoIndex;
        for (std::size_t v = 0; v < views.size(); ++v)
            if (next[v] < ids_of(v).size()) least = std::min(least, ids_of(v)[next[v]]);
        return least;
    };
    for (std::uint32_t id = first_left(); id != kNoIndex; id = first_left()) {
        const world::Attachment& region = state_->regions.of(id);
        whole.object_masks.assign(region.size(), 0);
        for (std::size_t v = 0; v < views.size(); ++v) {
            const Vector<std::uint32_t>& ids = ids_of(v);
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
    return whole_->ids;
}
std::size_t ViewResult::whole_inside_count() const {
    return whole_->inside_count;
}
std::span<const cull::Verdict> ViewResult::whole_verdicts() const {
    return whole_->verdicts;
}
std::span<const std::uint32_t> ViewResult::whole_occluded_ids() const {
    return whole_->occluded;
}
const cull::Statistics& ViewResult::whole_statistics() const {
    return whole_->statistics;
}
OcclusionStatistics ViewResult::whole_occlusion_statistics() const {
    return whole_->occlusion;
}

// Of an object of a region: ids are ascending or, in tree order, searched one by one.
occlude::Verdict ViewResult::region_verdict_of(std::uint32_t index) const {
    if (!with_regions_) return occlude::Verdict::outside;
    const world::RegionView& found = whole_->of_regions;
    const auto at = std::find(found.ids.begin(), found.ids.end(), index);
    if (at != found.ids.end()) {
        const auto place = static_cast<std::size_t>(at - found.ids.begin());
        if (!found.verdicts.empty()) return static_cast<occlude::Verdict>(found.verdicts[place]);
        return place < found.inside_count ? occlude::Verdict::inside : occlude::Verdict::straddling;
    }
    return std::binary_search(found.occluded.begin(), found.occluded.end(), index) ? occlude::Verdict::occluded
                                                                                   : occlude::Verdict::outside;
}

std::span<const std::uint32_t> MultiViewResult::whole_ids() const {
    return whole_->ids;
}
std::uint32_t MultiViewResult::whole_mask(std::size_t i) const {
    return whole_->masks[i];
}

}  // namespace crofton
