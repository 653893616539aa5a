// SPDX-License-Identifier: MIT
#include "tracer_build.hpp"

#include <algorithm>
#include <crofton/mesh/box_hierarchy.hpp>
#include <iterator>
#include <utility>

namespace crofton::lines::detail {
namespace {

using mesh::BoxHierarchy, mesh::FloatBox;
static_assert(kMaxDepth >= BoxHierarchy::kMaxDepth);

TracerLeaf leaf_of(std::span<const std::uint32_t> triangles, const TriangleMesh& mesh,
                   std::span<const glm::vec3> points) {
    TracerLeaf leaf{};
    std::fill(std::begin(leaf.triangle), std::end(leaf.triangle), kMiss);
    for (std::size_t lane = 0; lane < triangles.size(); ++lane) {
        const std::uint32_t* const corner = &mesh.indices[3 * std::size_t{triangles[lane]}];
        const glm::vec3 &a = points[corner[0]], &b = points[corner[1]], &c = points[corner[2]];
        leaf.triangle[lane] = triangles[lane];
        for (int k = 0; k < 3; ++k) {
            leaf.corner[k][lane] = a[k];
            leaf.first[k][lane] = b[k] - a[k];
            leaf.second[k][lane] = c[k] - a[k];
        }
    }
    return leaf;
}

}  // namespace

void build_tracer(const TriangleMesh& mesh, const glm::dvec3& origin, Vector<mesh::BoxNode>& nodes,
                  Vector<TracerLeaf>& leaves) {
    Vector<glm::vec3> points;
    points.reserve(mesh.positions.size());
    for (const glm::vec3& p : mesh.positions) points.emplace_back(glm::dvec3(p) - origin);
    const auto box_of = [&](std::size_t t) {
        FloatBox box;
        for (std::size_t k = 0; k < 3; ++k) box.include(points[mesh.indices[3 * t + k]]);
        return box;
    };
    BoxHierarchy tree = mesh::build_box_hierarchy(mesh.triangle_count(), box_of, kLanes);
    nodes = std::move(tree.nodes);
    leaves.reserve(tree.leaves.size());
    const std::span<const std::uint32_t> order(tree.order);
    for (const BoxHierarchy::Leaf& leaf : tree.leaves)
        leaves.push_back(leaf_of(order.subspan(leaf.begin, leaf.end - leaf.begin), mesh, points));
}

}  // namespace crofton::lines::detail
