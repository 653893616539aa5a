// SPDX-License-Identifier: MIT
// Scenes of boxes for the tests of pvs.
#pragma once
#include <crofton/pvs/pvs.hpp>
#include <crofton/sampling/sampling.hpp>
#include <utility>
#include <vector>

namespace crofton::testing {

// A closed box with its faces outward, or inward as a room has them.
inline void add_box(pvs::Subject& subject, const Obb& box, bool inward = false) {
    const auto object = static_cast<std::uint32_t>(subject.boxes.size());
    const auto first = static_cast<std::uint32_t>(subject.mesh.positions.size());
    for (const glm::dvec3& p : corners(box)) subject.mesh.positions.push_back(glm::vec3(p - subject.origin));
    std::uint32_t faces[] = {0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                             2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6};
    for (int t = 0; t < 36 && inward; t += 3) std::swap(faces[t], faces[t + 1]);
    for (const std::uint32_t i : faces) subject.mesh.indices.push_back(first + i);
    subject.object_of.insert(subject.object_of.end(), 12, object);
    subject.boxes.push_back(box);
}
inline void add_box(pvs::Subject& subject, const Aabb& box, bool inward = false) {
    add_box(subject, obb_of(box), inward);
}

inline Aabb box_around(const glm::dvec3& center, const glm::dvec3& half) {
    return {center - half, center + half};
}

// Boxes at random places of a flat region, some of which meet.
inline pvs::Subject random_subject(std::uint64_t seed, int boxes, const glm::dvec3& origin = glm::dvec3(0.0)) {
    sampling::Random random(seed);
    pvs::Subject subject;
    subject.origin = origin;
    for (int i = 0; i < boxes; ++i) {
        const auto at = random.point<3>();
        const auto size = random.point<3>();
        add_box(subject, box_around(origin + glm::dvec3(20.0 * at[0] - 10.0, 4.0 * at[1], 20.0 * at[2] - 10.0),
                                    glm::dvec3(0.2 + 2.0 * size[0], 0.2 + 2.0 * size[1], 0.2 + 2.0 * size[2])));
    }
    return subject;
}

inline std::vector<std::byte> plain(const Vector<std::byte>& bytes) {
    return {bytes.begin(), bytes.end()};
}

}  // namespace crofton::testing
