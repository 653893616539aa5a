// SPDX-License-Identifier: MIT
// Tests whether a point, or another mesh, is inside a closed mesh, by counting the crossings of a ray.
#include <algorithm>
#include <cmath>
#include <crofton/mesh/mesh_distance.hpp>
#include <crofton/mesh/mesh_parts.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <crofton/mesh/near_triangles.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "exact_signs.hpp"
#include "posed_mesh.hpp"

namespace crofton::mesh {
namespace {

// Whether edge ab, seen along z, runs to the right of p. Half-open in y, so that of two edges that share a vertex at
// p's height exactly one counts. The answer depends on the edge alone, so both its triangles agree.
bool is_right_of(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
    if ((a.y > p.y) == (b.y > p.y)) return false;
    const bool upward = a.y < b.y;
    return orientation_2d(upward ? a : b, upward ? b : a, p, 0, 1) > 0;
}

enum class Crossing : std::uint8_t { none, crosses, touches };

// Does the ray from p along +z cross the triangle?
Crossing crossing(const glm::dvec3& p, const Triangle& t) {
    const glm::dvec3 low = (glm::min)(t[0], (glm::min)(t[1], t[2])), high = (glm::max)(t[0], (glm::max)(t[1], t[2]));
    if (p.x < low.x || high.x < p.x || p.y < low.y || high.y < p.y || high.z < p.z) return Crossing::none;
    if (low.z <= p.z && segment_meets_triangle(p, p, t)) return Crossing::touches;
    const bool covers = is_right_of(p, t[0], t[1]) ^ is_right_of(p, t[1], t[2]) ^ is_right_of(p, t[2], t[0]);
    if (!covers) return Crossing::none;
    const int turn = orientation_2d(t[0], t[1], t[2], 0, 1);
    const int side = orientation(t[0], t[1], t[2], p) * turn;
    return side > 0 ? Crossing::crosses : Crossing::none;
}

// The ray from p along +z in the frame of a mesh, which stands at `pose`; without one, in p's frame.
UpwardRay upward_ray(const mesh::MeshTree& mesh, const RigidTransform* pose, const glm::dvec3& p) {
    double size = static_cast<double>(mesh.extent()) + glm::length(p);
    RigidTransform back;
    if (pose != nullptr) {
        back = inverse(*pose);
        size += glm::length(pose->translation);
    }
    const glm::dvec3 origin = pose != nullptr ? transform(back, p) : p;
    UpwardRay ray{};
    for (int i = 0; i < 3; ++i) {
        ray.origin[i] = static_cast<float>(origin[i]);
        for (int k = 0; k < 3; ++k) ray.axes[k][i] = static_cast<float>(back.rotation[k][i]);
    }
    ray.error = static_cast<float>(2e-6 * size) + std::numeric_limits<float>::min();
    return ray;
}

// Parity of the crossings of p's ray with the closed pieces of the mesh; on their surface counts as inside.
bool is_inside(const mesh::MeshTree& mesh, const RigidTransform* pose, const glm::dvec3& p) {
    const std::span<const MeshPiece> pieces = mesh.pieces();
    if (std::none_of(pieces.begin(), pieces.end(), [](const MeshPiece& piece) { return piece.closed; })) return false;
    bool inside = false;
    const auto visit = [&](const MeshLeaf& leaf, std::uint32_t lane, bool surely) {
        if (!pieces[leaf.piece[lane]].closed) return false;
        Crossing found = Crossing::crosses;
        if (!surely) found = crossing(p, pose == nullptr ? triangle_of(leaf, lane) : triangle_of(leaf, lane, *pose));
        inside ^= found == Crossing::crosses;
        return found == Crossing::touches;
    };
    const MeshParts& parts = mesh.parts();
    const bool touches = visit_triangles_above(parts.nodes.data(), parts.leaves, upward_ray(mesh, pose, p), visit);
    return touches || inside;
}

// One of each piece, and of each part where a refit has parted them.
std::size_t points_asked(const MeshTree& mesh) {
    return mesh.pieces().size() + mesh.parts().loose().size();
}

template <class IsInside>
std::size_t count_inside(const MeshTree& mesh, const IsInside& is_inside) {
    std::size_t inside = 0;
    for (const MeshPiece& piece : mesh.pieces()) inside += is_inside(piece.vertex);
    for (const glm::vec3& point : mesh.parts().loose()) inside += is_inside(point);
    return inside;
}

}  // namespace

bool contains(const mesh::MeshTree& mesh, const glm::dvec3& point) {
    // Outside of all coordinates of the mesh. So are NaN, infinity, and what exact arithmetic has no room for.
    const double extent = static_cast<double>(mesh.extent());
    for (int i = 0; i < 3; ++i)
        if (!(std::abs(point[i]) <= extent)) return false;
    return is_inside(mesh, nullptr, point);
}

Containment containment_of_disjoint(const mesh::MeshTree& a, const mesh::MeshTree& b, const RigidTransform& b_to_a) {
    if (a.triangle_count() == 0 || b.triangle_count() == 0) return Containment::none;
    const std::size_t of_b =
        count_inside(b, [&](const glm::vec3& p) { return is_inside(a, nullptr, transform(b_to_a, glm::dvec3(p))); });
    if (of_b == points_asked(b)) return Containment::b_inside_a;
    const std::size_t of_a = count_inside(a, [&](const glm::vec3& p) { return is_inside(b, &b_to_a, glm::dvec3(p)); });
    if (of_a == points_asked(a)) return Containment::a_inside_b;
    return of_a + of_b > 0 ? Containment::partly : Containment::none;
}

Containment containment(const mesh::MeshTree& a, const mesh::MeshTree& b, const RigidTransform& b_to_a,
                        MeshStatistics* statistics) {
    return intersects(a, b, b_to_a, statistics) ? Containment::none : containment_of_disjoint(a, b, b_to_a);
}

}  // namespace crofton::mesh
