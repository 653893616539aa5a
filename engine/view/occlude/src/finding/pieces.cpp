// SPDX-License-Identifier: MIT
#include "finding/pieces.hpp"

#include <algorithm>
#include <cmath>
#include <crofton/core/disjoint_sets.hpp>
#include <crofton/geometry/predicates.hpp>
#include <glm/common.hpp>
#include <numeric>

namespace crofton::occlude {
namespace {

bool is_valid_position(const glm::vec3& p) {
    const glm::vec3 size = glm::abs(p);
    return size.x <= kMaxPosition && size.y <= kMaxPosition && size.z <= kMaxPosition;  // false for NaN
}

// By vertex of the mesh: its number among the distinct positions, which `positions` receives.
Vector<std::uint32_t> weld(const TriangleMesh& mesh, Vector<glm::vec3>& positions) {
    Vector<std::uint32_t> order;
    order.reserve(mesh.positions.size());
    for (std::uint32_t v = 0; v < mesh.positions.size(); ++v)
        if (is_valid_position(mesh.positions[v])) order.push_back(v);
    const auto less = [&](std::uint32_t a, std::uint32_t b) {
        const glm::vec3 &p = mesh.positions[a], &q = mesh.positions[b];
        return p.x != q.x ? p.x < q.x : p.y != q.y ? p.y < q.y : p.z != q.z ? p.z < q.z : a < b;
    };
    std::sort(order.begin(), order.end(), less);
    Vector<std::uint32_t> lowest(mesh.positions.size(), kNoNeighbor);
    for (std::size_t i = 0; i < order.size(); ++i) {
        const bool is_new = i == 0 || mesh.positions[order[i - 1]] != mesh.positions[order[i]];
        lowest[order[i]] = is_new ? order[i] : lowest[order[i - 1]];
    }
    // Numbered by the first vertex at each position, so that neighbours in the mesh stay neighbours in memory.
    Vector<std::uint32_t> number(mesh.positions.size(), kNoNeighbor);
    for (std::uint32_t v = 0; v < lowest.size(); ++v) {
        if (lowest[v] == kNoNeighbor) continue;
        if (lowest[v] == v) {
            number[v] = static_cast<std::uint32_t>(positions.size());
            positions.push_back(mesh.positions[v] + glm::vec3(0.0f));
        } else {
            number[v] = number[lowest[v]];
        }
    }
    return number;
}

void read_triangles(const TriangleMesh& mesh, PieceMesh& result) {
    const Vector<std::uint32_t> number = weld(mesh, result.positions);
    for (std::uint32_t t = 0; t < mesh.triangle_count(); ++t) {
        std::array<std::uint32_t, 3> corner{};
        bool valid = true;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t v = mesh.indices[3 * std::size_t{t} + k];
            corner[k] = v < number.size() ? number[v] : kNoNeighbor;
            valid = valid && corner[k] != kNoNeighbor;
        }
        if (!valid) {
            result.rejected.push_back(t);
            continue;
        }
        result.triangles.push_back(corner);
        result.source.push_back(t);
    }
}

// A side of a triangle, as an edge without direction.
struct PieceSide {
    std::uint32_t low, high, triangle, corner;
    bool upward;  // from low to high

    [[nodiscard]] bool same_edge(const PieceSide& other) const { return low == other.low && high == other.high; }
};

// Ordered by edge, then by triangle. Bucketed by the lower vertex, which leaves few to sort.
Vector<PieceSide> sorted_sides(const PieceMesh& mesh) {
    Vector<std::uint32_t> end(mesh.positions.size() + 1, 0);
    const auto for_each_side = [&](auto visit) {
        for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
            for (std::uint32_t k = 0; k < 3; ++k) {
                const std::uint32_t a = mesh.triangles[t][k], b = mesh.triangles[t][(k + 1) % 3];
                if (a != b) visit(PieceSide{std::min(a, b), std::max(a, b), t, k, a < b});
            }
    };
    for_each_side([&](const PieceSide& side) { ++end[side.low + 1]; });
    std::partial_sum(end.begin(), end.end(), end.begin());
    Vector<PieceSide> sides(end.back());
    for_each_side([&](const PieceSide& side) { sides[end[side.low]++] = side; });
    std::uint32_t begin = 0;
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        std::stable_sort(sides.begin() + begin, sides.begin() + end[v],
                         [](const PieceSide& a, const PieceSide& b) { return a.high < b.high; });
        begin = end[v];
    }
    return sides;
}

