// SPDX-License-Identifier: MIT
// The places that hang together the most.
#pragma once
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace crofton::pipeline {

// The region with the most of these places, ascending. A region is all that ways connect. Of two as large it is the
// one of lower mean height (y), then the one that holds the lowest index. ways[p] lists where one gets from place p;
// each way stands in the lists of both its ends. Time and memory grow with places and ways, however many regions there
// are.
[[nodiscard]] std::vector<std::uint32_t> largest_region(std::span<const glm::dvec3> places,
                                                        std::span<const std::vector<std::uint32_t>> ways);

}  // namespace crofton::pipeline
