// SPDX-License-Identifier: MIT
// Which objects throw a shadow onto something that the view sees? And cascades for the sun.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/cull/froxels.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/geometry/shapes.hpp>
#include <cstdint>
#include <limits>
#include <span>

namespace crofton::cull {

// What of the view's receivers a light could reach, as seen from the light: for each tile of a picture from there the
// nearest and the farthest point of any receiver within the view. A caster is wanted if in some tile it reaches nearer
// than the farthest of them. Never refuses a caster whose shadow falls on a point of a receiver's box within the view;
// how many others it keeps is a matter of the tiles. Keeps its memory: setting it again for as many tiles allocates
// nothing.
class ShadowReceivers {
  public:
    static constexpr std::uint32_t kDefaultTiles = 128;  // along each side of the picture, or of a cube's face

    // A far light. A shadow ends `reach` behind its caster. Errors, here and below: a direction or a light that is
    // zero, not finite or negative; a view that is not finite; no tiles or more than 1024; a receiver that fails
    // validate(Obb), named by its index. A receiver set is then empty, and wants no caster.
    [[nodiscard]] Result<void> set_sun(const Frustum& view, std::span<const Obb> receivers,
                                       const glm::dvec3& toward_light,
                                       double reach = std::numeric_limits<double>::infinity(),
                                       std::uint32_t tiles = kDefaultTiles);
    // A light at a point, of the ball's range: a cube of six pictures.
    [[nodiscard]] Result<void> set_point(const Frustum& view, std::span<const Obb> receivers, const Sphere& light,
                                         std::uint32_t tiles = kDefaultTiles);
    // One picture along the axis; a cube if the half angle is above 75 degrees.
    [[nodiscard]] Result<void> set_spot(const Frustum& view, std::span<const Obb> receivers, const SpotLight& light,
                                        std::uint32_t tiles = kDefaultTiles);

    // A box that fails validate(Obb) is wanted.
    [[nodiscard]] bool wants(const Obb& caster) const;
    // The indices of those that are wanted, ascending.
    void find_casters(std::span<const Obb> casters, Vector<std::uint32_t>& wanted) const;

  private:
    friend class ReceiverPass;
    struct Tile {
        double nearest = std::numeric_limits<double>::infinity(), farthest = -nearest;
    };
    // A picture from the light. Sun: across, up and along in the frame's axes; else across / along, up / along.
    struct Face {
        glm::dvec3 axes[3];
        double low[2], size[2];  // of the picture, and of a tile
    };
    std::uint32_t tiles_ = 0, face_count_ = 0;
    bool is_sun_ = true;
    glm::dvec3 origin_{0.0};
    double reach_ = 0.0, tangent_ = 0.0;  // of a spot's half angle, or 0
    Face faces_[6];
    Vector<Tile> grid_;  // by face, row, column
};

// The practical split scheme (Zhang, Sun, Xu, Lun: "Parallel-split shadow maps", 2006): splits[i], i ≤ count, is
// `share` of the way from equal steps to equal ratios between near and far. Fills `splits`, which has a place more than
// there are cascades. Errors: fewer than two places; near, far or share not finite, near ≤ 0, far ≤ near, share outside
// [0, 1].
[[nodiscard]] Result<void> split_depths(double near, double far, double share, std::span<double> splits);

// The sun's orthographic camera around what `camera` sees between two depths: the smallest rectangle across the light,
// begun `caster_reach` before the first point that is seen. Errors: as validate(Camera) with these depths; a direction
// that is zero or not finite; a reach that is negative or not finite.
[[nodiscard]] Result<Camera> cascade_camera(const Camera& camera, double near, double far,
                                            const glm::dvec3& toward_light, double caster_reach);

}  // namespace crofton::cull
