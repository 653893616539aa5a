// SPDX-License-Identifier: MIT
#include <cmath>
#include <crofton/geometry/mesh.hpp>
#include <string>

namespace crofton {

Result<void> validate(const TriangleMesh& mesh) {
    if (mesh.indices.size() % 3 != 0)
        return fail(ErrorCode::invalid_argument, mesh.indices.size(),
                    "mesh: the index count is not a multiple of three");
    if (!mesh.colors.empty() && mesh.colors.size() != mesh.positions.size())
        return fail(ErrorCode::invalid_argument, mesh.colors.size(), "mesh: colours and positions differ in number");
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        const glm::vec3& p = mesh.positions[i];
        if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
            return fail(ErrorCode::non_finite, i, {"mesh: vertex ", i, " is NaN or infinite"});
    }
    for (std::size_t i = 0; i < mesh.indices.size(); ++i)
        if (mesh.indices[i] >= mesh.positions.size())
            return fail(ErrorCode::out_of_range, i,
                        {"mesh: index ", i, " refers to vertex ", mesh.indices[i], " of ", mesh.positions.size()});
    return {};
}

}  // namespace crofton
