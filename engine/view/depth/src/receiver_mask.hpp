// SPDX-License-Identifier: MIT
// Where a shadow map is looked up for what a camera sees, and how far from the light.
//
// Boxes of clusters, then triangles, then parts of triangles are projected into the map, until a part is small there.
// Parts of large triangles are also asked against the camera's depth, as clusters are.
#pragma once
#include <array>
#include <crofton/core/memory.hpp>
#include <crofton/depth/depth_culler.hpp>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

#include "culler_data.hpp"
#include "depth_frame.hpp"
#include "strip_walk.hpp"

namespace crofton::depth {

// What a camera's culler found.
struct SeenPicture {
    const DepthFrame& frame;
    std::span<const VisibleCluster> clusters;  // by object
    std::span<const StripWalk> strips;         // with the depth of all samples; none if a pixel has several
};

class ReceiverMask {
  public:
    void find(const SeenPicture& seen, const ShadowReceivers& receivers, const PictureView& map);

    // For each tile of the map, row by row: no point that is seen looks it up with a lesser nearness than this.
    // Infinity where none looks it up.
    [[nodiscard]] std::span<const float> floors() const { return floors_; }
    [[nodiscard]] bool is_empty() const { return empty_; }  // nothing looks the map up

  private:
    // A part of a triangle of the object at hand.
    struct Piece {
        std::array<glm::dvec3, 3> corners;
        float nearest;  // of the whole triangle, in the camera's picture
        float slope;    // of its depth there, for each pixel: |across| + |up|
    };

    void begin(const SeenPicture& seen, const ShadowReceivers& receivers, const PictureView& map);
    void add_object(const DepthReceiver& receiver, const DepthObject& drawn, std::span<const VisibleCluster> clusters);
    void add_clusters(const ClusteredMesh& mesh, std::span<const VisibleCluster> clusters);
    void add_triangles(const ClusteredMesh& mesh, const VisibleCluster& cluster);
    void add_pieces();
    void split(const Piece& piece, std::uint32_t level);
    // Projects boxes_ into the map: nearness is negated, so the bound is that of the farthest point.
    void project_into_map();
    void mark(const Projection& in_map);
    void mark_everything();

    [[nodiscard]] bool is_small(const Projection& in_map) const;
    // True of points that the light does not see: behind it, or before the near plane.
    [[nodiscard]] bool is_before_light(const Cluster& box) const;
    [[nodiscard]] bool is_seen(const Piece& piece, Projection in_picture) const;

    PictureData map_{}, picture_{};
    ObjectData in_map_{}, in_picture_{};  // of the object at hand
    std::span<const StripWalk> strips_;
    glm::vec2 widened_{1.0f};  // of the map's clip coordinates, so that lookups from beyond its sides are inside
    float true_near_share_ = 0.0f;
    std::uint32_t columns_ = 0;
    std::int32_t small_ = 0;  // texels
    std::size_t splits_left_ = 0;
    bool everything_ = false, empty_ = true;
    Vector<float> floors_;
    Vector<Piece> pieces_, next_;
    Vector<Cluster> boxes_;
    Vector<Projection> map_projections_, picture_projections_;
};

}  // namespace crofton::depth
