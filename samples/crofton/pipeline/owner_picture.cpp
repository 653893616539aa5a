// SPDX-License-Identifier: MIT
#include "owner_picture.hpp"

#include <algorithm>

namespace crofton::pipeline {

Result<void> OwnerPicture::draw(render::Rasterizer& rasterizer, std::uint32_t picture, const DrawList& list,
                                const Camera& camera) {
    render::Frame frame;
    frame.camera = camera;
    frame.transforms = list.transforms();
    frame.ranges = list.ranges();
    if (auto drawn = rasterizer.draw_owners(frame, owners_, picture); !drawn) return drawn;
    std::size_t total = 0;
    for (const render::DrawRange& range : frame.ranges) total += range.index_count / 3;
    seen_.assign(total, 0);
    for (const std::uint32_t owner : owners_)
        if (owner != render::kNoTriangle) seen_[owner] = 1;
    triangles_.clear();
    auto next = seen_.begin();
    for (std::size_t r = 0; r < frame.ranges.size(); ++r)
        for (std::uint32_t t = 0; t < frame.ranges[r].index_count / 3; ++t)
            if (*next++ != 0) triangles_.push_back({list.instance_of(r), frame.ranges[r].first_index / 3 + t});
    std::sort(triangles_.begin(), triangles_.end());
    instances_.clear();
    for (const OwnerTriangle& owner : triangles_)
        if (instances_.empty() || instances_.back() != owner.instance) instances_.push_back(owner.instance);
    return {};
}

}  // namespace crofton::pipeline
