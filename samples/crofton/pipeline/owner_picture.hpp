// SPDX-License-Identifier: MIT
// Which instances are seen in a picture: drawn with their numbers as colours.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/render/rasterizer.hpp>
#include <span>
#include <vector>

#include "draw_list.hpp"

namespace crofton::pipeline {

class OwnerPicture {
  public:
    // Instances beyond this cannot be told apart: colours have 24 bits, and one is the background's.
    static constexpr std::size_t kMaxInstances = (std::size_t{1} << 24) - 1;

    // Draws what `list` has selected for this camera into picture `picture` of the rasterizer, which has the list's
    // geometry. Errors: the rasterizer's; more instances than can be told apart.
    [[nodiscard]] Result<void> draw(render::Rasterizer& rasterizer, std::uint32_t picture, const DrawList& list,
                                    const Camera& camera);
    // That own a pixel, ascending.
    [[nodiscard]] std::span<const scene::InstanceId> owners() const { return owners_; }

  private:
    std::vector<render::DrawRange> ranges_;
    std::vector<render::DrawTransform> transforms_;
    std::vector<scene::InstanceId> owners_;
    render::Image image_;
};

}  // namespace crofton::pipeline
