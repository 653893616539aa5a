// SPDX-License-Identifier: MIT
// A view by the depth of its picture: the triangles to draw.
#pragma once
#include <crofton/core/executor.hpp>
#include <crofton/cull/cull.hpp>
#include <crofton/depth/depth_culler.hpp>
#include <crofton/scene/scene.hpp>
#include <crofton/world/inputs.hpp>

#include "mesh_clusters.hpp"
#include "object_table.hpp"
#include "spatial_index.hpp"

namespace crofton::world {

// Kept from frame to frame.
class PictureView {
  public:
    // Of what the frustum sees, in the order given. Requires a view that is checked.
    void find(const ViewRequest& request, const cull::VisibleSet& in_frustum, const ObjectTable& table,
              const SpatialIndex& index, const scene::Scene& scene, const MeshClusters& clusters, Executor& executor);

    [[nodiscard]] std::span<const depth::VisibleCluster> triangles() const { return triangles_; }
    // Of in_frustum: its places that are seen, in its order.
    [[nodiscard]] std::span<const std::uint32_t> ids() const { return ids_; }
    [[nodiscard]] std::size_t inside_count() const { return inside_count_; }
    [[nodiscard]] std::span<const cull::Verdict> verdicts() const { return verdicts_; }
    [[nodiscard]] const depth::DepthStatistics& statistics() const { return culler_.statistics(); }

  private:
    depth::DepthCuller culler_;
    Vector<depth::DepthObject> objects_;
    Vector<std::uint32_t> places_;  // of objects_, in the list of what the frustum sees
    Vector<std::uint8_t> seen_;     // by place
    Vector<depth::VisibleCluster> triangles_;
    Vector<std::uint32_t> ids_;
    Vector<cull::Verdict> verdicts_;
    std::size_t inside_count_ = 0;
};

// Of a size that a picture can have, and of a view that it can be drawn from. `item`: of the error.
[[nodiscard]] Result<void> check_picture(const ViewRequest& request, std::uint64_t item);

}  // namespace crofton::world
