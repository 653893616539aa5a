// SPDX-License-Identifier: MIT
// The walk of lines through the voxels of a grid, eight at a time, on plain doubles (no GLM here: see
// docs/architecture.md on vector kernels).
#pragma once
#include <cstddef>
#include <cstdint>

namespace crofton::pvs::kernels {

inline constexpr std::size_t kWalkLanes = 8;

struct VoxelGrid {
    double min[3] = {}, max[3] = {};
    double width[3] = {}, per_length[3] = {};  // of a voxel; voxels to a unit of length
    double counts[3] = {1.0, 1.0, 1.0}, strides[3] = {1.0, 1.0, 1.0};
};

// The step after which each line has passed through one voxel more.
struct alignas(32) WalkStep {
    double end[kWalkLanes];  // along the line, from its point; never decreases
    std::uint32_t voxel[kWalkLanes];
};
struct alignas(64) WalkStart {
    double begin[kWalkLanes];  // where the line enters the grid
    double steps[kWalkLanes];  // voxels passed, 0 where it misses the grid
};

// kWalkLanes lines of six doubles each, point and direction. False: `most` steps are not enough, give more. The same
// bits for any instruction set.
[[nodiscard]] bool walk(const VoxelGrid& grid, const double* lines, WalkStart& start, WalkStep* steps,
                        std::size_t most);

}  // namespace crofton::pvs::kernels
