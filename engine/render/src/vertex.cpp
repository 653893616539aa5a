// SPDX-License-Identifier: MIT
#include <cmath>
#include <crofton/core/error.hpp>
#include <crofton/render/vertex.hpp>
#include <glm/geometric.hpp>

namespace crofton::render {
namespace {

// The triangle corners that use each position: corners[begin[p] … begin[p + 1]).
struct CornersOfPositions {
    Vector<std::uint32_t> begin, corners;
};

CornersOfPositions corners_of_positions(const TriangleMesh& mesh) {
    CornersOfPositions result;
    result.begin.resize(mesh.positions.size() + 1);
    result.corners.resize(mesh.indices.size());
    for (const std::uint32_t index : mesh.indices) ++result.begin[index + 1];
    for (std::size_t p = 1; p < result.begin.size(); ++p) result.begin[p] += result.begin[p - 1];
    Vector<std::uint32_t> next(result.begin);
    for (std::uint32_t corner = 0; corner < mesh.indices.size(); ++corner)
        result.corners[next[mesh.indices[corner]]++] = corner;
    return result;
}

glm::vec3 unit_or_up(const glm::dvec3& v) {
    const double length = glm::length(v);
    return length > 0.0 && std::isfinite(length) ? glm::vec3(v / length) : glm::vec3(0.0f, 1.0f, 0.0f);
}

// Twice the area times the unit normal, in double: small triangles would underflow.
glm::dvec3 face_normal(const TriangleMesh& mesh, std::size_t triangle) {
    const glm::dvec3 a(mesh.positions[mesh.indices[3 * triangle]]);
    const glm::dvec3 b(mesh.positions[mesh.indices[3 * triangle + 1]]);
    const glm::dvec3 c(mesh.positions[mesh.indices[3 * triangle + 2]]);
    return glm::cross(b - a, c - a);
}

}  // namespace

IndexRange append_mesh(const TriangleMesh& mesh, const glm::vec3& color, Vector<Vertex>& vertices,
                       Vector<std::uint32_t>& indices, float crease_angle_radians) {
    CROFTON_ASSERT(indices.size() + mesh.indices.size() <= 0xffffffffu, "the index buffer holds at most 2^32 indices");
    const IndexRange range{static_cast<std::uint32_t>(indices.size()), static_cast<std::uint32_t>(mesh.indices.size())};
    const CornersOfPositions table = corners_of_positions(mesh);
    Vector<glm::dvec3> faces(mesh.triangle_count());
    Vector<glm::vec3> units(faces.size());
    for (std::size_t t = 0; t < faces.size(); ++t) {
        faces[t] = face_normal(mesh, t);
        units[t] = unit_or_up(faces[t]);
    }
    const float smallest_cosine = std::cos(crease_angle_radians);
    indices.resize(indices.size() + mesh.indices.size());
    for (std::size_t p = 0; p < mesh.positions.size(); ++p) {
        const std::size_t first_vertex = vertices.size();
        for (std::uint32_t i = table.begin[p]; i < table.begin[p + 1]; ++i) {
            const std::uint32_t face = table.corners[i] / 3;
            glm::dvec3 sum(0.0);
            for (std::uint32_t j = table.begin[p]; j < table.begin[p + 1]; ++j) {
                const std::uint32_t other = table.corners[j] / 3;
                if (other == face || glm::dot(units[face], units[other]) > smallest_cosine) sum += faces[other];
            }
            const glm::vec3 normal = unit_or_up(sum);
            std::size_t vertex = first_vertex;
            while (vertex < vertices.size() && vertices[vertex].normal != normal) ++vertex;
            if (vertex == vertices.size())
                vertices.push_back({mesh.positions[p], normal, mesh.colors.empty() ? color : mesh.colors[p]});
            indices[range.first_index + table.corners[i]] = static_cast<std::uint32_t>(vertex);
        }
    }
    return range;
}

}  // namespace crofton::render
