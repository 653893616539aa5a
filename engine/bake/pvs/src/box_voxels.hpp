// SPDX-License-Identifier: MIT
// Finds boxes by place: a grid of voxels with a list each.
#pragma once
#include <crofton/core/memory.hpp>
#include <crofton/geometry/box.hpp>
#include <cstdint>
#include <span>

namespace crofton::pvs {

struct BoxVoxels {
    BoxVoxels(std::span<const Aabb> boxes, const Aabb& bounds);

    // The boxes, ascending, that may hold a point of the voxel.
    [[nodiscard]] std::span<const std::uint32_t> boxes_in(std::size_t voxel) const {
        return std::span(listed).subspan(first[voxel], first[voxel + 1] - first[voxel]);
    }
    // The same of a point's voxel; of points outside of the bounds the nearest one's.
    [[nodiscard]] std::span<const std::uint32_t> boxes_near(const glm::dvec3& point) const;

    Aabb bounds;
    std::uint32_t counts[3] = {1, 1, 1};
    Vector<std::uint32_t> first, listed;  // by voxel, the range of boxes that meet it
};

}  // namespace crofton::pvs
