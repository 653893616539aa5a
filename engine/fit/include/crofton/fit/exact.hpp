// SPDX-License-Identifier: MIT
// The best box there is, with a proof of how good it is.
#pragma once
#include <crofton/core/function_ref.hpp>
#include <crofton/geometry/obb.hpp>
#include <crofton/measure/criterion.hpp>
#include <cstdint>
#include <limits>
#include <span>

namespace crofton::fit {

struct Progress {
    double value = 0.0;        // criterion of the best box so far
    double lower_bound = 0.0;  // proved: no box has less
    std::uint64_t cells = 0;   // sets of orientations bounded so far
};

struct ExactOptions {
    measure::Criterion criterion = measure::minimal_perimeter();
    double gap = 2e-7;  // relative; the search stops when it has proved this much. In [1e-12, 1)
    // The search also ends when one of these is spent, or when `progress` says so; the result carries the gap reached.
    double time_budget_seconds = std::numeric_limits<double>::infinity();
    std::uint64_t max_cells = 1u << 22;
    // Called some thousand times a second; returning false ends the search. May be null.
    const FunctionRef<bool(const Progress&)>* progress = nullptr;
};

struct ExactFit {
    Obb box;                   // contains every point exactly
    double value = 0.0;        // the criterion of `box`, its rounding to float included
    double lower_bound = 0.0;  // proved: no box around the points has less
    double gap = 0.0;          // (value − lower_bound) / value, 0 for value 0
    // The part of `gap` due to storing the axes as floats. These are tilted by up to 6e-8, which widens thin boxes. By
    // volume, gap and rounding of a tilted flat set are 1: its best box has volume 0, its best box of floats has not.
    // gap − rounding is what the search left unproved.
    double rounding = 0.0;
    bool complete = false;  // the search ended by itself
    std::uint64_t cells = 0;
    std::size_t subset = 0;  // number of points that the proof used
};

// The global optimum over all orientations. The same bits for any order and duplication of the points and any
// instruction set, unless a time budget or the callback ends the search. Errors: as fit_obb, and a gap or a time budget
// out of range.
[[nodiscard]] Result<ExactFit> fit_exact(std::span<const glm::vec3> points, const ExactOptions& options = {});
[[nodiscard]] Result<ExactFit> fit_exact(std::span<const glm::dvec3> points, const ExactOptions& options = {});

}  // namespace crofton::fit
