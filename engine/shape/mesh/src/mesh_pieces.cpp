// SPDX-License-Identifier: MIT
#include "mesh_pieces.hpp"

#include <hwy/cache_control.h>
#include <algorithm>
#include <bit>
#include <crofton/core/disjoint_sets.hpp>
#include <numeric>
#include <utility>

namespace crofton::mesh {
namespace {

struct Edge {
    std::uint32_t low, high;
};

Edge edge_of(std::uint32_t a, std::uint32_t b) {
    return {std::min(a, b), std::max(a, b)};
}

// The edges, in order, of which `for_each_edge` names an odd number, twice the same ones; all with vertices below
// `vertices`. Bucketed by their lower vertex, which leaves few to sort.
template <class ForEachEdge>
Vector<Edge> odd_edges(std::size_t vertices, const ForEachEdge& for_each_edge) {
    Vector<std::uint32_t> end(vertices + 1, 0);
    for_each_edge([&](const Edge& edge) { ++end[edge.low + 1]; });
    std::partial_sum(end.begin(), end.end(), end.begin());
    Vector<std::uint32_t> high(end.back());
    for_each_edge([&](const Edge& edge) { high[end[edge.low]++] = edge.high; });
    Vector<Edge> odd;
    std::uint32_t begin = 0;
    for (std::uint32_t low = 0; low < vertices; ++low) {
        std::sort(high.begin() + begin, high.begin() + end[low]);
        const std::size_t before = odd.size();
        for (std::uint32_t i = begin; i < end[low]; ++i) {
            if (odd.size() > before && odd.back().high == high[i])
                odd.pop_back();
            else
                odd.push_back({low, high[i]});
        }
        begin = end[low];
    }
    return odd;
}

// The vertices whose mark is not 0, ascending.
Vector<std::uint32_t> marked(std::span<const std::uint8_t> marks) {
    Vector<std::uint32_t> vertices;
    vertices.reserve(marks.size() - static_cast<std::size_t>(std::count(marks.begin(), marks.end(), std::uint8_t{0})));
    for (std::uint32_t v = 0; v < marks.size(); ++v)
        if (marks[v] != 0) vertices.push_back(v);
    return vertices;
}

class PieceFinder {
  public:
    PieceFinder(const TriangleMesh& mesh, std::span<const std::uint32_t> triangles)
        : mesh_(mesh), triangles_(triangles), sets_(mesh.positions.size()), lowest_(mesh.positions.size()) {
        std::iota(lowest_.begin(), lowest_.end(), 0u);
    }

    MeshPieces find();

  private:
    [[nodiscard]] const std::uint32_t* corners(std::uint32_t triangle) const {
        return &mesh_.indices[3 * std::size_t{triangle}];
    }
    [[nodiscard]] bool has_one_piece();
    void weld(std::span<const std::uint32_t> vertices);
    bool weld_by_table(std::span<const std::uint32_t> vertices);
    void weld_by_order(std::span<const std::uint32_t> vertices);
    void join(std::uint32_t vertex, std::uint32_t other);
    [[nodiscard]] Vector<std::uint32_t> used_vertices() const;
    [[nodiscard]] Vector<std::uint32_t> roots_of(std::span<const std::uint32_t> vertices);
    void number_pieces(MeshPieces& pieces);
    void find_part_vertices(const Vector<std::uint32_t>& part_of, const Vector<std::uint32_t>& piece_of_root,
                            MeshPieces& pieces);

