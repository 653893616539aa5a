// SPDX-License-Identifier: MIT
// Meshes: a pixel is covered if a triangle that faces the eye meets it, and no edge of the contour does.
#include <algorithm>
#include <cmath>

#include "buffer_data.hpp"
#include "map_bounds.hpp"
#include "mesh_kernel.hpp"
#include "prepared.hpp"

namespace crofton::occlude {
namespace {

// Larger than any rounding in double of rows and columns below 4096.
constexpr double kLeastMargin = 0x1p-16;

class MeshPreparation {
  public:
    MeshPreparation(const PixelMap& map, const Shape& shape, const PlacedPoints& placed, bool mirrored,
                    OccluderId occluder, PreparedBodies& out)
        : map_(map),
          shape_(shape),
          placed_(placed),
          mirrored_(mirrored),
          occluder_(occluder),
          bounds_(map, placed.sizes),
          out_(out) {}

    void run() {
        if (!project()) return;
        out_.facing.assign(shape_.triangle_count(), 0);
        for (const ShapePiece& piece : shape_.pieces) add_piece(piece);
    }

  private:
    // Returns false if rounding could move points by a noticeable part of a pixel, or if nothing is beyond the cuts.
    bool project() {
        const MapSizes& sizes = placed_.sizes;
        out_.pixels.resize(placed_.points.size());
        double least_w = HUGE_VAL, most = -HUGE_VAL, least = HUGE_VAL, largest = 0.0;
        for (std::size_t i = 0; i < placed_.points.size(); ++i) {
            const MappedPoint& p = placed_.points[i];
            PixelPoint& pixel = out_.pixels[i];
            pixel.usable = p.form[2] >= map_.least_w;
            for (int c = 0; c < map_.cut_count; ++c) pixel.usable = pixel.usable && p.cut[c] > kMapError * sizes.cut[c];
            if (!pixel.usable) continue;
            const double inverse = 1.0 / p.form[2];
            pixel.x = p.form[0] * inverse + map_.half_width;
            pixel.y = p.form[1] * inverse + map_.half_height;
            pixel.nearness = p.form[3] * inverse;
            least_w = std::min(least_w, p.form[2]);
            most = std::max(most, pixel.nearness);
            least = std::min(least, pixel.nearness);
            largest = std::max({largest, std::fabs(pixel.x), std::fabs(pixel.y)});
        }
        bounds_.nearness = std::max(std::fabs(most), std::fabs(least));
        const double moved = 2.0 * kMapError *
                             (sizes.form[0] + sizes.form[1] + (largest + map_.width + map_.height) * sizes.form[2]) /
                             least_w;
        margin_ = kLeastMargin + moved;
        nearness_error_ = 2.0 * kMapError * (sizes.form[3] + bounds_.nearness * sizes.form[2]) / least_w;
        return least_w < HUGE_VAL ? moved < 0.125 && largest < 1e9 : true;
    }

    [[nodiscard]] bool is_usable(std::size_t t) const {
        const std::uint32_t* const i = &shape_.triangles[3 * t];
        return out_.pixels[i[0]].usable && out_.pixels[i[1]].usable && out_.pixels[i[2]].usable;
    }
    [[nodiscard]] const MappedPoint& corner(std::size_t t, std::size_t k) const {
        return placed_.points[shape_.triangles[3 * t + (mirrored_ ? 2 - k : k)]];
    }

    void add_piece(const ShapePiece& piece) {
        double low_x = HUGE_VAL, high_x = -HUGE_VAL, low_y = HUGE_VAL, high_y = -HUGE_VAL;
        bool any = false;
        for (std::size_t t = piece.first_triangle; t < piece.end_triangle; ++t) {
            if (!is_usable(t)) {
                add_alone(t);
                continue;
            }
            FacePlane plane;
            if (!find_plane(corner(t, 0), corner(t, 1), corner(t, 2), bounds_, plane)) continue;
            out_.facing[t] = 1;
            any = true;
            for (std::size_t k = 0; k < 3; ++k) {
                const PixelPoint& p = out_.pixels[shape_.triangles[3 * t + k]];
                low_x = std::min(low_x, p.x);
                high_x = std::max(high_x, p.x);
                low_y = std::min(low_y, p.y);
                high_y = std::max(high_y, p.y);
            }
        }
        if (!any || !(high_x > 0.0 && high_y > 0.0 && low_x < map_.width && low_y < map_.height)) return;
        const auto tile = [](double v, std::uint32_t size) {
            return static_cast<std::uint32_t>(std::clamp(std::floor(v), 0.0, size - 1.0)) / kTile;
        };
        patch_ = {tile(low_x, map_.width),       tile(low_y, map_.height), tile(high_x, map_.width) + 1,
                  tile(high_y, map_.height) + 1, out_.values.size(),       occluder_};
        const std::size_t tiles =
            std::size_t{patch_.end_column - patch_.first_column} * (patch_.end_row - patch_.first_row);
        out_.values.resize(patch_.first_value + tiles * kTilePixels, HUGE_VALF);
        out_.reached.resize(patch_.first_value / kTilePixels + tiles, 0);
        out_.contour.assign(tiles, 0);
        set_target();
        for (std::size_t t = piece.first_triangle; t < piece.end_triangle; ++t)
            if (out_.facing[t]) add_triangle(t);
        for (std::size_t e = piece.first_edge; e < piece.end_edge; ++e) add_contour(shape_.edges[e]);
        finish_patch_kernel(target_, tiles);
        out_.patches.push_back(patch_);
    }

