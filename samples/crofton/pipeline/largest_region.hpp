// SPDX-License-Identifier: MIT
// The places that hang together the most.
#pragma once
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace crofton::pipeline {

// Of places with ways between them, those of the region with the most places, ascending; of two as large the one whose
// mean height (y) is lower, then the one with the lowest place's number. ways[p]: where one gets from p, both
// directions listed. Time and memory grow with places and ways, however many regions there are.
[[nodiscard]] std::vector<std::uint32_t> largest_region(std::span<const glm::dvec3> places,
                                                        std::span<const std::vector<std::uint32_t>> ways);

}  // namespace crofton::pipeline
