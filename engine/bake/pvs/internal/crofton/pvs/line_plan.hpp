// SPDX-License-Identifier: MIT
// How many lines a guarantee needs, and line by line where each is.
#pragma once
#include <crofton/pvs/pvs.hpp>
#include <crofton/sampling/sampling.hpp>

namespace crofton::pvs {

// Lines in blocks. `whole`: through the box around all cells. They come in rounds. A round divides the lines through
// the box into strata of equal measure, and draws as many independent uniform lines in each. Lines of one stratum are
// near each other. Otherwise `per_cell` blocks of independent uniform lines through each cell by itself, where that
// takes fewer lines: cells that are few and far apart.
struct LinePlan {
    static constexpr std::uint64_t kVersion = 2;   // changes with the lines: parts of a bake have the same
    static constexpr std::uint64_t kBlock = 4096;  // lines
    static constexpr std::uint64_t kStratum = 64;  // lines of a block that are drawn in one stratum

    // Blocks of one round whose lines enter through one face of the box.
    struct Part {
        std::uint64_t first = 0, blocks = 0;
        int axis = 0;
        double side = 1.0;  // of the box: +1 the upper
    };

    bool whole = true;
    std::uint64_t blocks = 0, per_cell = 0, seed = 1;
    double for_a_cell = 0.0;   // lines that the smallest cell needs
    double least_share = 1.0;  // of the lines through the box around all, those through the smallest cell
    double own_share = 1.0;    // of the lines through the box around one cell, those through the cell, at least
    Vector<Part> parts;        // of `whole`: six of each round, by `first`
    Vector<double> rounds;     // of `whole`: lines that each round counts for

    // Replaces `lines` by those of a block, relative to `origin`.
    void draw(std::uint64_t block, const Cells& cells, const glm::dvec3& origin, Vector<Line>& lines) const;
};

// (1 − p)^N ≤ e^(−pN): of P pairs none with p ≥ ln(P/δ)/N is missed, with probability 1 − δ (theory.md (7)). Lines
// through a cell of surface F are the share F/F_b of those through the convex body around it. A stratum of the share w
// gets N·w lines or more. Strata promise the same: a pair that fills the share x of each misses all lines with
// probability Π (1 − x)^(N·w) ≤ e^(−N·Σ w·x) = e^(−pN). Errors: over 2^44 lines.
[[nodiscard]] Result<LinePlan> plan_lines(const Cells& cells, std::uint64_t pairs, const BakeOptions& options);

// ε after so many lines through the smallest cell.
[[nodiscard]] double epsilon_after(double lines, std::uint64_t pairs, double confidence);

}  // namespace crofton::pvs
