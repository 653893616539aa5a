// SPDX-License-Identifier: MIT
// Levels of Quake III's format, with the visible sets that their compiler made.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/geometry/mesh.hpp>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace crofton::bench {

// Lengths in the file's units, 32 to about a metre.
struct Quake3Level {
    struct Node {
        glm::dvec3 normal{0.0};
        double distance = 0.0;       // points with dot(normal, p) > distance are in children[0]
        std::int32_t children[2]{};  // a node, or −1 − leaf
    };
    // What a stretch of a line passes, in order. Cluster −1: solid.
    struct Stretch {
        std::int32_t cluster = -1;
        double begin = 0.0, end = 0.0;
    };

    TriangleMesh mesh;  // flat faces and triangle meshes of the level itself, but translucent ones
    std::vector<Node> nodes;
    std::vector<std::int32_t> leaf_clusters;
    std::size_t clusters = 0, row_bytes = 0;
    std::vector<std::uint8_t> visible;  // bit j % 8 of byte row_bytes · i + j / 8: cluster i may see cluster j

    // Appends what the line passes from t = begin to end.
    void walk(const glm::dvec3& origin, const glm::dvec3& direction, double begin, double end,
              std::vector<Stretch>& passed) const;
    [[nodiscard]] bool may_see(std::size_t i, std::size_t j) const {
        return visible[row_bytes * i + j / 8] >> (j % 8) & 1;
    }
};

// Errors: another format or version, or damaged (parse); without sets (empty).
[[nodiscard]] Result<Quake3Level> read_quake3_level(std::span<const std::byte> file);

}  // namespace crofton::bench
