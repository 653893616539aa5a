// SPDX-License-Identifier: MIT
// Which cells a line passes through, and where along it.
#pragma once
#include <crofton/core/memory.hpp>
#include <crofton/geometry/shapes.hpp>
#include <crofton/pvs/pvs.hpp>
#include <cstdint>
#include <optional>
#include <span>

#include "box_voxels.hpp"

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

// Cells relative to an origin. Those of the caller's are listed in the voxels of a grid.
class CellWalk {
  public:
    CellWalk(const Cells& cells, const glm::dvec3& origin);

    // Replaces spans.all by all cells that the line meets, each once, but for those that it grazes within rounding. Of
    // a grid along the line; cells of the caller's come in any order.
    void find(const Line& line, CellSpans& spans) const;

  private:
    template <class Visit>
    void walk(const Line& line, Visit&& visit) const;

    void set_steps();

    Aabb bounds_;
    std::uint32_t counts_[3] = {1, 1, 1};
    double widths_[3] = {}, per_length_[3] = {};  // of a voxel; voxels to a unit of length
    std::int64_t last_[3] = {};
    Vector<Aabb> boxes_;               // empty: the voxels are the cells
    std::optional<BoxVoxels> voxels_;  // of the boxes
    // Of convex cells: where all are at least 0.
    Vector<Plane> planes_;
    Vector<std::uint32_t> plane_ends_;
};

// Where the line is in the box: begin ≤ end, or none.
[[nodiscard]] bool clip(const Line& line, const Aabb& box, double& begin, double& end);
// What of that lies within the planes.
[[nodiscard]] bool clip(const Line& line, std::span<const Plane> planes, double& begin, double& end);

}  // namespace crofton::pvs
