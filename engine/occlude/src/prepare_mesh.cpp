// SPDX-License-Identifier: MIT
// Meshes: a pixel is covered if a triangle that faces the eye meets it, and no edge of the contour does.
#include <algorithm>
#include <cmath>

#include "buffer_data.hpp"
#include "map_bounds.hpp"
#include "prepared.hpp"

namespace crofton::occlude {
namespace {

// Of a pixel, while a piece is drawn.
constexpr std::uint8_t kReached = 1, kOnContour = 2;

// Swamps what rounding in double does to rows and columns below 4096.
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
    // False where rounding could move points by a noticeable part of a pixel, or nothing is beyond the cuts.
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
        out_.states.assign(tiles * kTilePixels, 0);
        for (std::size_t t = piece.first_triangle; t < piece.end_triangle; ++t)
            if (out_.facing[t]) add_triangle(t);
        for (std::size_t e = piece.first_edge; e < piece.end_edge; ++e) add_contour(shape_.edges[e]);
        for (std::size_t i = 0; i < tiles * kTilePixels; ++i)
            if (out_.states[i] != kReached) out_.values[patch_.first_value + i] = kUncovered;
        out_.patches.push_back(patch_);
    }

    // A triangle that crosses a cut: cut off there, within its own three edges.
    void add_alone(std::size_t t) {
        const MappedPoint points[3] = {placed_.points[shape_.triangles[3 * t]],
                                       placed_.points[shape_.triangles[3 * t + 1]],
                                       placed_.points[shape_.triangles[3 * t + 2]]};
        static constexpr BodyFace kFace[1] = {{0, 1, 2}};
        static constexpr ShapeEdge kEdges[3] = {{0, 1, 0, kNone}, {1, 2, 0, kNone}, {2, 0, 0, kNone}};
        PreparedBodies& out = out_;
        prepare(map_, {points, kFace, kEdges, placed_.sizes, mirrored_}, occluder_, out);
        ++out.triangles;
    }

    // The pixel's place in the patch.
    [[nodiscard]] std::size_t place_of(std::int64_t x, std::int64_t y) const {
        const auto column = static_cast<std::size_t>(x), row = static_cast<std::size_t>(y);
        const std::size_t tile = (row / kTile - patch_.first_row) * (patch_.end_column - patch_.first_column) +
                                 column / kTile - patch_.first_column;
        return tile * kTilePixels + row % kTile * kTile + column % kTile;
    }

    // Calls visit(x, y) for the pixels of the patch whose squares the polygon's edges enclose or touch, or nearly
    // touch.
    template <std::size_t N, class Visit>
    void for_each_touched(const PixelPoint (&p)[N], const Visit& visit) const {
        double low_y = p[0].y, high_y = p[0].y;
        for (const PixelPoint& q : p) {
            low_y = std::min(low_y, q.y);
            high_y = std::max(high_y, q.y);
        }
        const double last_row = std::min<double>(kTile * patch_.end_row, map_.height) - 1.0;
        const double first_row = kTile * patch_.first_row;
        const double last_column = std::min<double>(kTile * patch_.end_column, map_.width) - 1.0;
        const double first_column = kTile * patch_.first_column;
        const auto begin = static_cast<std::int64_t>(std::max(first_row, std::floor(low_y - margin_)));
        const auto end = static_cast<std::int64_t>(std::min(last_row, std::floor(high_y + margin_)));
        for (std::int64_t y = begin; y <= end; ++y) {
            double left = HUGE_VAL, right = -HUGE_VAL;
            for (std::size_t i = 0; i < (N == 2 ? 1 : N); ++i)
                widen(p[i], p[(i + 1) % N], static_cast<double>(y), left, right);
            const auto from =
                static_cast<std::int64_t>(std::max(first_column, std::floor(std::min(left - margin_, 1e9))));
            const auto to =
                static_cast<std::int64_t>(std::min(last_column, std::floor(std::max(right + margin_, -1e9))));
            for (std::int64_t x = from; x <= to; ++x) visit(x, y);
        }
    }

