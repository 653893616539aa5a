// SPDX-License-Identifier: MIT
// Clusters of meshes, as C has them.
#pragma once
#include <crofton/capi/view.h>

#include <crofton/depth/clustered_mesh.hpp>
#include <crofton/depth/depth_culler.hpp>
#include <cstddef>

#include <crofton/capi/clustered_mesh.hpp>

namespace crofton::capi {

static_assert(CROFTON_MAX_CLUSTER_TRIANGLES == depth::Cluster::kMaxTriangles);
static_assert(sizeof(crofton_cluster_box) == sizeof(depth::ClusterBox) &&
              offsetof(crofton_cluster_box, half_edges) == offsetof(depth::ClusterBox, half_edges));
static_assert(sizeof(crofton_visible_cluster) == sizeof(depth::VisibleCluster) &&
              offsetof(crofton_visible_cluster, cluster) == offsetof(depth::VisibleCluster, cluster) &&
              offsetof(crofton_visible_cluster, triangles) == offsetof(depth::VisibleCluster, triangles));

[[nodiscard]] inline crofton_clusters to_c_clusters(const depth::ClusteredMesh& mesh, ClusterRanges& ranges) {
    return {ranges.of(mesh), mesh.clusters().size(), mesh.triangle_order().data(), mesh.triangle_order().size()};
}

}  // namespace crofton::capi
