// SPDX-License-Identifier: MIT
// The hierarchy of aligned boxes over a mesh tree's leaves, for rays.
#include <algorithm>
#include <crofton/core/drop_spare.hpp>
#include <crofton/core/recovery.hpp>
#include <crofton/mesh/box_hierarchy.hpp>
#include <crofton/mesh/mesh_parts.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <utility>

namespace crofton::mesh {
namespace {

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

FloatBox bounds_of(const BoxNode& node) {
    FloatBox box;
    for (int i = 0; i < 3; ++i) {
        box.low[i] = *std::min_element(std::begin(node.bounds[i]), std::end(node.bounds[i]));
        box.high[i] = *std::max_element(std::begin(node.bounds[i + 3]), std::end(node.bounds[i + 3]));
    }
    return box;
}

}  // namespace

Result<void> MeshTree::prepare_rays() {
    if (parts().leaves.empty() || !parts().ray_nodes.empty()) return {};
    return detail::recover([&]() -> Result<void> {
        const auto box_of = [&](std::size_t leaf) { return bounds_of(parts_->leaves[leaf]); };
        BoxHierarchy tree = build_box_hierarchy(parts_->leaves.size(), box_of, 1);
        Vector<std::uint32_t> leaf_of(parts_->leaves.size());
        for (std::size_t i = 0; i < leaf_of.size(); ++i) leaf_of[i] = tree.order[tree.leaves[i].begin];
        parts_->take_ray_nodes(std::move(tree.nodes), leaf_of);
        return {};
    });
}

void MeshParts::take_ray_nodes(Vector<BoxNode> hierarchy, std::span<const std::uint32_t> leaf_of) {
    for (BoxNode& node : hierarchy)
        for (std::uint32_t lane = 0; lane < node.count; ++lane)
            if (std::uint32_t& child = node.child[lane]; child & kMeshLeaf)
                child = leaf_of[child & ~kMeshLeaf] | kMeshLeaf;
    crofton::detail::drop_spare(hierarchy);
    ray_nodes = std::move(hierarchy);
}

// Children stand behind their parents.
void MeshParts::refit_ray_nodes() {
    for (std::size_t n = ray_nodes.size(); n-- > 0;)
        for (std::uint32_t lane = 0; lane < ray_nodes[n].count; ++lane) {
            const std::uint32_t child = ray_nodes[n].child[lane];
            set_bounds(ray_nodes[n], lane,
                       child & kMeshLeaf ? bounds_of(leaves[child & ~kMeshLeaf]) : bounds_of(ray_nodes[child]));
        }
}

}  // namespace crofton::mesh
