// Eight cells of orientations at once: the heart of the exact search, compiled for every instruction set.
#pragma once
#include <cstddef>
#include <glm/vec3.hpp>

#include "weights.hpp"

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
    // tells along which coordinate the value varies most; `tilt[i]` bounds the components of the half-angle tangent
    // vector of the turns from the centre to any orientation of the cell; `support` are the centre's support points.
    alignas(64) double bound[kBatch];
    alignas(64) double value[kBatch];
    alignas(64) double spread[3][kBatch];
    alignas(64) double tilt[3][kBatch];
    alignas(64) double support[6][3][kBatch];
};

// `target`: cells whose bound reaches it need no better bound.
void evaluate_cells(const Weights& weights, const SideLists& lists, double target, CellBatch& batch);

// Writes to `out` (room for count + 8 in each array) the points of one list that may be the support point of `side`
// somewhere in cell `cell` of the batch; returns how many.
struct ListOut {
    double* x;
    double* y;
    double* z;
};
std::size_t filter_list(const SideLists& lists, std::size_t side, const CellBatch& batch, std::size_t cell,
                        const ListOut& out);

}  // namespace crofton::fit::kernels
