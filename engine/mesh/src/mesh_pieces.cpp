#include "mesh_pieces.hpp"

#include <algorithm>
#include <numeric>

namespace crofton::mesh {
namespace {

// Disjoint sets of vertices, with paths halved on the way (Tarjan, van Leeuwen 1984).
class Sets {
  public:
    explicit Sets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }
    [[nodiscard]] std::uint32_t find(std::uint32_t v) {
        while (parent_[v] != v) {
            parent_[v] = parent_[parent_[v]];
            v = parent_[v];
        }
        return v;
    }
    void unite(std::uint32_t a, std::uint32_t b) {
        a = find(a);
        b = find(b);
        parent_[std::max(a, b)] = std::min(a, b);
    }

  private:
    Vector<std::uint32_t> parent_;
};

Vector<std::uint32_t> first_vertices(const TriangleMesh& mesh, std::span<const std::uint32_t> triangles, Sets& sets) {
    Vector<std::uint32_t> first;
    Vector<std::uint8_t> seen(mesh.positions.size(), 0);
    for (const std::uint32_t t : triangles) {
        const std::uint32_t root = sets.find(mesh.indices[3 * std::size_t{t}]);
        if (seen[root] == 0) first.push_back(mesh.indices[3 * std::size_t{t}]);
        seen[root] = 1;
    }
    return first;
}

void unite_equal_positions(const TriangleMesh& mesh, std::span<const std::uint32_t> triangles, Sets& sets) {
    Vector<std::uint32_t> corners;
    for (const std::uint32_t t : triangles)
        for (std::size_t v = 0; v < 3; ++v) corners.push_back(mesh.indices[3 * std::size_t{t} + v]);
    const auto before = [&](std::uint32_t a, std::uint32_t b) {
        const glm::vec3 &p = mesh.positions[a], &q = mesh.positions[b];
        return p.x != q.x ? p.x < q.x : p.y != q.y ? p.y < q.y : p.z < q.z;
    };
    std::sort(corners.begin(), corners.end(), before);
    for (std::size_t i = 1; i < corners.size(); ++i)
        if (mesh.positions[corners[i - 1]] == mesh.positions[corners[i]]) sets.unite(corners[i - 1], corners[i]);
}

}  // namespace

Vector<glm::vec3> piece_points(const TriangleMesh& mesh, std::span<const std::uint32_t> triangles) {
    Sets sets(mesh.positions.size());
    for (const std::uint32_t t : triangles) {
        const std::uint32_t* corner = &mesh.indices[3 * std::size_t{t}];
        sets.unite(corner[0], corner[1]);
        sets.unite(corner[1], corner[2]);
    }
    Vector<std::uint32_t> first = first_vertices(mesh, triangles, sets);
    if (first.size() > 1) {
        unite_equal_positions(mesh, triangles, sets);
        first = first_vertices(mesh, triangles, sets);
    }
    Vector<glm::vec3> points;
    for (const std::uint32_t v : first) points.push_back(mesh.positions[v]);
    return points;
}

}  // namespace crofton::mesh
