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
    // Whatever comes first ends the search; the result then carries the gap that was reached.
    double time_budget_seconds = std::numeric_limits<double>::infinity();
    std::uint64_t max_cells = 1u << 22;
    // Called some thousand times a second; returning false ends the search as a spent budget does. May be null.
    const FunctionRef<bool(const Progress&)>* progress = nullptr;
};

struct ExactFit {
    Obb box;                   // contains every point exactly
    double value = 0.0;        // the criterion of `box`, its rounding to float included
    double lower_bound = 0.0;  // proved: no box around the points has less
    double gap = 0.0;          // (value − lower_bound) / value, 0 for value 0
    // The part of `gap` that storing the box costs: its axes are floats, tilted by up to 6e-8, which widens a thin box
    // across its longest side. A flat set has a box of volume 0 and none of floats that attains it: there gap and
    // rounding are 1. gap − rounding is what the search left unproved.
    double rounding = 0.0;
    bool complete = false;  // the search ended by itself
    std::uint64_t cells = 0;
    std::size_t subset = 0;  // points that the proof needed
};

// The global optimum over all orientations. Without a time budget or a progress callback that stops it: the same bits
// for any order and duplication of the points, any thread, any instruction set. Errors: as fit_obb, and a gap or a
// budget out of range.
[[nodiscard]] Result<ExactFit> fit_exact(std::span<const glm::vec3> points, const ExactOptions& options = {});
[[nodiscard]] Result<ExactFit> fit_exact(std::span<const glm::dvec3> points, const ExactOptions& options = {});

}  // namespace crofton::fit