    // By the part of the edge within a row.
    void widen(const PixelPoint& a, const PixelPoint& b, double row, double& left, double& right) const {
        const double from = std::max(row - margin_, std::min(a.y, b.y));
        const double to = std::min(row + 1.0 + margin_, std::max(a.y, b.y));
        if (from > to) return;
        const double low = std::min(a.x, b.x), high = std::max(a.x, b.x), up = b.y - a.y;
        if (std::fabs(up) < 0x1p-20) {
            left = std::min(left, low);
            right = std::max(right, high);
            return;
        }
        for (const double y : {from, to}) {
            const double x = std::clamp(a.x + (b.x - a.x) * ((y - a.y) / up), low, high);
            left = std::min(left, x);
            right = std::max(right, x);
        }
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
        // The evaluation rounds, too.
        const double range = std::fabs(n.x) * map_.width + std::fabs(n.y) * map_.height + std::fabs(n.w);
        const double lower = plane.error + 0x1p-50 * range + 0.5 * (std::fabs(n.x) + std::fabs(n.y));
        // How far from the triangle a centre may be, in units of its barycentric coordinates. The square around it,
        // which extends half a pixel, then still meets the triangle (docs/notes/occlude.md).
        const double extent =
            std::max({points[0].x, points[1].x, points[2].x}) - std::min({points[0].x, points[1].x, points[2].x}) +
            std::max({points[0].y, points[1].y, points[2].y}) - std::min({points[0].y, points[1].y, points[2].y}) + 2.0;
        const double limit = 0.05 * plane.determinant / extent;
        const double weights[3] = {c.form[2], a.form[2], b.form[2]};
        ++out_.triangles;
        for_each_touched(points, [&](std::int64_t column, std::int64_t row) {
            const double x = static_cast<double>(column) + 0.5 - map_.half_width;
            const double y = static_cast<double>(row) + 0.5 - map_.half_height;
            const double depth = std::max(n.x * x + n.y * y + n.w - lower, farthest);
            const std::size_t place = place_of(column, row);
            float& value = out_.values[patch_.first_value + place];
            value = std::min(value, static_cast<float>(depth - 0x1p-23 * std::fabs(depth)));
            double beyond = 0.0;
            for (std::size_t k = 0; k < 3; ++k) {
                const double inside = sides[k].x * x + sides[k].y * y + sides[k].w - bounds_.line;
                beyond += inside < 0.0 ? -inside * weights[k] : 0.0;
            }
            if (beyond <= limit) out_.states[place] |= kReached;
        });
    }

    void add_contour(const ShapeEdge& edge) {
        const bool left = out_.facing[edge.left] != 0, right = edge.right != kNone && out_.facing[edge.right] != 0;
        if (left == right) return;
        const PixelPoint ends[2] = {out_.pixels[edge.a], out_.pixels[edge.b]};
        for_each_touched(ends, [&](std::int64_t x, std::int64_t y) { out_.states[place_of(x, y)] |= kOnContour; });
    }

    const PixelMap& map_;
    const Shape& shape_;
    const PlacedPoints& placed_;
    bool mirrored_;
    OccluderId occluder_;
    Bounds bounds_;
    PreparedBodies& out_;
    PreparedPatch patch_{};
    double margin_ = 0.0, nearness_error_ = 0.0;
};

}  // namespace

void prepare_mesh(const PixelMap& map, const Shape& shape, const scene::Transform& transform, bool mirrored,
                  OccluderId occluder, PreparedBodies& out) {
    const PlacedPoints placed = map_points(map, shape, transform, out.points);
    const bool turned = mirrored != map.mirrored;
    MeshPreparation(map, shape, placed, turned, occluder, out).run();
    if (shape.sides == Sides::both) MeshPreparation(map, shape, placed, !turned, occluder, out).run();
}

}  // namespace crofton::occlude
