// SPDX-License-Identifier: MIT
// Lights per froxel, and shadow casters.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/core/executor.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/geometry/shapes.hpp>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <span>

namespace crofton::cull {

// Lights per froxel: which lights reach which cell of a grid over the view volume.

struct FroxelOptions {
    std::uint32_t columns = 16, rows = 9, slices = 24;
    // slices + 1 ascending distances along `forward`; the grid reaches from the first to the last. If empty: from near
    // to far, in equal ratios (perspective) or in equal steps (orthographic).
    std::span<const double> depths = {};
};

// A grid over a camera's view. Columns and rows divide the picture evenly: column 0 is at its left, row 0 at its
// bottom, slice 0 at the near plane.
//
// It stores one plane between every two columns, rows and slices, and one at each end. A froxel is the exact, closed
// set of points between its six planes, taken as reals; neighbours share a plane.
class FroxelGrid {
  public:
    // Builds a grid. Errors: as validate(Camera); a size of 0 or above 1024 along an axis; far infinite and no depths
    // given; depths that are not slices + 1, not ascending, closer than 2^-20 of their magnitude or, in perspective,
    // not positive; a view wider or higher than 176 degrees; numbers beyond 1e12.
    [[nodiscard]] static Result<FroxelGrid> build(const Camera& camera, const FroxelOptions& options = {});

    // All are 0 for a grid that was not built or has been moved from. find_lights lists nothing for it.
    [[nodiscard]] std::uint32_t columns() const { return count(0); }
    [[nodiscard]] std::uint32_t rows() const { return count(1); }
    [[nodiscard]] std::uint32_t slices() const { return count(2); }
    [[nodiscard]] std::size_t size() const { return std::size_t{count(0)} * count(1) * count(2); }
    // Returns the index of a froxel. Columns are numbered fastest, then rows, then slices.
    [[nodiscard]] std::uint32_t index(std::uint32_t column, std::uint32_t row, std::uint32_t slice) const {
        return (slice * rows() + row) * columns() + column;
    }
    // Returns the six planes of a froxel: left, right, bottom, top, near, far. Requires an index below size().
    [[nodiscard]] Frustum froxel(std::uint32_t index) const;
    [[nodiscard]] std::span<const double> depths() const { return depths_; }

  private:
    friend class LightPass;
    [[nodiscard]] std::uint32_t count(int axis) const {
        return planes_[axis].empty() ? 0 : static_cast<std::uint32_t>(planes_[axis].size() - 1);
    }

    glm::dvec3 origin_{0.0}, axes_[3] = {};  // right, up, forward
    Vector<Plane> planes_[3];                // those that keep what is to the right, above, beyond
    Vector<double> depths_;
    Vector<double> doubles_;  // for kernels: src/lights/froxel_kernel.hpp
    Vector<float> floats_;
    double spread_ = 1.0, start_ = 0.0;
};

// A spot light, a cone with a spherical cap: the points x with |x − apex| ≤ range and (x − apex) · axis ≥
// cos_half_angle · |x − apex| · |axis|.
//
// `axis` is not zero and need not have length 1. Components below 2^-30 of the largest are read as 0, as are cosines
// below 2^-30. cos_half_angle is in [0, 1]: at most a half sphere.
struct SpotLight {
    glm::dvec3 apex{0.0};
    glm::vec3 axis{0.0f, 0.0f, -1.0f};
    float cos_half_angle = 0.70710678f;
    float range = 1.0f;
};

// The lights of each froxel, in the layout of a GPU buffer. Keeps its memory.
class FroxelLights {
  public:
    // The lights of froxel f are lights()[offsets()[f]] … lights()[offsets()[f + 1] − 1], ascending.
    [[nodiscard]] std::span<const std::uint32_t> offsets() const { return offsets_; }
    [[nodiscard]] std::span<const std::uint32_t> lights() const {
        return std::span(lights_).first(offsets_.empty() ? 0 : offsets_.back());
    }
    [[nodiscard]] std::span<const std::uint32_t> lights_of(std::uint32_t froxel) const {
        return lights().subspan(offsets_[froxel], offsets_[froxel + 1] - offsets_[froxel]);
    }
    // Returns the number of pairs that exact arithmetic decided.
    [[nodiscard]] std::uint64_t exact_tests() const { return exact_tests_; }