// Numbers the sets by their lowest triangles, which are their roots, and lists the triangles of each.
Vector<std::uint32_t> list_pieces(PieceMesh& mesh, DisjointSets& sets) {
    const std::size_t count = mesh.triangles.size();
    Vector<std::uint32_t> piece_of(count, 0);
    for (std::uint32_t t = 0; t < count; ++t) {
        const std::uint32_t root = sets.find(t);
        if (root == t) {
            piece_of[t] = static_cast<std::uint32_t>(mesh.pieces.size());
            mesh.pieces.emplace_back();
        } else {
            piece_of[t] = piece_of[root];
        }
        ++mesh.pieces[piece_of[t]].end;
    }
    std::uint32_t begin = 0;
    for (Piece& piece : mesh.pieces) {
        piece.begin = begin;
        begin += piece.end;
        piece.end = piece.begin;
    }
    mesh.order.resize(count);
    for (std::uint32_t t = 0; t < count; ++t) mesh.order[mesh.pieces[piece_of[t]].end++] = t;
    return piece_of;
}

// Whether edge ab, seen along z, runs to the right of p. Half-open in y, so that of two edges that share a vertex at
// p's height exactly one counts. The answer depends on the edge alone, so both its triangles agree.
bool runs_right_of(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
    if ((a.y > p.y) == (b.y > p.y)) return false;
    const bool upward = a.y < b.y;
    return orientation(glm::dvec2(upward ? a : b), glm::dvec2(upward ? b : a), glm::dvec2(p)) > 0;
}

}  // namespace

PieceMesh split_into_pieces(const TriangleMesh& mesh) {
    PieceMesh result;
    read_triangles(mesh, result);
    const Vector<PieceSide> sides = sorted_sides(result);
    DisjointSets sets(result.triangles.size());
    for (std::size_t i = 1; i < sides.size(); ++i)
        if (sides[i].same_edge(sides[i - 1])) sets.unite(sides[i].triangle, sides[i - 1].triangle);
    const Vector<std::uint32_t> piece_of = list_pieces(result, sets);
    result.neighbors.assign(result.triangles.size(), {kNoNeighbor, kNoNeighbor, kNoNeighbor});
    for (std::size_t i = 0, next = 0; i < sides.size(); i = next) {
        int sum = 0;
        for (next = i; next < sides.size() && sides[next].same_edge(sides[i]); ++next)
            sum += sides[next].upward ? 1 : -1;
        Piece& piece = result.pieces[piece_of[sides[i].triangle]];
        piece.even = piece.even && (next - i) % 2 == 0;
        piece.balanced = piece.balanced && sum == 0;
        piece.manifold = piece.manifold && sum == 0 && next - i == 2;
        if (sum != 0 || next - i != 2) continue;
        result.neighbors[sides[i].triangle][sides[i].corner] = sides[i + 1].triangle;
        result.neighbors[sides[i + 1].triangle][sides[i + 1].corner] = sides[i].triangle;
    }
    return result;
}

Winding winding_around(const PieceMesh& mesh, const Piece& piece, const glm::dvec3& point) {
    Winding winding;
    for (const std::uint32_t index : mesh.of(piece)) {
        const Triangle t = mesh.corners(index);
        if (!(runs_right_of(point, t[0], t[1]) ^ runs_right_of(point, t[1], t[2]) ^ runs_right_of(point, t[2], t[0])))
            continue;
        const int turn = orientation(glm::dvec2(t[0]), glm::dvec2(t[1]), glm::dvec2(t[2]));
        if (orientation(t[0], t[1], t[2], point) * turn <= 0) continue;
        winding.number += turn;
        winding.odd = !winding.odd;
    }
    return winding;
}

}  // namespace crofton::occlude
