// SPDX-License-Identifier: MIT
// Scenes of boxes for the tests of pvs.
#pragma once
#include <cmath>
#include <crofton/pvs/pvs.hpp>
#include <crofton/sampling/sampling.hpp>
#include <utility>
#include <vector>

namespace crofton::testing {

// A closed box with its faces outward, or inward as a room has them.
inline void add_box(pvs::BakeGeometry& geometry, const Obb& box, bool inward = false) {
    const auto object = static_cast<std::uint32_t>(geometry.boxes.size());
    const auto first = static_cast<std::uint32_t>(geometry.mesh.positions.size());
    for (const glm::dvec3& p : corners(box)) geometry.mesh.positions.push_back(glm::vec3(p - geometry.origin));
    std::uint32_t faces[] = {0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                             2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6};
    for (int t = 0; t < 36 && inward; t += 3) std::swap(faces[t], faces[t + 1]);
    for (const std::uint32_t i : faces) geometry.mesh.indices.push_back(first + i);
    geometry.object_of.insert(geometry.object_of.end(), 12, object);
    geometry.boxes.push_back(box);
}
inline void add_box(pvs::BakeGeometry& geometry, const Aabb& box, bool inward = false) {
    add_box(geometry, obb_of(box), inward);
}

inline Aabb box_around(const glm::dvec3& center, const glm::dvec3& half) {
    return {center - half, center + half};
}

// The hull of eight points: at random, or a turned prism over a triangle, with corners that are equal.
inline pvs::ConvexCell random_cell(sampling::Random& random, const glm::dvec3& center, double size) {
    pvs::ConvexCell cell;
    const bool prism = random.uniform() < 0.5;
    for (std::size_t i = 0; i < 8; ++i) {
        const double x = random.uniform(-1.0, 1.0), y = random.uniform(-1.0, 1.0), z = random.uniform(-1.0, 1.0);
        cell.corners[i] = center + size * glm::dvec3(x, y, z);
    }
    if (!prism) return cell;
    const glm::dvec3 up = cell.corners[3] - center;
    for (std::size_t k = 0; k < 3; ++k) cell.corners[k + 3] = cell.corners[k] + up;
    cell.corners[6] = cell.corners[7] = cell.corners[0];
    return cell;
}

// A point of it: weights of the corners.
inline glm::dvec3 point_in(const pvs::ConvexCell& cell, sampling::Random& random) {
    double weight[8], sum = 0.0;
    for (double& w : weight) sum += w = -std::log(1.0 - random.uniform());
    glm::dvec3 point(0.0);
    for (std::size_t i = 0; i < 8; ++i) point += weight[i] / sum * (cell.corners[i] - cell.corners[0]);
    return cell.corners[0] + point;
}

// Boxes at random places of a flat region, some of which meet.
inline pvs::BakeGeometry random_geometry(std::uint64_t seed, int boxes, const glm::dvec3& origin = glm::dvec3(0.0)) {
    sampling::Random random(seed);
    pvs::BakeGeometry geometry;
    geometry.origin = origin;
    for (int i = 0; i < boxes; ++i) {
        const auto at = random.point<3>();
        const auto size = random.point<3>();
        add_box(geometry, box_around(origin + glm::dvec3(20.0 * at[0] - 10.0, 4.0 * at[1], 20.0 * at[2] - 10.0),
                                     glm::dvec3(0.2 + 2.0 * size[0], 0.2 + 2.0 * size[1], 0.2 + 2.0 * size[2])));
    }
    return geometry;
}

inline std::vector<std::byte> plain(const Vector<std::byte>& bytes) {
    return {bytes.begin(), bytes.end()};
}

}  // namespace crofton::testing