    const TriangleMesh& mesh_;
    std::span<const std::uint32_t> triangles_;
    DisjointSets sets_;
    Vector<std::uint32_t> lowest_;  // by vertex: the lowest of those welded to it
};

bool PieceFinder::has_one_piece() {
    const std::uint32_t first = sets_.find(corners(triangles_.front())[0]);
    return std::all_of(triangles_.begin(), triangles_.end(),
                       [&](std::uint32_t t) { return sets_.find(corners(t)[0]) == first; });
}

Vector<std::uint32_t> PieceFinder::used_vertices() const {
    Vector<std::uint8_t> used(mesh_.positions.size(), 0);
    for (const std::uint32_t t : triangles_)
        for (std::size_t v = 0; v < 3; ++v) used[corners(t)[v]] = 1;
    return marked(used);
}

void PieceFinder::join(std::uint32_t vertex, std::uint32_t other) {
    lowest_[vertex] = lowest_[other];
    sets_.unite(vertex, other);
}

// Welds ascending vertices of equal position.
void PieceFinder::weld(std::span<const std::uint32_t> vertices) {
    if (!weld_by_table(vertices)) weld_by_order(vertices);
}

// Looks positions up in a table that is at most half full. False, with some of the vertices welded, where too many
// different ones want the same place.
bool PieceFinder::weld_by_table(std::span<const std::uint32_t> vertices) {
    constexpr std::uint32_t kNone = ~std::uint32_t{0};
    constexpr std::size_t kLongest = 128, kBlock = 16;
    const auto bits = static_cast<std::size_t>(std::bit_width(vertices.size()) + 1);
    Vector<std::uint32_t> table(std::size_t{1} << bits, kNone);
    const auto place_of = [&](std::uint32_t vertex) {
        const glm::vec3 p = mesh_.positions[vertex] + 0.0f;  // −0 is 0
        const std::uint64_t xy = std::bit_cast<std::uint32_t>(p.x) | std::uint64_t{std::bit_cast<std::uint32_t>(p.y)}
                                                                         << 32;
        const std::uint64_t mixed = xy * 0x9e3779b97f4a7c15u + std::bit_cast<std::uint32_t>(p.z);
        return static_cast<std::size_t>(((mixed ^ (mixed >> 29)) * 0xbf58476d1ce4e5b9u) >> (64 - bits));
    };
    for (std::size_t begin = 0; begin < vertices.size(); begin += kBlock) {
        const std::size_t count = std::min(kBlock, vertices.size() - begin);
        std::size_t places[kBlock];
        for (std::size_t i = 0; i < count; ++i) {
            places[i] = place_of(vertices[begin + i]);
            hwy::Prefetch(&table[places[i]]);
        }
        for (std::size_t i = 0; i < count; ++i) {
            const std::uint32_t vertex = vertices[begin + i];
            std::size_t place = places[i], tries = 0;
            while (table[place] != kNone && mesh_.positions[table[place]] != mesh_.positions[vertex]) {
                if (++tries == kLongest) return false;
                place = (place + 1) & (table.size() - 1);
            }
            if (table[place] == kNone)
                table[place] = vertex;
            else
                join(vertex, table[place]);
        }
    }
    return true;
}

void PieceFinder::weld_by_order(std::span<const std::uint32_t> vertices) {
    Vector<std::uint32_t> order(vertices.begin(), vertices.end());
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        const glm::vec3 &p = mesh_.positions[a], &q = mesh_.positions[b];
        return p.x != q.x ? p.x < q.x : p.y != q.y ? p.y < q.y : p.z != q.z ? p.z < q.z : a < b;
    });
    for (std::size_t i = 1; i < order.size(); ++i)
        if (mesh_.positions[order[i - 1]] == mesh_.positions[order[i]]) join(order[i], order[i - 1]);
}

// By vertex; of others nothing is said.
Vector<std::uint32_t> PieceFinder::roots_of(std::span<const std::uint32_t> vertices) {
    Vector<std::uint32_t> roots(mesh_.positions.size(), 0);
    for (const std::uint32_t v : vertices) roots[v] = sets_.find(v);
    return roots;
}

