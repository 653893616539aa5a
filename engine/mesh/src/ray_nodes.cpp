// SPDX-License-Identifier: MIT
// The hierarchy of aligned boxes over a mesh tree's leaves, for rays.
#include <algorithm>
#include <crofton/mesh/box_hierarchy.hpp>
#include <crofton/mesh/mesh_parts.hpp>

namespace crofton::mesh {
namespace {

static_assert(kRayNodeWidth == BoxHierarchy::kWidth && kMeshLeaf == BoxHierarchy::kLeaf);

FloatBox bounds_of(const MeshLeaf& leaf) {
    FloatBox box;
    for (const auto& corner : leaf.vertex)
        for (int i = 0; i < 3; ++i)
            for (const float x : corner[i]) {  // unused lanes repeat a triangle
                box.low[i] = std::min(box.low[i], x);
                box.high[i] = std::max(box.high[i], x);
            }
    return box;
}

FloatBox bounds_of(const RayNode& node) {
    FloatBox box;
    for (int i = 0; i < 3; ++i) {
        box.low[i] = *std::min_element(std::begin(node.bounds[i]), std::end(node.bounds[i]));
        box.high[i] = *std::max_element(std::begin(node.bounds[i + 3]), std::end(node.bounds[i + 3]));
    }
    return box;
}

void set_bounds(RayNode& node, std::uint32_t lane, const FloatBox& box) {
    for (int i = 0; i < 3; ++i) {
        node.bounds[i][lane] = box.low[i];
        node.bounds[i + 3][lane] = box.high[i];
    }
}

}  // namespace

void MeshParts::build_ray_nodes() {
    Vector<FloatBox> boxes;
    boxes.reserve(leaves.size());
    for (const MeshLeaf& leaf : leaves) boxes.push_back(bounds_of(leaf));
    const BoxHierarchy tree = build_box_hierarchy(boxes, 1);
    ray_nodes.reserve(tree.nodes.size());
    for (const BoxHierarchy::Node& from : tree.nodes) {
        RayNode& node = ray_nodes.emplace_back();
        for (std::uint32_t lane = 0; lane < kRayNodeWidth; ++lane) {
            const bool used = lane < from.count;
            const std::uint32_t child = from.child[lane];
            node.child[lane] = !used ? RayNode::kUnused
                               : child & BoxHierarchy::kLeaf
                                   ? tree.order[tree.leaves[child & ~kMeshLeaf].begin] | kMeshLeaf
                                   : child;
            set_bounds(node, lane, used ? from.box[lane] : FloatBox{});
        }
    }
}

// Children stand behind their parents.
void MeshParts::refit_ray_nodes() {
    for (std::size_t n = ray_nodes.size(); n-- > 0;)
        for (std::uint32_t lane = 0; lane < kRayNodeWidth; ++lane) {
            const std::uint32_t child = ray_nodes[n].child[lane];
            if (child == RayNode::kUnused) continue;
            set_bounds(ray_nodes[n], lane,
                       child & kMeshLeaf ? bounds_of(leaves[child & ~kMeshLeaf]) : bounds_of(ray_nodes[child]));
        }
}

}  // namespace crofton::mesh
