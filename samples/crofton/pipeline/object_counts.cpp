// SPDX-License-Identifier: MIT
#include "object_counts.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>

namespace crofton::pipeline {

ObjectCounts ObjectCounter::count(const Drawables& drawables, const Frustum& frustum,
                                  std::span<const scene::InstanceId> visible, std::span<const cull::Verdict> verdicts) {
    ObjectCounts counts;
    for (const scene::InstanceId instance : visible) {
        const TriangleMesh& mesh = drawables.mesh(drawables.mesh_of(instance));
        counts.triangles_submitted += mesh.triangle_count();
        if (verdicts[instance] == cull::Verdict::inside) {
            counts.triangles_passed += mesh.triangle_count();
            continue;
        }
        const Transform world = drawables.world_of(instance);
        points_.resize(mesh.positions.size());
        outside_.resize(mesh.positions.size());
        bool all_inside = true;
        for (std::size_t i = 0; i < points_.size(); ++i) {
            points_[i] = world.linear * glm::dvec3(mesh.positions[i]) + world.translation;
            const glm::dvec3 p = points_[i] - frustum.origin;
            std::uint16_t outside = 0;
            for (std::uint32_t k = 0; k < frustum.plane_count; ++k) {
                const Plane& plane = frustum.planes[k];
                // Within 2^-48 of the sizes involved the sign is left to the exact test.
                const double rounding =
                    0x1p-48 * (std::abs(p.x) + std::abs(p.y) + std::abs(p.z) + std::abs(plane.offset) +
                               std::abs(points_[i].x) + std::abs(points_[i].y) + std::abs(points_[i].z));
                const double distance = glm::dot(plane.normal, p) + plane.offset;
                if (distance < -rounding) outside = static_cast<std::uint16_t>(outside | (1u << k));
                all_inside = all_inside && distance > rounding;
            }
            outside_[i] = outside;
        }
        std::uint64_t passed = 0;
        for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
            const std::uint32_t a = mesh.indices[t], b = mesh.indices[t + 1], c = mesh.indices[t + 2];
            if ((outside_[a] & outside_[b] & outside_[c]) != 0) continue;
            if (all_inside || intersects(frustum, points_[a], points_[b], points_[c])) ++passed;
        }
        counts.triangles_passed += passed;
        if (passed == 0 || all_inside) ++counts.improper;
    }
    return counts;
}

std::uint64_t ObjectCounter::count(const Drawables& drawables, const Frustum& frustum, const SceneClusters& clusters,
                                   std::span<const depth::VisibleCluster> visible) {
    std::uint64_t passed = 0;
    for (const depth::VisibleCluster& c : visible) {
        const scene::MeshId mesh_id = drawables.mesh_of(c.object);
        const TriangleMesh& mesh = drawables.mesh(mesh_id);
        const Transform world = drawables.world_of(c.object);
        const depth::ClusteredMesh& cut = *clusters.meshes[mesh_id];
        const std::uint32_t first = cut.clusters()[c.cluster].first_triangle;
        for (std::uint64_t left = c.triangles; left != 0; left &= left - 1) {
            const std::size_t t = cut.triangle_order()[first + static_cast<std::uint32_t>(std::countr_zero(left))];
            std::array<glm::dvec3, 3> p;
            for (std::size_t k = 0; k < 3; ++k)
                p[k] = world.linear * glm::dvec3(mesh.positions[mesh.indices[3 * t + k]]) + world.translation;
            passed += intersects(frustum, p[0], p[1], p[2]);
        }
    }
    return passed;
}

}  // namespace crofton::pipeline
