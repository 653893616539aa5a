// SPDX-License-Identifier: MIT
// Tests many rays against one mesh, sixteen at a time.
#include <algorithm>
#include <cmath>
#include <crofton/mesh/mesh_parts.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <glm/common.hpp>

#include "ray_mesh.hpp"

namespace crofton::mesh {
namespace {

// Whether a packet is worth it, of valid rays: they leave from nearly one place into nearly one direction, of equal
// signs. Rays that part soon are slower in a packet, as it visits what any of them does.
bool lie_together(std::span<const Ray> rays, double extent) {
    const Ray& first = rays[0];
    const glm::dvec3 size = glm::abs(first.direction);
    const double length = std::max({size.x, size.y, size.z});
    if (!(length > 1e-100 && length < 1e100)) return false;
    for (const Ray& ray : rays) {
        bool together = ray.max_t >= 0.0;
        for (int i = 0; i < 3; ++i) {
            together &= std::signbit(ray.direction[i]) == std::signbit(first.direction[i]);
            together &= std::abs(ray.direction[i] - first.direction[i]) <= 0.1 * length;
            together &= std::abs(ray.origin[i] - first.origin[i]) <= 0.0625 * extent;
        }
        if (!together) return false;
    }
    return rays.size() > 2;
}

void cast_packet(std::span<const Ray> rays, const MeshTree& mesh, std::optional<TriangleHit>* hits) {
    RayQuery queries[kRayPacketWidth];
    RayAnswer answers[kRayPacketWidth];
    for (std::size_t r = 0; r < rays.size(); ++r) queries[r] = query_of(rays[r], mesh, false);
    const auto exact = [&](std::uint32_t ray, std::uint32_t leaf, std::uint32_t lane) {
        return meets(rays[ray], mesh, leaf, lane);
    };
    trace_packet(std::span<const RayQuery>(queries, rays.size()), exact, std::span<RayAnswer>(answers, rays.size()));
    for (std::size_t r = 0; r < rays.size(); ++r) {
        hits[r] = std::nullopt;
        if (answers[r].hit) hits[r] = TriangleHit{answers[r].t, answers[r].triangle};
    }
}

}  // namespace

void raycast(std::span<const Ray> rays, const MeshTree& mesh, std::span<std::optional<TriangleHit>> hits) {
    CROFTON_ASSERT(hits.size() >= rays.size(), "fewer hits than rays");
    const bool prepared = !mesh.parts().ray_nodes.empty();
    for (std::size_t begin = 0; begin < rays.size(); begin += kRayPacketWidth) {
        const std::size_t end = std::min(rays.size(), begin + kRayPacketWidth);
        const std::span<const Ray> some = rays.subspan(begin, end - begin);
        if (prepared && lie_together(some, static_cast<double>(mesh.extent())))
            cast_packet(some, mesh, hits.data() + begin);
        else
            for (std::size_t r = begin; r < end; ++r) hits[r] = raycast(rays[r], mesh);
    }
}

}  // namespace crofton::mesh
