// SPDX-License-Identifier: MIT
#include "largest_region.hpp"

#include <algorithm>

namespace crofton::pipeline {

std::vector<std::uint32_t> largest_region(std::span<const glm::dvec3> places,
                                          std::span<const std::vector<std::uint32_t>> ways,
                                          std::span<const float> worth) {
    std::vector<std::uint8_t> taken(places.size(), 0);
    std::vector<std::uint32_t> best, region;
    double best_height = 0.0, most = 0.0;
    for (std::uint32_t first = 0; first < places.size(); ++first) {
        if (taken[first] != 0) continue;
        region.assign(1, first);
        taken[first] = 1;
        for (std::size_t next = 0; next < region.size(); ++next)
            for (const std::uint32_t other : ways[region[next]]) {
                if (taken[other] != 0) continue;
                taken[other] = 1;
                region.push_back(other);
            }
        double height = 0.0, sum = 0.0;
        for (const std::uint32_t each : region) {
            height += places[each].y / static_cast<double>(region.size());
            sum += worth.empty() ? 1.0 : static_cast<double>(worth[each]);
        }
        if (sum < most || (sum == most && height >= best_height)) continue;
        best.swap(region);
        best_height = height;
        most = sum;
    }
    std::sort(best.begin(), best.end());
    return best;
}

}  // namespace crofton::pipeline
