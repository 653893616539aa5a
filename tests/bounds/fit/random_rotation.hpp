// SPDX-License-Identifier: MIT
// Turns for the tests of fitting.
#pragma once
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <random>

inline glm::dmat3 random_rotation(std::mt19937& random) {
    std::normal_distribution<double> normal;
    const glm::dvec3 a = glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
    const glm::dvec3 b = glm::normalize(glm::cross(a, glm::dvec3(normal(random), normal(random), normal(random))));
    return {a, b, glm::cross(a, b)};
}