void PieceFinder::find_part_vertices(const Vector<std::uint32_t>& part_of, const Vector<std::uint32_t>& piece_of_root,
                                     MeshPieces& pieces) {
    Vector<std::uint8_t> met(mesh_.positions.size(), 0);
    Vector<std::uint32_t> parts(pieces.vertex.size(), 0);
    for (const std::uint32_t t : triangles_) {
        const std::uint32_t v = corners(t)[0];
        if (std::exchange(met[part_of[v]], std::uint8_t{1}) != 0) continue;
        const std::uint32_t p = piece_of_root[sets_.find(v)];
        pieces.part_vertices.push_back({v, p});
        ++parts[p];
    }
    std::erase_if(pieces.part_vertices, [&](const PartVertex& part) { return parts[part.piece] == 1; });
}

void PieceFinder::number_pieces(MeshPieces& pieces) {
    constexpr std::uint32_t kUnnumbered = ~std::uint32_t{0};
    Vector<std::uint32_t> number(mesh_.positions.size(), kUnnumbered);
    pieces.piece.reserve(triangles_.size());
    for (const std::uint32_t t : triangles_) {
        const std::uint32_t root = sets_.find(corners(t)[0]);
        if (number[root] == kUnnumbered) {
            number[root] = static_cast<std::uint32_t>(pieces.vertex.size());
            pieces.vertex.push_back(corners(t)[0]);
        }
        pieces.piece.push_back(number[root]);
    }
    pieces.closed.assign(pieces.vertex.size(), 1);
}

// Edges that are even by index stay so when vertices are welded; only the odd ones are looked at again.
MeshPieces PieceFinder::find() {
    for (const std::uint32_t t : triangles_) {
        sets_.unite(corners(t)[0], corners(t)[1]);
        sets_.unite(corners(t)[1], corners(t)[2]);
    }
    const std::size_t vertices = mesh_.positions.size();
    const Vector<Edge> odd = odd_edges(vertices, [&](const auto& visit) {
        for (const std::uint32_t t : triangles_)
            for (std::size_t v = 0; v < 3; ++v) {
                const Edge edge = edge_of(corners(t)[v], corners(t)[(v + 1) % 3]);
                if (edge.low != edge.high) visit(edge);
            }
    });
    Vector<std::uint8_t> ends(vertices, 0);  // of odd edges
    for (const Edge& edge : odd) ends[edge.low] = ends[edge.high] = 1;
    const bool one_part = has_one_piece();
    const Vector<std::uint32_t> welded_vertices = one_part ? marked(ends) : used_vertices();
    const Vector<std::uint32_t> part_of = roots_of(welded_vertices);
    weld(welded_vertices);

    MeshPieces pieces;
    number_pieces(pieces);
    Vector<std::uint32_t> piece_of_root(mesh_.positions.size(), 0);
    for (std::uint32_t p = 0; p < pieces.vertex.size(); ++p) piece_of_root[sets_.find(pieces.vertex[p])] = p;
    const Vector<Edge> welded = odd_edges(vertices, [&](const auto& visit) {
        for (const Edge& edge : odd)
            if (const Edge e = edge_of(lowest_[edge.low], lowest_[edge.high]); e.low != e.high) visit(e);
    });
    for (const Edge& edge : welded) pieces.closed[piece_of_root[sets_.find(edge.low)]] = 0;
    for (const std::uint32_t v : welded_vertices) {
        if (lowest_[v] == v) continue;
        const std::uint32_t p = piece_of_root[sets_.find(v)];
        const bool closes = pieces.closed[p] != 0 && ends[v] != 0;
        if (closes || part_of[v] != part_of[lowest_[v]]) pieces.welds.push_back({v, lowest_[v], p});
    }
    if (!one_part) find_part_vertices(part_of, piece_of_root, pieces);
    pieces.lowest = std::move(lowest_);
    return pieces;
}

}  // namespace

MeshPieces find_pieces(const TriangleMesh& mesh, std::span<const std::uint32_t> triangles) {
    return PieceFinder(mesh, triangles).find();
}

}  // namespace crofton::mesh
