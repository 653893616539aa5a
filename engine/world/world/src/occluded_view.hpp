// SPDX-License-Identifier: MIT
// A view's data about hidden objects: a depth buffer, the drawn occluders and the results; or a picture's
// triangles.
#pragma once
#include <crofton/occlude/occlusion.hpp>
#include <crofton/world/answers.hpp>
#include <optional>

#include "picture_view.hpp"

namespace crofton::world {

// Kept from frame to frame.
struct OccludedView {
    std::optional<occlude::OcclusionBuffer> buffer;
    occlude::OccluderChoice choice;
    occlude::VisibleSet visible;
    Vector<std::uint32_t> occluded;
    Vector<std::uint32_t> in_order;  // those that are visible, in the tree's order
    std::size_t inside_in_order = 0;
    bool by_tree = false;     // asked for in the tree's order
    bool by_picture = false;  // `picture` has the answer
    PictureView picture;
    Vector<std::uint64_t> bits;  // scratch

    // A buffer of this size, new where it was another. Requires a valid size.
    void resize(const occlude::BufferSize& size);
    // Tells those of the frustum's query that are visible, in their order there, from those that are not, ascending.
    // Objects are below `count`.
    void split(const cull::VisibleSet& in_frustum, std::size_t count);
    [[nodiscard]] OcclusionStatistics statistics() const;
};

[[nodiscard]] OccludedViewOwner make_occluded_view();

}  // namespace crofton::world
