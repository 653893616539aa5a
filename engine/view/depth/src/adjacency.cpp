// SPDX-License-Identifier: MIT
#include "adjacency.hpp"

#include <algorithm>

namespace crofton::depth {

void find_neighbors(const std::uint8_t* corners, std::uint32_t triangle_count, std::uint8_t* neighbors) {
    const auto next_corner = [](std::uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; };
    // For each pair of vertices: how many edges join them, and the first two.
    struct Edges {
        std::uint8_t count, first, second;
    };
    std::array<Edges, 3 * Cluster::kMaxTriangles> edges;
    SmallTable<std::array<std::uint8_t, 2>> pairs;
    pairs.clear();
    std::uint8_t pair_count = 0;
    for (std::uint32_t h = 0; h < 3 * triangle_count; ++h) {
        neighbors[h] = kNoNeighbor;
        const std::uint8_t* const c = corners + h / 3 * 3;
        if (c[0] == c[1] || c[1] == c[2] || c[2] == c[0]) continue;
        const std::uint8_t a = corners[h], b = corners[next_corner(h)];
        const std::uint8_t pair = pairs.number_of({std::min(a, b), std::max(a, b)}, pair_count);
        if (pair == pair_count) edges[pair_count++].count = 0;
        Edges& e = edges[pair];
        (e.count == 0 ? e.first : e.second) = static_cast<std::uint8_t>(h);
        e.count = static_cast<std::uint8_t>(std::min(e.count + 1, 3));
    }
    for (std::uint32_t p = 0; p < pair_count; ++p) {
        const std::uint32_t h = edges[p].first, g = edges[p].second;
        if (edges[p].count != 2 || corners[h] == corners[g]) continue;
        neighbors[h] = static_cast<std::uint8_t>(g / 3 * 4 + g % 3);
        neighbors[g] = static_cast<std::uint8_t>(h / 3 * 4 + h % 3);
    }
}

}  // namespace crofton::depth
