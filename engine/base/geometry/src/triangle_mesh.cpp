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

void append(TriangleMesh& mesh, const TriangleMesh& part) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    const bool colored = mesh.colors.size() == mesh.positions.size() && part.colors.size() == part.positions.size();
    mesh.positions.insert(mesh.positions.end(), part.positions.begin(), part.positions.end());
    mesh.indices.reserve(mesh.indices.size() + part.indices.size());
    for (const std::uint32_t index : part.indices) mesh.indices.push_back(first + index);
    if (colored) mesh.colors.insert(mesh.colors.end(), part.colors.begin(), part.colors.end());
    if (!colored) mesh.colors.clear();
}

}  // namespace crofton
