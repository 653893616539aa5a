// SPDX-License-Identifier: MIT
// Meshes against meshes, fresh and refitted: against every pair of triangles.
#include <algorithm>
#include <crofton/collide/narrow_phase.hpp>
#include <crofton/geometry/closest_points.hpp>
#include <crofton/geometry/predicates.hpp>
#include <crofton/mesh/mesh_distance.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <crofton/mesh/mesh_tree.hpp>

#include "shapes.hpp"

namespace {

using namespace crofton;
using fuzz::demand;

std::vector<Triangle> triangles_of(const TriangleMesh& mesh, const RigidTransform& pose) {
    std::vector<Triangle> result(mesh.triangle_count());
    for (std::size_t t = 0; t < result.size(); ++t)
        for (std::size_t v = 0; v < 3; ++v)
            result[t][v] = transform(pose, glm::dvec3(mesh.positions[mesh.indices[3 * t + v]]));
    return result;
}

double size_of(const std::vector<Triangle>& a, const std::vector<Triangle>& b) {
    double size = 0.0;
    for (const auto* list : {&a, &b})
        for (const Triangle& t : *list)
            for (const glm::dvec3& p : t) size = std::max(size, glm::length(p));
    return size;
}

void check_pair(fuzz::Shapes& in, const TriangleMesh& of_a, const mesh::MeshTree& a, const TriangleMesh& of_b,
                const mesh::MeshTree& b) {
    RigidTransform pose = in.pose();
    if (in.flag()) pose = {pose.rotation, in.nudge()};
    const std::vector<Triangle> ts = triangles_of(of_a, {}), us = triangles_of(of_b, pose);
    std::vector<IdPair> expected;
    double least = std::numeric_limits<double>::infinity();
    for (std::uint32_t t = 0; t < ts.size(); ++t)
        for (std::uint32_t u = 0; u < us.size(); ++u) {
            if (mesh::intersects(ts[t], us[u])) expected.push_back({t, u});
            ClosestPoints nearest;
            closest_of_triangles(ts[t], us[u], nearest);
            least = std::min(least, std::sqrt(nearest.squared));
        }
    Vector<mesh::TrianglePair> pairs;
    mesh::intersecting_triangles(a, b, pose, pairs);
    demand(std::equal(pairs.begin(), pairs.end(), expected.begin(), expected.end()), "triangles that meet");
    demand(mesh::intersects(a, b, pose) == !expected.empty(), "whether meshes meet");
    Vector<mesh::MeshContact> contacts;
    mesh::contacts(a, b, pose, contacts);
    demand(contacts.size() == expected.size(), "contacts");
    const mesh::MeshDistance d = mesh::distance(a, b, pose);
    demand((d.distance == 0.0) == !expected.empty(), "a distance of 0");
    const double size = size_of(ts, us);
    if (expected.empty()) demand(std::fabs(d.distance - least) <= 1e-6 * size, "a distance");
    if (d.distance > 0.0) {
        demand(mesh::closer_than(a, b, pose, d.distance * (1.0 + 1e-6) + 1e-9 * size), "closer than a little more");
        demand(!mesh::closer_than(
                   a, b, pose,
                   d.distance * (1.0 - 1e-6) - 1e-9 * size > 0.0 ? d.distance * (1.0 - 1e-6) - 1e-9 * size : 0.0),
               "closer than a little less");
    }
    const auto around = mesh::containment(a, b, pose);
    demand(expected.empty() || around == mesh::Containment::none, "containment of surfaces that meet");
}

// In a tetrahedron: on one side of all faces.
void check_inside(fuzz::Shapes& in) {
    TriangleMesh mesh;
    for (int i = 0; i < 4; ++i) mesh.positions.emplace_back(glm::vec3(in.point()));
    mesh.indices = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
    const auto tree = mesh::MeshTree::build(mesh);
    if (!tree) return;
    const auto p = [&](std::uint32_t i) { return glm::dvec3(mesh.positions[i]); };
    if (orientation(p(0), p(1), p(2), p(3)) == 0) return;
    for (int i = 0; i < 4; ++i) {
        const double s = in.below(5) / 4.0, t = in.below(5) / 4.0;
        const glm::dvec3 x = in.flag() ? in.point() : (1 - s) * p(0) + s * ((1 - t) * p(1) + t * p(2)) + in.nudge();
        bool above = false, below = false;
        for (std::size_t f = 0; f < 12; f += 3) {
            const int side = orientation(p(mesh.indices[f]), p(mesh.indices[f + 1]), p(mesh.indices[f + 2]), x);
            above = above || side > 0;
            below = below || side < 0;
        }
        demand(mesh::contains(*tree, x) == !(above && below), "a point in a tetrahedron");
    }
}

}  // namespace

CROFTON_FUZZ(in) {
    if (in.below(4) == 0) return check_inside(in);
    TriangleMesh of_a = in.flag() ? in.solid() : in.mesh(10, 30), of_b = in.flag() ? in.solid() : in.mesh(10, 30);
    mesh::MeshTreeOptions options;
    options.boxes = static_cast<mesh::MeshBoxes>(in.below(3));
    options.refittable = in.flag();
    auto a = mesh::MeshTree::build(of_a, options);
    const auto b = mesh::MeshTree::build(of_b);
    demand(a.has_value() && b.has_value(), "meshes");
    check_pair(in, of_a, *a, of_b, *b);
    if (!options.refittable) return;
    for (glm::vec3& p : of_a.positions)
        if (in.flag()) p = glm::vec3(in.point());
    demand(a->refit(of_a.positions).has_value(), "a refit");
    check_pair(in, of_a, *a, of_b, *b);
}
