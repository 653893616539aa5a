// SPDX-License-Identifier: MIT
// A lit room, and options for quick runs of the solver.
#pragma once
#include <doctest/doctest.h>
#include <crofton/radiosity/patches.hpp>
#include <crofton/radiosity/solver.hpp>
#include <cstdint>
#include <glm/vec3.hpp>
#include <utility>
#include <vector>

#include "shapes.hpp"

namespace shapes {

using crofton::radiosity::make_patches;
using crofton::radiosity::Material;
using crofton::radiosity::Patches;
using crofton::radiosity::SolverOptions;

inline Patches patches_of(const Shape& shape, const std::vector<Material>& materials) {
    return make_patches(shape.mesh, shape.patches, materials).value();
}

inline SolverOptions quick() {
    SolverOptions options;
    options.lines = 1 << 12;
    options.first_shot = 1 << 14;
    return options;
}

// A room cut into cells × cells patches a wall, with a lamp on the ceiling: the box of every radiosity paper.
struct Box {
    Shape shape;
    std::vector<Material> materials;
};
inline Box lit_box(int cells) {
    Box box;
    const auto wall = [&](glm::vec3 corner, glm::vec3 u, glm::vec3 v, glm::vec3 color, bool ceiling) {
        u /= static_cast<float>(cells);
        v /= static_cast<float>(cells);
        for (int i = 0; i < cells; ++i)
            for (int j = 0; j < cells; ++j) {
                const bool lamp = ceiling && i == cells / 2 && j == cells / 2;
                box.shape.parallelogram(corner + static_cast<float>(i) * u + static_cast<float>(j) * v, u, v,
                                        static_cast<std::uint32_t>(box.materials.size()));
                box.materials.push_back({lamp ? glm::vec3(10.0f, 9.0f, 7.0f) : glm::vec3(0.0f), color});
            }
    };
    const glm::vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1), white(0.7f);
    wall({0, 0, 0}, y, z, {0.6f, 0.05f, 0.05f}, false);
    wall(x, z, y, {0.1f, 0.5f, 0.1f}, false);
    wall({0, 0, 0}, z, x, white, false);
    wall(y, x, z, white, true);
    wall({0, 0, 0}, x, y, white, false);
    wall(z, y, x, white, false);
    return box;
}

}  // namespace shapes
