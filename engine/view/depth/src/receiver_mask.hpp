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
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <span>

#include "culler_data.hpp"
#include "strip_walk.hpp"

namespace crofton::depth {

// An object of a camera's picture of which something is listed.
struct SeenObject {
    std::uint32_t object = 0;
    std::uint64_t mesh = 0;  // ClusteredMesh::identity()
    ObjectData in_picture{};
    float position_error = 0.0f;
};

// What a camera's culler found.
struct SeenPicture {
    const PictureData& picture;  // without tiles
    std::span<const SeenObject> objects;
    std::span<const VisibleCluster> clusters;  // of those, in their order
    std::span<const StripWalk> strips;         // with the depth of all samples; none if a pixel has several
};

class ReceiverMask {
  public:
    // Requires receivers that are checked.
    void find(const SeenPicture& seen, const DepthReceivers& receivers, const PictureView& map);

    // For each tile of the map, row by row: no point that is seen looks it up with a lesser nearness than this.
    // Infinity where none looks it up.
    [[nodiscard]] std::span<const float> floors() const { return floors_; }
    [[nodiscard]] bool is_empty() const { return empty_; }  // nothing looks the map up

  private:
    // A part of a triangle of the object at hand.
    struct Piece {
        std::array<glm::dvec3, 3> corners;
        // Of the whole triangle, in the camera's picture. The triangle itself is seen.
        float nearest = std::numeric_limits<float>::infinity();
        float slope = 0.0f;  // of its depth there, for each pixel: |across| + |up|
    };
    // A piece in the camera's picture.
    struct PictureTriangle {
        std::array<glm::dvec3, 3> corners;  // pixels, and nearness
        bool before_eye = true;             // all of it; else the corners mean nothing
    };

    void begin(const SeenPicture& seen, const DepthReceivers& receivers, const PictureView& map);
    void add_object(const DepthReceiver& receiver, const SeenObject& seen, std::span<const VisibleCluster> clusters);
    void add_clusters(const ClusteredMesh& mesh, std::span<const VisibleCluster> clusters);
    void add_triangles(const ClusteredMesh& mesh, const VisibleCluster& cluster);
    void add_pieces();
    [[nodiscard]] PictureTriangle triangle_in_picture(const Piece& piece) const;
    [[nodiscard]] bool is_worth_splitting(const PictureTriangle& piece, const Projection& in_picture) const;
    void split(const Piece& piece, const PictureTriangle& placed, const Projection& in_picture, std::uint32_t level);
    // Projects boxes_ into the map: nearness is negated, so the bound is that of the farthest point.
    void project_into_map();
    void mark(const Projection& in_map);  // the whole rectangle
    void mark_triangle(const Piece& piece, const ClusterBox& box, const Projection& in_map);
    [[nodiscard]] MapTriangle triangle_in_map(const Piece& piece, const ClusterBox& box) const;
    void mark_everything();

    // True of points that the light does not see: behind it, or before the near plane.
    [[nodiscard]] bool is_before_light(const ClusterBox& box) const;
    [[nodiscard]] bool is_seen(const Piece& piece, Projection in_picture) const;
    [[nodiscard]] float nearness(std::uint32_t x, std::uint32_t y) const;  // of a pixel of the camera's picture

    PictureData map_{}, picture_{};
    ObjectData in_map_{}, in_picture_{};  // of the object at hand
    std::span<const StripWalk> strips_;
    glm::vec2 widened_{1.0f};  // of the map's clip coordinates, so that lookups from beyond its sides are inside
    float true_near_share_ = 0.0f;
    std::uint32_t columns_ = 0;
    std::int32_t small_ = 0, coarse_ = 0;  // texels
    std::size_t splits_left_ = 0;
    bool everything_ = false, empty_ = true;
    Vector<float> floors_;
    Vector<Piece> pieces_, next_;
    Vector<ClusterBox> boxes_;
    Owner<Patch> patch_;  // of the cluster at hand
    Vector<Projection> map_projections_, picture_projections_;
};

}  // namespace crofton::depth
