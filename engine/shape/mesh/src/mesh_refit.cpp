// SPDX-License-Identifier: MIT
#include "mesh_refit.hpp"

#include <algorithm>
#include <cmath>
#include <crofton/mesh/mesh_parts.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <string>

#include "mesh_box.hpp"

namespace crofton::mesh {
namespace {}  // namespace

// Vertices of no triangle may be anything: which are used is looked up only when some vertex is bad.
Result<void> MeshTree::check_positions(std::span<const glm::vec3> positions) const {
    const MeshRefitData& refit = parts().refit;
    if (refit.leaves.empty())
        return fail(ErrorCode::invalid_argument, kNoItem,
                    "mesh refit: the tree is not refittable; build it with MeshTreeOptions::refittable");
    if (positions.size() != refit.vertex_count)
        return fail(ErrorCode::invalid_argument, positions.size(),
                    {"mesh refit: the tree was built from ", refit.vertex_count, " positions"});
    bool all_usable = true;
    for (const glm::vec3& p : positions) all_usable &= is_usable(p);
    if (all_usable) return {};
    std::uint32_t bad = ~std::uint32_t{0};
    for (const LeafVertices& leaf : refit.leaves)
        for (const auto& corner : leaf.vertex)
            for (const std::uint32_t v : corner)
                if (!is_usable(positions[v])) bad = std::min(bad, v);
    if (bad == ~std::uint32_t{0}) return {};
    return fail(ErrorCode::non_finite, bad, {"mesh refit: vertex ", bad, " is not within 1e12"});
}

Result<void> MeshTree::refit(std::span<const glm::vec3> positions) {
    if (auto checked = check_positions(positions); !checked) return checked;
    MeshParts& parts = *parts_;
    MeshRefitData& refit = parts.refit;
    const float* const numbers = glm::value_ptr(positions.front());
    extent_ = move_leaves(numbers, refit.leaves.data(), parts.leaves.size(), parts.leaves.data());
    for (std::size_t n = 0; n < parts.nodes.size(); ++n)
        refit_boxes(numbers, parts.leaves.data(), refit.nodes[n], parts.nodes[n]);
    MeshNode root{};
    root.count = 1;
    refit_boxes(numbers, parts.leaves.data(), refit.root, root);
    for (int k = 0; k < 3; ++k) {
        parts.root_box.center[k] = root.center[k][0];
        parts.root_box.half[k] = root.half[k][0];
        for (int i = 0; i < 3; ++i) parts.root_box.axes[k][i] = root.axes[k][i][0];
    }
    for (std::size_t p = 0; p < pieces_.size(); ++p)
        pieces_[p] = {positions[refit.piece_vertices[p]], refit.piece_closed[p] != 0};
    std::fill(refit.piece_parted.begin(), refit.piece_parted.end(), std::uint8_t{0});
    for (const VertexWeld& weld : refit.welds) {
        if (positions[weld.vertex] == positions[weld.other]) continue;
        pieces_[weld.piece].closed = false;
        refit.piece_parted[weld.piece] = 1;
    }
    parts.loose_count = 0;
    for (const PieceWitness& witness : refit.witnesses)
        if (refit.piece_parted[witness.piece] != 0) parts.loose_points[parts.loose_count++] = positions[witness.vertex];
    parts.refit_ray_nodes();
    return {};
}

}  // namespace crofton::mesh
