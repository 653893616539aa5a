// SPDX-License-Identifier: MIT
// The places that hang together and are worth the most.
#pragma once
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace crofton::pipeline {

// Returns the region whose places are worth the most together, ascending. `worth` has a number above 0 for each place;
// where it is empty each place is worth the same. A region is all that ways connect. Of two that are worth the same, it
// is the one of lower mean height (y), then the one that holds the lowest index. ways[p] lists where one gets from
// place p; each way stands in the lists of both its ends. Time and memory grow with places and ways, however many
// regions there are.
[[nodiscard]] std::vector<std::uint32_t> largest_region(std::span<const glm::dvec3> places,
                                                        std::span<const std::vector<std::uint32_t>> ways,
                                                        std::span<const float> worth = {});

}  // namespace crofton::pipeline
