// SPDX-License-Identifier: MIT
#include "occluded_view.hpp"

#include <algorithm>
#include <crofton/core/error.hpp>

namespace crofton {

namespace world {

OccludedViewOwner make_occluded_view() {
    return OccludedViewOwner(Owner<OccludedView>::make().release());
}

void OccludedViewDeleter::operator()(OccludedView* view) const {
    Destroy<OccludedView>()(view);
}

Result<void> OccludedView::resize(const occlude::BufferSize& size) {
    if (buffer && buffer->size().width == size.width && buffer->size().height == size.height) return {};
    auto created = occlude::OcclusionBuffer::create(size);
    if (!created) return tl::unexpected(created.error());
    buffer = std::move(*created);
    return {};
}

void OccludedView::list_occluded(std::span<const std::uint32_t> in_frustum) {
    occluded.resize(in_frustum.size());
    const auto seen = visible.ids();
    const auto end =
        std::set_difference(in_frustum.begin(), in_frustum.end(), seen.begin(), seen.end(), occluded.begin());
    occluded.resize(static_cast<std::size_t>(end - occluded.begin()));
}

OcclusionStatistics OccludedView::statistics() const {
    return {static_cast<std::uint32_t>(choice.ids.size()), buffer->statistics(), visible.statistics()};
}

}  // namespace world

const occlude::VisibleSet& VisibleObjects::seen() const {
    return occluded_->visible;
}

std::span<const std::uint32_t> VisibleObjects::occluded_ids() const {
    return hides_ ? std::span<const std::uint32_t>(occluded_->occluded) : std::span<const std::uint32_t>();
}

occlude::Verdict VisibleObjects::verdict_of(std::uint32_t index) const {
    const auto seen_ids = ids(), hidden = occluded_ids();
    const auto at = std::lower_bound(seen_ids.begin(), seen_ids.end(), index);
    if (at != seen_ids.end() && *at == index)
        return static_cast<occlude::Verdict>(verdicts()[static_cast<std::size_t>(at - seen_ids.begin())]);
    return std::binary_search(hidden.begin(), hidden.end(), index) ? occlude::Verdict::occluded
                                                                   : occlude::Verdict::outside;
}

OcclusionStatistics VisibleObjects::occlusion_statistics() const {
    return hides_ ? occluded_->statistics() : OcclusionStatistics();
}

const occlude::OcclusionBuffer* VisibleObjects::occlusion_buffer() const {
    return hides_ ? &*occluded_->buffer : nullptr;
}

}  // namespace crofton
