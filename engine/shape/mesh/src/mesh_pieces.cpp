// SPDX-License-Identifier: MIT
#include "mesh_pieces.hpp"

#include <algorithm>
#include <crofton/core/disjoint_sets.hpp>
#include <numeric>
#include <utility>

namespace crofton::mesh {
namespace {

struct Edge {
    std::uint32_t low, high;
    friend auto operator<=>(const Edge&, const Edge&) = default;
};

Edge edge_of(std::uint32_t a, std::uint32_t b) {
    return {std::min(a, b), std::max(a, b)};
}

// Sorts the edges and keeps one of each that occurs an odd number of times.
template <class Iterator>
Iterator keep_odd(Iterator begin, Iterator end) {
    std::sort(begin, end);
    Iterator kept = begin;
    for (Iterator i = begin; i != end; ++i) {
        if (kept != begin && *(kept - 1) == *i)
            --kept;
        else
            *kept++ = *i;
    }
    return kept;
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
    [[nodiscard]] Vector<Edge> odd_edges() const;
    [[nodiscard]] bool has_one_piece();
    void weld(Vector<std::uint32_t> vertices);
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

// Edges, by index, of an odd number of triangles. Bucketed by their lower vertex, which leaves few to sort.
Vector<Edge> PieceFinder::odd_edges() const {
    Vector<std::uint32_t> end(mesh_.positions.size() + 1, 0);
    const auto for_each_edge = [&](auto visit) {
        for (const std::uint32_t t : triangles_)
            for (std::size_t v = 0; v < 3; ++v) {
                const Edge edge = edge_of(corners(t)[v], corners(t)[(v + 1) % 3]);
                if (edge.low != edge.high) visit(edge);
            }
    };
    for_each_edge([&](const Edge& edge) { ++end[edge.low + 1]; });
    std::partial_sum(end.begin(), end.end(), end.begin());
    Vector<std::uint32_t> high(end.back());
    for_each_edge([&](const Edge& edge) { high[end[edge.low]++] = edge.high; });
    Vector<Edge> odd;
    std::uint32_t begin = 0;
    for (std::uint32_t low = 0; low < mesh_.positions.size(); ++low) {
        const auto bucket = high.begin() + begin, bucket_end = high.begin() + end[low];
        const auto kept = keep_odd(bucket, bucket_end);
        for (auto h = bucket; h != kept; ++h) odd.push_back({low, *h});
        begin = end[low];
    }
    return odd;
}

bool PieceFinder::has_one_piece() {
    const std::uint32_t first = sets_.find(corners(triangles_.front())[0]);
    return std::all_of(triangles_.begin(), triangles_.end(),
                       [&](std::uint32_t t) { return sets_.find(corners(t)[0]) == first; });
}

Vector<std::uint32_t> PieceFinder::used_vertices() const {
    Vector<std::uint8_t> used(mesh_.positions.size(), 0);
    for (const std::uint32_t t : triangles_)
        for (std::size_t v = 0; v < 3; ++v) used[corners(t)[v]] = 1;
    Vector<std::uint32_t> vertices;
    for (std::uint32_t v = 0; v < used.size(); ++v)
        if (used[v] != 0) vertices.push_back(v);
    return vertices;
}

void PieceFinder::weld(Vector<std::uint32_t> vertices) {
    std::sort(vertices.begin(), vertices.end(), [&](std::uint32_t a, std::uint32_t b) {
        const glm::vec3 &p = mesh_.positions[a], &q = mesh_.positions[b];
        return p.x != q.x ? p.x < q.x : p.y != q.y ? p.y < q.y : p.z != q.z ? p.z < q.z : a < b;
    });
    for (std::size_t i = 1; i < vertices.size(); ++i) {
        if (mesh_.positions[vertices[i - 1]] != mesh_.positions[vertices[i]]) continue;
        lowest_[vertices[i]] = lowest_[vertices[i - 1]];
        sets_.unite(vertices[i - 1], vertices[i]);
    }
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
    const Vector<Edge> odd = odd_edges();
    Vector<std::uint32_t> ends;
    for (const Edge& edge : odd) ends.insert(ends.end(), {edge.low, edge.high});
    std::sort(ends.begin(), ends.end());
    ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
    const bool one_part = has_one_piece();
    const Vector<std::uint32_t> welded_vertices = one_part ? ends : used_vertices();
    const Vector<std::uint32_t> part_of = roots_of(welded_vertices);
    weld(welded_vertices);

    MeshPieces pieces;
    number_pieces(pieces);
    Vector<std::uint32_t> piece_of_root(mesh_.positions.size(), 0);
    for (std::uint32_t p = 0; p < pieces.vertex.size(); ++p) piece_of_root[sets_.find(pieces.vertex[p])] = p;
    Vector<Edge> welded;
    for (const Edge& edge : odd)
        if (const Edge e = edge_of(lowest_[edge.low], lowest_[edge.high]); e.low != e.high) welded.push_back(e);
    welded.erase(keep_odd(welded.begin(), welded.end()), welded.end());
    for (const Edge& edge : welded) pieces.closed[piece_of_root[sets_.find(edge.low)]] = 0;
    for (const std::uint32_t v : welded_vertices) {
        if (lowest_[v] == v) continue;
        const std::uint32_t p = piece_of_root[sets_.find(v)];
        const bool closes = pieces.closed[p] != 0 && std::binary_search(ends.begin(), ends.end(), v);
        if (closes || part_of[v] != part_of[lowest_[v]]) pieces.welds.push_back({v, lowest_[v], p});
    }
    if (!one_part) find_part_vertices(part_of, piece_of_root, pieces);
    return pieces;
}

}  // namespace

MeshPieces find_pieces(const TriangleMesh& mesh, std::span<const std::uint32_t> triangles) {
    return PieceFinder(mesh, triangles).find();
}

}  // namespace crofton::mesh