  private:
    friend class LightPass;
    struct Run {
        std::uint32_t froxel, light, mask;  // bit l: froxel + l
    };
    struct Part {
        Vector<Run> runs;
        std::size_t count = 0;
        std::uint64_t exact_tests = 0;
    };
    Vector<std::uint32_t> offsets_, lights_;  // `lights_` as long as its largest use so far
    Vector<Part> parts_;
    std::uint64_t exact_tests_ = 0;
};

// Lists for every froxel the lights that share a point with it. The lists are exact for the stored numbers; touching
// counts.
//
// Light i is points[i]; light points.size() + i is spots[i]. The lists have the same bits with any executor and on any
// instruction set. Allocates nothing once `result` has been used for as much. A point light with nonzero numbers below
// 1e-60 may be listed where it only nearly touches an edge.
//
// Errors, which leave `result` unchanged (`item` is the light's number): a light that is not finite or beyond 1e12; a
// negative radius or range; a cosine outside [0, 1]; a zero axis; more than 2^32 − 1 pairs.
[[nodiscard]] Result<void> find_lights(const FroxelGrid& grid, std::span<const Sphere> points,
                                       std::span<const SpotLight> spots, FroxelLights& result,
                                       Executor& executor = serial_executor());

// ---- Shadow casters and cascades ----

// The parts of a view's shadow receivers that a light could reach, as seen from the light.
//
// Each tile of a picture from the light stores the nearest and the farthest point of any receiver within the view. A
// caster is wanted if in some tile it reaches nearer than the farthest of them. A caster is never refused if its shadow
// falls on a point of a receiver's box within the view. How many others are wanted depends on the number of tiles.
// Keeps its memory: setting it again for as many tiles allocates nothing.
class CasterFilter {
  public:
    static constexpr std::uint32_t kDefaultTiles = 128;  // along each side of the picture, or of a cube's face

    // Sets a distant light. A shadow ends `shadow_length` behind its caster.
    //
    // Errors, here and below: a direction or a light that is zero, not finite or negative; a view that is not finite;
    // no tiles or more than 1024; a receiver that fails validate(Obb), named by its index. The receiver set is then
    // empty and wants no caster.
    [[nodiscard]] Result<void> set_sun(const Frustum& view, std::span<const Obb> receivers,
                                       const glm::dvec3& toward_light,
                                       double shadow_length = std::numeric_limits<double>::infinity(),
                                       std::uint32_t tiles = kDefaultTiles);
    // Sets a light at a point, with the sphere's range: a cube of six pictures.
    [[nodiscard]] Result<void> set_point(const Frustum& view, std::span<const Obb> receivers, const Sphere& light,
                                         std::uint32_t tiles = kDefaultTiles);
    // Sets a spot light: one picture along the axis, or a cube if the half angle is above 75 degrees.
    [[nodiscard]] Result<void> set_spot(const Frustum& view, std::span<const Obb> receivers, const SpotLight& light,
                                        std::uint32_t tiles = kDefaultTiles);

    // Tests whether a caster is wanted. A box that fails validate(Obb) is wanted.
    [[nodiscard]] bool wants(const Obb& caster) const;
    // Lists the indices of the wanted casters, ascending.
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
    std::uint32_t tiles_ = 0;
    ResetOnMove<std::uint32_t> face_count_;
    bool is_sun_ = true;
    glm::dvec3 origin_{0.0};
    double range_ = 0.0;    // how far a shadow goes: of the sun behind its caster, else from the light
    double tangent_ = 0.0;  // of a spot's half angle, or 0
    Face faces_[6];
    Vector<Tile> grid_;  // by face, row, column
};

// Computes split depths by the practical split scheme (Zhang, Sun, Xu, Lun: "Parallel-split shadow maps", 2006).
//
// splits[i], i ≤ count, is `share` of the way from equal steps to equal ratios between near and far. Fills `splits`,
// which has one element more than there are cascades. Errors: fewer than two elements; near, far, far / near or share
// not finite, near ≤ 0, far ≤ near, share outside [0, 1].
[[nodiscard]] Result<void> split_depths(double near, double far, double share, std::span<double> splits);

// Returns the sun's orthographic camera around the part of `camera`'s view between two depths.
//
// It is the smallest rectangle perpendicular to the light, and begins `caster_distance` before the first visible point.
// Errors: as validate(Camera) with these depths; a direction that is zero or not finite; a distance that is negative or
// not finite.
[[nodiscard]] Result<Camera> cascade_camera(const Camera& camera, double near, double far,
                                            const glm::dvec3& toward_light, double caster_distance);

}  // namespace crofton::cull
