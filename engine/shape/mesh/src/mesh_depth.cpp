// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <crofton/mesh/mesh_distance.hpp>
#include <crofton/mesh/mesh_parts.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <glm/geometric.hpp>

namespace crofton::mesh {
namespace {

glm::dvec3 exact_vector(const float (&v)[3]) {
    return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}

double size_of(const mesh::MeshBox& box) {
    return 2.0 * glm::length(exact_vector(box.half));
}

}  // namespace

SeparatingMotion separating_motion(const mesh::MeshTree& a, const mesh::MeshTree& b, const RigidTransform& b_to_a,
                                   std::span<const MeshContact> contacts) {
    const auto meet_at = [&](const glm::dvec3& motion) {
        const RigidTransform pose{b_to_a.rotation, b_to_a.translation + motion};
        return intersects(a, b, pose) || containment_of_disjoint(a, b, pose) != Containment::none;
    };
    if (!meet_at(glm::dvec3(0.0))) return {};
    // Of points, what their coordinates can tell.
    const double extent = static_cast<double>(a.extent()) + static_cast<double>(b.extent());
    const double size = std::max(size_of(a.parts().root_box) + size_of(b.parts().root_box), 1e-12 * extent);
    SeparatingMotion best{2.0 * size, glm::dvec3(0.0)};
    const auto try_direction = [&](const glm::dvec3& direction) {
        const double length = glm::length(direction);
        if (!(length > 1e-12)) return;
        const glm::dvec3 unit = direction / length;
        if (meet_at(best.depth * unit)) return;  // no shorter than the best known
        double meeting = 0.0, apart = best.depth;
        while (apart - meeting > 1e-6 * size) {
            const double middle = 0.5 * (meeting + apart);
            (meet_at(middle * unit) ? meeting : apart) = middle;
        }
        best = {apart, unit};
    };
    glm::dvec3 normal(0.0);
    for (const MeshContact& contact : contacts) normal += contact.normal;
    const glm::dvec3 centers =
        transform(b_to_a, exact_vector(b.parts().root_box.center)) - exact_vector(a.parts().root_box.center);
    for (const double sign : {1.0, -1.0}) {
        try_direction(sign * centers);
        try_direction(sign * normal);
        for (int k = 0; k < 3; ++k) {
            glm::dvec3 axis(0.0);
            axis[k] = sign;
            try_direction(axis);
            try_direction(b_to_a.rotation * axis);
        }
        for (const auto& axis : a.parts().root_box.axes) try_direction(sign * exact_vector(axis));
        for (const auto& axis : b.parts().root_box.axes) try_direction(sign * (b_to_a.rotation * exact_vector(axis)));
    }
    return best;
}

}  // namespace crofton::mesh
