// SPDX-License-Identifier: MIT
// Oracle: walks a box tree from its leaves up and compares every bound with every box below it.
#pragma once
#include <cmath>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/boxtree/structure.hpp>
#include <glm/geometric.hpp>
#include <vector>

namespace crofton::oracle {

// Does the box lie in the bound of a node's child, as the node's integers and axes say? In numbers of 64 bits, to the
// 2^-44 of the sizes by which axes may fail to be orthonormal.
inline bool lies_in(const boxtree::Structure& structure, boxtree::NodeId n, unsigned lane, const Obb& box) {
    const boxtree::Node& node = structure.nodes()[n];
    const boxtree::Axes& axes = structure.axes()[node.axes];
    for (unsigned k = 0; k < 3; ++k) {
        long double middle = 0.0L, projected_radius = 0.0L, size = 0.0L;
        for (int j = 0; j < 3; ++j) {
            const long double away = static_cast<long double>(box.center[j]) - node.origin[j];
            middle += away * axes.rows[k][j];
            size += std::abs(away);
        }
        for (int i = 0; i < 3; ++i) {
            long double edge = 0.0L;
            for (int j = 0; j < 3; ++j) edge += static_cast<long double>(box.axes[i][j]) * axes.rows[k][j];
            projected_radius += std::abs(edge) * box.half_extents[i];
        }
        const long double error_bound = 0x1p-44L * (size + projected_radius), unit = node.unit;
        if (unit * boxtree::low_of(node, lane, k) > middle - projected_radius + error_bound) return false;
        if (unit * boxtree::high_of(node, lane, k) < middle + projected_radius - error_bound) return false;
    }
    return true;
}

// True iff each item that is not removed lies in exactly one slot, the links agree, and every box lies in all bounds
// above it.
inline bool holds_all(const boxtree::BoxTree& tree) {
    std::vector<int> seen(tree.boxes().size());
    for (boxtree::NodeId n = 0; n < tree.structure().nodes().size(); ++n)
        for (unsigned lane = 0; lane < tree.structure().nodes()[n].count; ++lane) {
            const std::uint32_t child = tree.structure().nodes()[n].child[lane];
            if (!(child & boxtree::kLeafBit)) {
                if (tree.structure().nodes()[child].parent != n ||
                    tree.structure().nodes()[child].lane_in_parent != lane)
                    return false;
                continue;
            }
            const boxtree::LeafId l = child & ~boxtree::kLeafBit;
            for (unsigned i = 0; i < tree.structure().leaves()[l].count; ++i) {
                const boxtree::ItemId item = tree.structure().slot_items()[l * boxtree::kWidth + i];
                ++seen[item];
                if (tree.structure().slot_of(item) != l * boxtree::kWidth + i) return false;
                const Aabb exact = aabb_of(tree.boxes()[item]);
                // aabb_of itself is rounded outward by a step.
                const double error_bound = 0x1p-50 * (glm::length(exact.min) + glm::length(exact.max));
                unsigned at = lane;
                for (boxtree::NodeId up = n; up != boxtree::kNone;
                     at = tree.structure().nodes()[up].lane_in_parent, up = tree.structure().nodes()[up].parent) {
                    if (!lies_in(tree.structure(), up, at, tree.boxes()[item])) return false;
                    const Aabb bounds = tree.structure().child_bounds(up, at);
                    for (int j = 0; j < 3; ++j)
                        if (bounds.min[j] > exact.min[j] + error_bound || bounds.max[j] < exact.max[j] - error_bound)
                            return false;
                }
            }
        }
    for (std::size_t i = 0; i < seen.size(); ++i)
        if (seen[i] != (tree.structure().slot_of(static_cast<boxtree::ItemId>(i)) == boxtree::kNone ? 0 : 1))
            return false;
    return true;
}

}  // namespace crofton::oracle
