// SPDX-License-Identifier: MIT
// Pairs of surfaces whose form factor is known in closed form (J. R. Howell, A Catalog of Radiation Heat Transfer
// Configuration Factors).
#pragma once
#include <crofton/radiosity/patches.hpp>
#include <string>
#include <vector>

namespace crofton::cli {

struct StandardPair {
    std::string name;
    std::string source;  // "Howell C-11"
    TriangleMesh mesh;   // of two patches, 0 and 1
    std::vector<std::uint32_t> patch_of_triangle;
    double factor = 0.0;  // F_01, of the triangles as they are where they stand for something round
};

[[nodiscard]] std::vector<StandardPair> standard_pairs();

struct PairFactor {
    double value = 0.0;
    double standard_error = 0.0;
    std::uint64_t rays = 0;  // that left patch 0
};
// F_01 by `blocks` blocks of global lines from the walls of the pair's box.
[[nodiscard]] Result<PairFactor> factor_by_global_lines(const StandardPair& pair, std::uint64_t blocks,
                                                        std::uint64_t seed);

}  // namespace crofton::cli
