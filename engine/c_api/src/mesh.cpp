// SPDX-License-Identifier: MIT
#include <crofton/capi/mesh.hpp>

#include <crofton/capi/call.hpp>
#include <crofton/geometry/mesh_counts.hpp>

namespace crofton::capi {

crofton_status check_mesh(const crofton_mesh* mesh, const char* function) {
    CROFTON_CHECK(check_struct(mesh, function));
    CROFTON_CHECK(check_array(mesh->positions, mesh->vertex_count, function, 3));
    CROFTON_CHECK(check_array(mesh->indices, mesh->index_count, function));
    return status_of(detail::check_mesh_counts(mesh->vertex_count, mesh->index_count), function);
}

crofton_status to_mesh(const crofton_mesh* mesh, const char* function, TriangleMesh& result) {
    CROFTON_CHECK(check_mesh(mesh, function));
    return recover(function, [&] {
        const auto* positions = reinterpret_cast<const glm::vec3*>(mesh->positions);
        result.positions.assign(positions, positions + mesh->vertex_count);
        result.indices.assign(mesh->indices, mesh->indices + mesh->index_count);
        return CROFTON_OK;
    });
}

}  // namespace crofton::capi
