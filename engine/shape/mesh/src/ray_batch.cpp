// SPDX-License-Identifier: MIT
// Tests many rays against one mesh, sixteen at a time.
#include <algorithm>
#include <crofton/mesh/mesh_parts.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <crofton/mesh/mesh_tree.hpp>

#include "ray_mesh.hpp"

namespace crofton::mesh {
namespace {

RayPacket packet_of(std::span<const Ray> rays) {
    RayPacket packet;
    packet.count = static_cast<std::uint32_t>(rays.size());
    for (std::size_t r = 0; r < kRayPacketWidth; ++r) {
        const Ray& ray = rays[r < rays.size() ? r : 0];
        for (int i = 0; i < 3; ++i) {
            packet.origin[i][r] = ray.origin[i];
            packet.direction[i][r] = ray.direction[i];
        }
        packet.max_t[r] = ray.max_t;
    }
    return packet;
}

bool cast_packet(std::span<const Ray> rays, const MeshTree& mesh, std::optional<TriangleHit>* hits) {
    const auto exact = [&](std::uint32_t ray, std::uint32_t leaf, std::uint32_t lane) {
        return meets(rays[ray], mesh, leaf, lane);
    };
    RayAnswer answers[kRayPacketWidth];
    if (!trace_packet(packet_of(rays), {ray_mesh_of(mesh), numbers_of(rays.front()), exact}, answers)) return false;
    for (std::size_t r = 0; r < rays.size(); ++r) {
        hits[r] = std::nullopt;
        if (answers[r].hit) hits[r] = TriangleHit{answers[r].t + 0.0, answers[r].triangle};
    }
    return true;
}

}  // namespace

void raycast(std::span<const Ray> rays, const MeshTree& mesh, std::span<std::optional<TriangleHit>> hits) {
    CROFTON_ASSERT(hits.size() >= rays.size(), "fewer hits than rays");
    const bool prepared = !mesh.parts().ray_nodes.empty();
    for (std::size_t begin = 0; begin < rays.size(); begin += kRayPacketWidth) {
        const std::size_t end = std::min(rays.size(), begin + kRayPacketWidth);
        const std::span<const Ray> some = rays.subspan(begin, end - begin);
        if (prepared && some.size() > 2 && cast_packet(some, mesh, hits.data() + begin)) continue;
        for (std::size_t r = begin; r < end; ++r) hits[r] = raycast(rays[r], mesh);
    }
}

}  // namespace crofton::mesh
