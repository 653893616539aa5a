// SPDX-License-Identifier: MIT
// A view's depth buffer, the occluders that were drawn, and what was found.
#pragma once
#include <crofton/occlude/occlusion.hpp>
#include <crofton/world/answers.hpp>
#include <optional>

namespace crofton::world {

// Kept from frame to frame.
struct OccludedView {
    std::optional<occlude::OcclusionBuffer> buffer;
    occlude::OccluderChoice choice;
    occlude::VisibleSet visible;
    Vector<std::uint32_t> occluded;

    // A buffer of this size, new where it was another. Errors: as OcclusionBuffer::create.
    [[nodiscard]] Result<void> resize(const occlude::BufferSize& size);
    // Those of `in_frustum`, ascending, that are not visible.
    void list_occluded(std::span<const std::uint32_t> in_frustum);
    [[nodiscard]] OcclusionStatistics statistics() const;
};

[[nodiscard]] OccludedViewOwner make_occluded_view();

}  // namespace crofton::world
