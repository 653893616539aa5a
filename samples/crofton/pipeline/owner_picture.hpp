// SPDX-License-Identifier: MIT
// The triangles and instances that own a pixel of a picture.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/render/rasterizer.hpp>
#include <cstdint>
#include <span>
#include <vector>

#include "draw_list.hpp"

namespace crofton::pipeline {

// A triangle of an instance; `triangle` is its place in the list's indices, which does not depend on what is selected.
struct OwnerTriangle {
    scene::InstanceId instance = 0;
    std::uint32_t triangle = 0;
    auto operator<=>(const OwnerTriangle&) const = default;
};

class OwnerPicture {
  public:
    // Draws what `list` has selected for this camera into picture `picture` of the rasterizer, which has the list's
    // geometry. Errors: the rasterizer's.
    [[nodiscard]] Result<void> draw(render::Rasterizer& rasterizer, std::uint32_t picture, const DrawList& list,
                                    const Camera& camera);
    // Returns the instances that own a pixel, ascending.
    [[nodiscard]] std::span<const scene::InstanceId> instances() const { return instances_; }
    [[nodiscard]] std::span<const OwnerTriangle> triangles() const { return triangles_; }

  private:
    Vector<std::uint32_t> owners_;    // by pixel
    std::vector<std::uint8_t> seen_;  // by triangle, as the ranges count them
    std::vector<scene::InstanceId> instances_;
    std::vector<OwnerTriangle> triangles_;
};

}  // namespace crofton::pipeline
