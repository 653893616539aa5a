// SPDX-License-Identifier: MIT
#include <array>
#include <cmath>
#include <crofton/core/recovery.hpp>
#include <crofton/radiosity/patches.hpp>
#include <functional>
#include <glm/geometric.hpp>
#include <string>
#include <unordered_map>

#include "refine.hpp"

namespace crofton::radiosity {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

// Symmetric in its arguments to the last bit.
glm::vec3 middle(const glm::vec3& a, const glm::vec3& b) {
    return glm::vec3(0.5 * (glm::dvec3(a) + glm::dvec3(b)));
}
double squared_length(const glm::vec3& a, const glm::vec3& b) {
    const glm::dvec3 d = glm::dvec3(a) - glm::dvec3(b);
    return glm::dot(d, d);
}

class Refiner {
  public:
    Refiner(const TriangleMesh& mesh, detail::CutEdge is_cut) : is_cut_(is_cut) {
        result.mesh = mesh;
        for (std::size_t t = 0; t < mesh.triangle_count(); ++t) result.source.push_back(static_cast<std::uint32_t>(t));
    }

    RefinedMesh result;

    // One round; false when nothing was left to cut.
    bool round() {
        TriangleMesh& mesh = result.mesh;
        Vector<std::uint32_t> indices, source;
        const std::size_t before = mesh.triangle_count();
        for (std::size_t t = 0; t < before; ++t) {
            const Triangle v = {mesh.indices[3 * t], mesh.indices[3 * t + 1], mesh.indices[3 * t + 2]};
            const std::size_t first = indices.size();
            cut(v, indices);
            source.insert(source.end(), (indices.size() - first) / 3, result.source[t]);
        }
        const bool any = source.size() != before;
        mesh.indices = std::move(indices);
        result.source = std::move(source);
        midpoints_.clear();
        return any;
    }

  private:
    bool to_cut(std::uint32_t a, std::uint32_t b) const {
        const glm::vec3 &p = result.mesh.positions[a], &q = result.mesh.positions[b];
        const glm::vec3 m = middle(p, q);
        return m != p && m != q && is_cut_(p, q);
    }

    std::uint32_t midpoint(std::uint32_t a, std::uint32_t b) {
        const std::uint64_t key = static_cast<std::uint64_t>(std::min(a, b)) << 32 | std::max(a, b);
        TriangleMesh& mesh = result.mesh;
        const auto [entry, added] = midpoints_.try_emplace(key, static_cast<std::uint32_t>(mesh.positions.size()));
        if (added) {
            mesh.positions.push_back(middle(mesh.positions[a], mesh.positions[b]));
            if (!mesh.colors.empty()) mesh.colors.push_back(0.5f * (mesh.colors[a] + mesh.colors[b]));
        }
        return entry->second;
    }

    void cut(Triangle v, Vector<std::uint32_t>& out) {
        const auto emit = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) { out.insert(out.end(), {a, b, c}); };
        std::array<bool, 3> cut_edge;
        int count = 0;
        for (std::size_t e = 0; e < 3; ++e) count += (cut_edge[e] = to_cut(v[e], v[(e + 1) % 3])) ? 1 : 0;
        if (count == 0) return emit(v[0], v[1], v[2]);
        // Turn the triangle so that its first edges are the ones cut.
        while (!(cut_edge[0] && (count != 2 || cut_edge[1]))) {
            v = {v[1], v[2], v[0]};
            cut_edge = {cut_edge[1], cut_edge[2], cut_edge[0]};
        }
        const std::uint32_t m0 = midpoint(v[0], v[1]);
        if (count == 1) {
            emit(v[0], m0, v[2]);
            return emit(m0, v[1], v[2]);
        }
        const std::uint32_t m1 = midpoint(v[1], v[2]);
        emit(m0, v[1], m1);
        if (count == 3) {
            const std::uint32_t m2 = midpoint(v[2], v[0]);
            emit(v[0], m0, m2);
            emit(m2, m1, v[2]);
            return emit(m0, m1, m2);
        }
        // The quadrilateral v0 m0 m1 v2 along its shorter diagonal.
        const auto& p = result.mesh.positions;
        if (squared_length(p[v[0]], p[m1]) <= squared_length(p[m0], p[v[2]])) {
            emit(v[0], m0, m1);
            emit(v[0], m1, v[2]);
        } else {
            emit(v[0], m0, v[2]);
            emit(m0, m1, v[2]);
        }
    }

    detail::CutEdge is_cut_;
    std::unordered_map<std::uint64_t, std::uint32_t, std::hash<std::uint64_t>, std::equal_to<>,
                       Allocator<std::pair<const std::uint64_t, std::uint32_t>>>
        midpoints_;
};

}  // namespace

RefinedMesh detail::cut_edges(const TriangleMesh& mesh, CutEdge is_cut) {
    Refiner refiner(mesh, is_cut);
    refiner.round();
    return std::move(refiner.result);
}

Result<RefinedMesh> refine(const TriangleMesh& mesh, EdgeLength longest_edge, std::size_t most_triangles) {
    return crofton::detail::recover([&]() -> Result<RefinedMesh> {
        if (auto valid = validate(mesh); !valid) return valid.error();
        const auto is_long = [&](const glm::vec3& p, const glm::vec3& q) {
            const double longest = longest_edge(middle(p, q));
            return squared_length(p, q) > longest * longest;
        };
        Refiner refiner(mesh, is_long);
        while (refiner.round())
            if (refiner.result.source.size() > most_triangles)
                return fail(ErrorCode::budget_exceeded, refiner.result.source.size(),
                            {"refine: more than ", most_triangles, " triangles; allow longer edges"});
        return std::move(refiner.result);
    });
}

Result<RefinedMesh> refine(const TriangleMesh& mesh, double longest_edge, std::size_t most_triangles) {
    if (!(longest_edge > 0.0))
        return fail(ErrorCode::out_of_range, kNoItem, "refine: the longest edge must be positive");
    const auto everywhere = [longest_edge](const glm::vec3&) { return longest_edge; };
    return refine(mesh, EdgeLength(everywhere), most_triangles);
}

}  // namespace crofton::radiosity
