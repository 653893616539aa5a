// SPDX-License-Identifier: MIT
// Kernels of the exact search: lower bounds for eight cells of orientations at once, for every instruction set.
#pragma once
#include <cstddef>
#include <glm/vec3.hpp>

#include "search/weights.hpp"

namespace crofton::fit::kernels {

inline constexpr std::size_t kBatch = 8;

// Candidate support points of the six sides (2k: along +axis k, 2k + 1: along −axis k), coordinates in separate arrays.
struct SideLists {
    const double* x[6];
    const double* y[6];
    const double* z[6];
    std::size_t count[6];
};

// A cell is the set of orientations with Rodrigues vectors c + δ, |δ_i| ≤ half[i]. All cells of a batch share `half`.
struct CellBatch {
    alignas(64) double center[3][kBatch];
    glm::dvec3 half;
    // Results: no orientation in the cell has a lower value than `bound`; `value` is that of the centre; `spread[i]`
    // is the coordinate along which the value varies most; `tilt[i]` bounds the components of the half-angle tangent
    // vector of the turns from the centre to any orientation of the cell; `support` are the centre's support points.
    alignas(64) double bound[kBatch];
    alignas(64) double value[kBatch];
    alignas(64) double spread[3][kBatch];
    alignas(64) double tilt[3][kBatch];
    alignas(64) double support[6][3][kBatch];
};

// Fills in the results of all cells. A bound that reaches `target` is not improved further.
void evaluate_cells(const Weights& weights, const SideLists& lists, double target, CellBatch& batch);

struct ListOut {
    double* x;
    double* y;
    double* z;
};
// Writes to `out` the points of one list that may be the support point of `side` for some orientation of cell `cell` of
// the batch, in their order; returns how many. Requires room for count + 8 in each array.
std::size_t filter_list(const SideLists& lists, std::size_t side, const CellBatch& batch, std::size_t cell,
                        const ListOut& out);

}  // namespace crofton::fit::kernels
