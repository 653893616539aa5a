// SPDX-License-Identifier: MIT
#include "assets/split_mesh.hpp"

#include <algorithm>
#include <crofton/geometry/box.hpp>
#include <numeric>
#include <unordered_map>

namespace crofton::assets {
namespace {

glm::dvec3 centroid(const TriangleMesh& mesh, std::uint32_t triangle) {
    glm::dvec3 sum(0.0);
    for (std::uint32_t k = 0; k < 3; ++k) sum += glm::dvec3(mesh.positions[mesh.indices[3 * triangle + k]]);
    return sum / 3.0;
}

TriangleMesh piece_of(const TriangleMesh& mesh, const std::uint32_t* begin, const std::uint32_t* end) {
    TriangleMesh piece;
    std::unordered_map<std::uint32_t, std::uint32_t> new_index;
    for (; begin != end; ++begin)
        for (std::uint32_t k = 0; k < 3; ++k) {
            const std::uint32_t old = mesh.indices[3 * *begin + k];
            const auto [entry, added] = new_index.try_emplace(old, static_cast<std::uint32_t>(piece.positions.size()));
            if (added) {
                piece.positions.push_back(mesh.positions[old]);
                if (!mesh.colors.empty()) piece.colors.push_back(mesh.colors[old]);
            }
            piece.indices.push_back(entry->second);
        }
    return piece;
}

}  // namespace

std::vector<TriangleMesh> split_mesh(TriangleMesh mesh, std::size_t limit) {
    std::vector<TriangleMesh> pieces;
    if (mesh.triangle_count() <= limit) {
        pieces.push_back(std::move(mesh));
        return pieces;
    }
    std::vector<std::uint32_t> order(mesh.triangle_count());
    std::iota(order.begin(), order.end(), 0u);
    struct Range {
        std::size_t begin, end;
    };
    std::vector<Range> stack{{0, order.size()}};
    while (!stack.empty()) {
        const Range range = stack.back();
        stack.pop_back();
        std::uint32_t* first = order.data() + range.begin;
        std::uint32_t* last = order.data() + range.end;
        if (range.end - range.begin <= limit) {
            std::sort(first, last);
            pieces.push_back(piece_of(mesh, first, last));
            continue;
        }
        Aabb bounds;
        for (const std::uint32_t* t = first; t != last; ++t) bounds.include(centroid(mesh, *t));
        const glm::dvec3 size = bounds.max - bounds.min;
        const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
        const std::size_t middle = range.begin + (range.end - range.begin) / 2;
        // Ties go by number, so that the pieces do not depend on the library's selection algorithm.
        std::nth_element(first, order.data() + middle, last, [&](std::uint32_t a, std::uint32_t b) {
            const double x = centroid(mesh, a)[axis], y = centroid(mesh, b)[axis];
            return x != y ? x < y : a < b;
        });
        stack.push_back({middle, range.end});
        stack.push_back({range.begin, middle});
    }
    return pieces;
}

}  // namespace crofton::assets
