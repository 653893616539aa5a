// The connected pieces of a mesh.
#pragma once
#include <crofton/core/memory.hpp>
#include <crofton/geometry/triangle_mesh.hpp>
#include <span>

namespace crofton::mesh {

// One vertex of each piece that the triangles make, in order of its lowest triangle. Triangles are connected where they
// share a vertex: by index, or by equal position.
[[nodiscard]] Vector<glm::vec3> piece_points(const TriangleMesh& mesh, std::span<const std::uint32_t> triangles);

}  // namespace crofton::mesh
