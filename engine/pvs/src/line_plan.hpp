// SPDX-License-Identifier: MIT
// How many lines a guarantee needs, and line by line where each is.
#pragma once
#include <crofton/pvs/pvs.hpp>
#include <crofton/sampling/sampling.hpp>

namespace crofton::pvs {

// Independent uniform lines in blocks. `whole`: through the box around all cells. Otherwise `per_cell` blocks through
// each cell by itself, where that takes fewer lines: cells that are few and far apart.
struct LinePlan {
    static constexpr std::uint64_t kBlock = 4096;  // lines

    bool whole = true;
    std::uint64_t blocks = 0, per_cell = 0, seed = 1;
    double for_a_cell = 0.0;   // lines that the smallest cell needs
    double least_share = 1.0;  // of the lines through the box around all, those through the smallest cell

    // Of a block: replaces `lines`, relative to `origin`.
    void draw(std::uint64_t block, const Cells& cells, const glm::dvec3& origin, Vector<Line>& lines) const;
};

// (1 − p)^N ≤ e^(−pN): of P pairs none with p ≥ ln(P/δ)/N is missed, with probability 1 − δ (theory.md (7)). Lines
// through a cell of surface F are the share F/F_b of those through the convex body around it. Errors: over 2^44 lines.
[[nodiscard]] Result<LinePlan> plan_lines(const Cells& cells, std::uint64_t pairs, const BakeOptions& options);

// ε after so many lines through the smallest cell.
[[nodiscard]] double epsilon_after(double lines, std::uint64_t pairs, double confidence);

}  // namespace crofton::pvs
