// SPDX-License-Identifier: MIT
#include "occluded_view.hpp"

#include <algorithm>
#include <bit>
#include <crofton/core/recovery.hpp>
#include <crofton/cull/cull.hpp>

namespace crofton {

namespace world {

OccludedViewOwner make_occluded_view() {
    return OccludedViewOwner(Owner<OccludedView>::make().release());
}

void OccludedViewDeleter::operator()(OccludedView* view) const {
    Destroy<OccludedView>()(view);
}

void OccludedView::resize(const occlude::BufferSize& size) {
    if (buffer && buffer->size().width == size.width && buffer->size().height == size.height) return;
    buffer = detail::value_or_give_up(occlude::OcclusionBuffer::create(size));
}

void OccludedView::split(const cull::VisibleSet& in_frustum, std::size_t count) {
    cull::to_bits(visible.ids(), count, bits);
    in_order.clear();
    for (std::size_t i = 0; i < in_frustum.size(); ++i) {
        if (i == in_frustum.inside_count()) inside_in_order = in_order.size();
        const std::uint32_t id = in_frustum.ids()[i];
        (bits[id / 64] >> (id % 64) & 1 ? in_order : occluded).push_back(id);
    }
    if (in_frustum.inside_count() == in_frustum.size()) inside_in_order = in_order.size();
    std::sort(occluded.begin(), occluded.end());
}

OcclusionStatistics OccludedView::statistics() const {
    return {static_cast<std::uint32_t>(choice.ids.size()), buffer->statistics(), visible.statistics()};
}

}  // namespace world

std::span<const std::uint32_t> ViewResult::seen_ids() const {
    if (occluded_->by_picture) return occluded_->picture.ids();
    return occluded_->by_tree ? std::span<const std::uint32_t>(occluded_->in_order) : occluded_->visible.ids();
}

std::size_t ViewResult::seen_inside_count() const {
    if (occluded_->by_picture) return occluded_->picture.inside_count();
    return occluded_->by_tree ? occluded_->inside_in_order : occluded_->visible.inside_count();
}

std::span<const cull::Verdict> ViewResult::seen_verdicts() const {
    if (occluded_->by_picture) return occluded_->picture.verdicts();
    return occluded_->by_tree ? std::span<const cull::Verdict>() : occluded_->visible.verdicts();
}

std::span<const std::uint32_t> ViewResult::occluded_ids() const {
    if (with_regions_) return whole_occluded_ids();
    return has_occlusion() ? std::span<const std::uint32_t>(occluded_->occluded) : std::span<const std::uint32_t>();
}

// Searches lists in tree order one by one.
occlude::Verdict ViewResult::verdict_of(std::uint32_t index) const {
    if (index >= kFirstRegionIndex) return region_verdict_of(index);
    const bool by_occluders = has_occlusion();
    const auto listed = by_occluders ? occluded_->visible.ids() : ids(), hidden = occluded_ids();
    const auto seen = by_occluders ? occluded_->visible.verdicts() : verdicts();
    const bool ascending = by_occluders || (!seen.empty() && !has_picture());
    const auto place = ascending ? std::lower_bound(listed.begin(), listed.end(), index)
                                 : std::find(listed.begin(), listed.end(), index);
    if (place != listed.end() && *place == index) {
        const auto at = static_cast<std::size_t>(place - listed.begin());
        if (!seen.empty()) return static_cast<occlude::Verdict>(seen[at]);
        return at < inside_count() ? occlude::Verdict::inside : occlude::Verdict::straddling;
    }
    return std::binary_search(hidden.begin(), hidden.end(), index) ? occlude::Verdict::occluded
                                                                   : occlude::Verdict::outside;
}

OcclusionStatistics ViewResult::occlusion_statistics() const {
    if (with_regions_) return whole_occlusion_statistics();
    return has_occlusion() ? occluded_->statistics() : OcclusionStatistics();
}

const occlude::OcclusionBuffer* ViewResult::occlusion_buffer() const {
    return has_occlusion() ? &*occluded_->buffer : nullptr;
}

bool ViewResult::has_picture() const {
    return hides_ && occluded_->by_picture;
}

std::span<const depth::VisibleCluster> ViewResult::triangles() const {
    return has_picture() ? occluded_->picture.triangles() : std::span<const depth::VisibleCluster>();
}

depth::DepthStatistics ViewResult::picture_statistics() const {
    return has_picture() ? occluded_->picture.statistics() : depth::DepthStatistics();
}

}  // namespace crofton
