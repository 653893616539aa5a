// SPDX-License-Identifier: MIT
// A mesh cut into clusters, as the functions of several headers see it.
#pragma once
#include <crofton/capi/modules.h>

#include <crofton/core/memory.hpp>
#include <crofton/depth/clustered_mesh.hpp>
#include <cstdint>
#include <mutex>

#include <crofton/capi/call.hpp>

namespace crofton::capi {

// The clusters of a mesh as an array, which C has. A mesh that nobody asks for needs none.
class ClusterRanges {
  public:
    // They stay until it is called with another mesh.
    [[nodiscard]] const crofton_cluster* of(const depth::ClusteredMesh& mesh) {
        if (mesh_ != mesh.identity()) {
            ranges_.clear();
            for (const depth::Cluster cluster : mesh.clusters())
                ranges_.push_back({cluster.first_triangle, cluster.triangle_count});
            mesh_ = mesh.identity();
        }
        return ranges_.data();
    }

  private:
    std::uint64_t mesh_ = 0;  // ClusteredMesh::identity()
    Vector<crofton_cluster> ranges_;
};

}  // namespace crofton::capi

struct crofton_clustered_mesh {
    static constexpr std::uint32_t kKind = 0x43724f0d;
    crofton::capi::Header header;
    crofton::depth::ClusteredMesh mesh;
    mutable std::mutex mutex{};
    mutable crofton::capi::ClusterRanges ranges{};  // of `mesh`; guarded
};
