// SPDX-License-Identifier: MIT
// The drawing kernel's input: half-planes of the picture, and planes of depth.
#pragma once
#include <crofton/core/memory.hpp>
#include <crofton/occlude/occluder.hpp>
#include <cstdint>
#include <span>

#include "pixel_map.hpp"
#include "shape.hpp"

namespace crofton::occlude {

// A half-plane of the picture, rounded inward: in row j it holds the columns from (or up to) x + slope · (j − y).
// Columns and rows are counted from the picture's corner; `y` has the row's worse end in it.
struct Side {
    float x, slope, y;
};

// nearness ≥ base + across · i + up · j anywhere in the square of pixel (i, j), where the plane's face is what is seen.
struct DepthPlane {
    float base, across, up;
};

// A half-space: x · column + y · row + w ≥ z · nearness, in pixels from the middle. A body's shadow is where all of its
// planes hold: what is there and in the picture is hidden by the body. z is 1 for the planes of its faces, which hold
// behind them; and 0 for the sides of its picture.
struct ShadowPlane {
    float x, y, w, z;
};
inline constexpr std::size_t kShadowLanes = 8;       // planes a group, in four rows
inline constexpr std::size_t kMaxShadowPlanes = 64;  // of a body

inline constexpr std::size_t kMaxPlanes = 32;  // of a body

// Covers the squares within all sides; the nearness there is at least the least of the planes.
struct PreparedBody {
    std::uint32_t first_side, left_count, right_count;  // left sides first
    std::uint32_t first_plane, plane_count;
    std::uint32_t first_row, end_row;
    std::uint32_t first_shadow;  // group of its shadow's planes, those of the faces first: a plane_count of them
    std::uint32_t shadow_count;  // 0: too many
    float most_nearness;         // of any of its points, or more
    OccluderId occluder;
};

// Pixels that a piece of a mesh covers, by tiles: columns [first_column, end_column) of rows [first_row, end_row).
struct PreparedPatch {
    std::uint32_t first_column, first_row, end_column, end_row;
    std::size_t first_value;  // in PreparedBodies::values: 64 a tile, kUncovered where nothing is covered
    OccluderId occluder;
};

// A point after the map: column, row, w, z, and the values of the cuts.
struct MappedPoint {
    double form[4];
    double cut[2];
};

// In pixels from the picture's corner, and its nearness.
struct PixelPoint {
    double x, y, nearness;
    bool usable;  // beyond the cuts, certainly
};

struct PreparedBodies {
    Vector<PreparedBody> bodies;
    Vector<Side> sides;
    Vector<DepthPlane> planes;
    Vector<float> shadows;  // groups of planes: eight of each coefficient; the last plane fills its group up
    Vector<PreparedPatch> patches;
    Vector<float> values;
    Vector<std::uint64_t> reached;  // a word for each 64 values: which of them are covered
    std::uint64_t triangles = 0;    // that were drawn one by one

    // Scratch memory of prepare().
    Vector<std::uint8_t> seen, facing;
    Vector<Side> left, right;
    Vector<ShadowPlane> fronts, lines;
    Vector<MappedPoint> points;
    Vector<PixelPoint> pixels;
    Vector<std::uint64_t> contour;

    void clear() {
        bodies.clear();
        sides.clear();
        planes.clear();
        shadows.clear();
        patches.clear();
        values.clear();
        reached.clear();
        triangles = 0;
    }
};

// Bounds of a body's numbers: size[r] ≥ Σ|form_k| |x_k| over its points, for the four forms. Each number of a mapped
// point is within kMapError of that.
struct MapSizes {
    double form[4];
    double cut[2];
};
// With u = 2^-53, these round: a difference to the origin (u), a product with a row that is itself a product with a
// transform's (3 u and 3 u), sums of up to seven terms (7 u). In all 14 u < 2^-49.
inline constexpr double kMapError = 0x1p-49;

struct Body {
    std::span<const MappedPoint> points;
    std::span<const ShapeFace> faces;  // planar
    std::span<const ShapeEdge> edges;
    MapSizes sizes;
    bool mirrored;
    double behind = 0.0;  // how far its faces may be behind their planes, in nearness
};

// Appends the body to `out`, if it covers anything: the faces that look towards the eye, within their common contour.
// Any faces will do (docs/notes/occlude.md); those of a convex body, or of a convex polygon, lose nothing.
void prepare(const PixelMap& map, const Body& body, OccluderId occluder, PreparedBodies& out);

void prepare_box(const PixelMap& map, const Obb& box, OccluderId occluder, PreparedBodies& out);

// Maps the points of a shape that has been placed; they are `out`'s until the next call.
struct PlacedPoints {
    std::span<const MappedPoint> points;
    MapSizes sizes;
};
[[nodiscard]] PlacedPoints map_points(const PixelMap& map, const Shape& shape, const Transform& transform,
                                      Vector<MappedPoint>& points);
void prepare_convex(const PixelMap& map, const Shape& shape, const Transform& transform, bool mirrored,
                    OccluderId occluder, PreparedBodies& out);

// A surface with an outline, as a body of one face. False where it must be drawn triangle by triangle: it crosses the
// near plane, or not all of its triangles certainly show the same side.
[[nodiscard]] bool prepare_polygon(const PixelMap& map, const Shape& shape, const PlacedPoints& placed, bool mirrored,
                                   OccluderId occluder, PreparedBodies& out);

// A mesh or a surface: what each connected piece of it covers, pixel by pixel, by the rule of contours. Triangles that
// cross the near plane are bodies of their own.
void prepare_mesh(const PixelMap& map, const Shape& shape, const Transform& transform, bool mirrored,
                  OccluderId occluder, PreparedBodies& out);

}  // namespace crofton::occlude
