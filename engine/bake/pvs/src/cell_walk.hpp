// SPDX-License-Identifier: MIT
// Finds the cells that a line passes through, and where along it.
#pragma once
#include <crofton/core/memory.hpp>
#include <crofton/geometry/shapes.hpp>
#include <crofton/pvs/pvs.hpp>
#include <cstdint>
#include <optional>
#include <span>

#include "box_voxels.hpp"
#include "walk_kernels.hpp"

namespace crofton::pvs {

struct CellSpan {
    std::uint32_t cell = 0;
    double begin = 0.0, end = 0.0;  // along the line, from its point; begin ≤ end
};

// One thread's memory.
struct CellSpans {
    Vector<CellSpan> all;
    Vector<std::uint64_t> asked;  // by cell: the last line that asked it
    std::uint64_t line = 0;
};

// How some lines pass through voxels: line i enters the first at start.begin[i], and leaves voxel steps[n].voxel[i] for
// the next at steps[n].end[i], n < start.steps[i].
struct VoxelPaths {
    static constexpr std::size_t kLines = kernels::kWalkLanes;
    kernels::WalkStart start;
    Vector<kernels::WalkStep> steps = Vector<kernels::WalkStep>(64);

    [[nodiscard]] std::size_t count(std::size_t line) const { return static_cast<std::size_t>(start.steps[line]); }
};

// Cells relative to an origin. Those of the caller's are listed in the voxels of a grid.
class CellWalk {
  public:
    CellWalk(const Cells& cells, const glm::dvec3& origin);

    // The voxels of kLines lines, each once, but for those that a line grazes within rounding.
    void pass(std::span<const Line> lines, VoxelPaths& paths) const;
    // Whether voxels are the cells.
    [[nodiscard]] bool is_grid() const { return boxes_.empty(); }
    // Cells of the caller's: replaces spans.all by all that the line meets, each once, in any order. `number`: the
    // line's among those of the paths.
    void find(const Line& line, const VoxelPaths& paths, std::size_t number, CellSpans& spans) const;

  private:
    void set_grid(const Aabb& bounds, const std::uint32_t (&counts)[3]);

    kernels::VoxelGrid grid_;
    Vector<Aabb> boxes_;               // empty: the voxels are the cells
    std::optional<BoxVoxels> voxels_;  // of the boxes
    // The planes of convex cells, which are where all are at least 0.
    Vector<Plane> planes_;
    Vector<std::uint32_t> plane_ends_;
};

// Where the line is in the box: begin ≤ end, or none.
[[nodiscard]] bool clip(const Line& line, const Aabb& box, double& begin, double& end);
// Clips the interval to the planes.
[[nodiscard]] bool clip(const Line& line, std::span<const Plane> planes, double& begin, double& end);

}  // namespace crofton::pvs
