// SPDX-License-Identifier: MIT
// A view by the depth of its picture: the triangles to draw.
#pragma once
#include <crofton/core/executor.hpp>
#include <crofton/cull/cull.hpp>
#include <crofton/depth/depth_culler.hpp>
#include <crofton/world/inputs.hpp>

#include "mesh_clusters.hpp"
#include "shapes.hpp"

namespace crofton::world {

// Kept from frame to frame.
class PictureView {
  public:
    // What the frustum sees. Without verdicts, the first inside_count are inside.
    struct InFrustum {
        std::span<const std::uint32_t> ids;
        std::span<const cull::Verdict> verdicts;
        std::size_t inside_count = 0;
    };
    // What a picture asks of an object.
    struct Drawn {
        const MeshClusters::Mesh* clusters = nullptr;  // none: its box stands for it
        PlacedMesh placed = {};                        // with clusters
        bool occludes = false;
        Obb box = {};
    };
    using DrawnOf = FunctionRef<Drawn(std::uint32_t id)>;

    // Of what the frustum sees, in the order given. `seen`: null, or what looks the picture up as a shadow map.
    // Requires a view that is checked.
    void find(const ViewRequest& request, const InFrustum& in_frustum, const PictureView* seen, DrawnOf drawn_of,
              Executor& executor);

    [[nodiscard]] std::span<const depth::VisibleCluster> triangles() const { return triangles_; }
    // Of in_frustum: its places that are seen, in its order.
    [[nodiscard]] std::span<const std::uint32_t> ids() const { return ids_; }
    [[nodiscard]] std::size_t inside_count() const { return inside_count_; }
    [[nodiscard]] std::span<const cull::Verdict> verdicts() const { return verdicts_; }
    [[nodiscard]] const depth::DepthStatistics& statistics() const { return statistics_; }

  private:
    void place_receivers(const PictureView& seen, const ViewMatrix& view, DrawnOf drawn_of);

    depth::DepthCuller culler_;
    Vector<depth::DepthObject> objects_;
    Vector<std::uint32_t> object_ids_;        // of objects_
    Vector<depth::DepthReceiver> receivers_;  // of another's objects_
    Vector<std::uint32_t> places_;            // of objects_, in the list of what the frustum sees
    Vector<std::uint8_t> seen_;               // by place
    Vector<depth::VisibleCluster> triangles_;
    depth::DepthStatistics statistics_;  // without the boxes that stand for objects among what is listed
    Vector<std::uint32_t> ids_;
    Vector<cull::Verdict> verdicts_;
    std::size_t inside_count_ = 0;
};

// Of a size that a picture can have, and of a view that it can be drawn from. `item`: of the error.
[[nodiscard]] Result<void> check_picture(const ViewRequest& request, std::uint64_t item);

}  // namespace crofton::world