    // Clips a triangle that crosses a cut, within its own three edges.
    void add_alone(std::size_t t) {
        const MappedPoint points[3] = {placed_.points[shape_.triangles[3 * t]],
                                       placed_.points[shape_.triangles[3 * t + 1]],
                                       placed_.points[shape_.triangles[3 * t + 2]]};
        static constexpr ShapeFace kFace[1] = {{0, 1, 2}};
        static constexpr ShapeEdge kEdges[3] = {{0, 1, 0, kNone}, {1, 2, 0, kNone}, {2, 0, 0, kNone}};
        PreparedBodies& out = out_;
        prepare(map_, {points, kFace, kEdges, placed_.sizes, mirrored_}, occluder_, out);
        ++out.triangles;
    }

    void set_target() {
        target_ = {out_.values.data() + patch_.first_value,
                   out_.reached.data() + patch_.first_value / kTilePixels,
                   out_.contour.data(),
                   patch_.first_column,
                   patch_.first_row,
                   patch_.end_column - patch_.first_column,
                   static_cast<double>(kTile * patch_.first_column),
                   static_cast<double>(kTile * patch_.first_row),
                   std::min<double>(kTile * patch_.end_column, map_.width) - 1.0,
                   std::min<double>(kTile * patch_.end_row, map_.height) - 1.0,
                   map_.half_width,
                   map_.half_height,
                   margin_};
    }

    void add_triangle(std::size_t t) {
        const MappedPoint &a = corner(t, 0), &b = corner(t, 1), &c = corner(t, 2);
        FacePlane plane;
        if (!find_plane(a, b, c, bounds_, plane)) return;
        const Vec3 sides[3] = {cross(a, b), cross(b, c), cross(c, a)};
        PixelPoint points[3];
        for (std::size_t k = 0; k < 3; ++k) points[k] = out_.pixels[shape_.triangles[3 * t + k]];
        const double farthest =
            std::min({points[0].nearness, points[1].nearness, points[2].nearness}) - nearness_error_;
        const Line& n = plane.nearness;
        // Includes the rounding of the evaluation.
        const double range = std::fabs(n.x) * map_.width + std::fabs(n.y) * map_.height + std::fabs(n.w);
        const double lower = plane.error + 0x1p-50 * range + 0.5 * (std::fabs(n.x) + std::fabs(n.y));
        // How far from the triangle a centre may be, in units of its barycentric coordinates. The square around it,
        // which extends half a pixel, then still meets the triangle (docs/notes/occlude.md).
        const double extent =
            std::max({points[0].x, points[1].x, points[2].x}) - std::min({points[0].x, points[1].x, points[2].x}) +
            std::max({points[0].y, points[1].y, points[2].y}) - std::min({points[0].y, points[1].y, points[2].y}) + 2.0;
        const double limit = 0.05 * plane.determinant / extent;
        ++out_.triangles;
        draw_triangle_kernel({{points[0].x, points[1].x, points[2].x},
                              {points[0].y, points[1].y, points[2].y},
                              {n.x, n.y, n.w},
                              lower,
                              farthest,
                              {{sides[0].x, sides[0].y, sides[0].w},
                               {sides[1].x, sides[1].y, sides[1].w},
                               {sides[2].x, sides[2].y, sides[2].w}},
                              {c.form[2], a.form[2], b.form[2]},
                              bounds_.line,
                              limit},
                             target_);
    }

    void add_contour(const ShapeEdge& edge) {
        const bool left = out_.facing[edge.left] != 0, right = edge.right != kNone && out_.facing[edge.right] != 0;
        if (left == right) return;
        const PixelPoint &a = out_.pixels[edge.a], &b = out_.pixels[edge.b];
        draw_contour_kernel({{a.x, b.x}, {a.y, b.y}}, target_);
    }

    const PixelMap& map_;
    const Shape& shape_;
    const PlacedPoints& placed_;
    bool mirrored_;
    OccluderId occluder_;
    Bounds bounds_;
    PreparedBodies& out_;
    PreparedPatch patch_{};
    PatchTarget target_{};
    double margin_ = 0.0, nearness_error_ = 0.0;
};

}  // namespace

void prepare_mesh(const PixelMap& map, const Shape& shape, const Transform& transform, bool mirrored,
                  OccluderId occluder, PreparedBodies& out) {
    const PlacedPoints placed = map_points(map, shape, transform, out.points);
    const bool turned = mirrored != map.mirrored;
    const auto prepare_side = [&](bool side) {
        if (!shape.outline.empty() && prepare_polygon(map, shape, placed, side, occluder, out)) return;
        MeshPreparation(map, shape, placed, side, occluder, out).run();
    };
    prepare_side(turned);
    if (shape.sides == Sides::both) prepare_side(!turned);
}

}  // namespace crofton::occlude
