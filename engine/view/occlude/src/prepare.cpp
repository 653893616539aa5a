// SPDX-License-Identifier: MIT
// Projects an occluder and lists the edges that its drawing needs.
#include <algorithm>
#include <cmath>
#include <crofton/occlude/occluder.hpp>

#include "map_bounds.hpp"
#include "prepared.hpp"
#include "shape.hpp"

namespace crofton::occlude {
namespace {

class Preparation {
  public:
    Preparation(const PixelMap& map, const Body& body, OccluderId occluder, PreparedBodies& out)
        : map_(map), body_(body), bounds_(map, body.sizes), occluder_(occluder), out_(out) {}

    void run() {
        if (!classify_points()) return;
        result_.first_side = static_cast<std::uint32_t>(out_.sides.size());
        result_.first_plane = static_cast<std::uint32_t>(out_.planes.size());
        first_row_ = 0;
        end_row_ = map_.height;
        clip_rows();
        if (!add_faces() || !limit_planes() || !add_contour() || first_row_ >= end_row_) return discard();
        finish();
    }

  private:
    void discard() {
        out_.sides.resize(result_.first_side);
        out_.planes.resize(result_.first_plane);
    }

    // Returns false if all points are beyond one side of the window, or before a cut.
    bool classify_points() {
        const MapSizes& sizes = body_.sizes;
        double most_near = -HUGE_VAL, least_near = HUGE_VAL;
        bool all_before[2] = {true, true}, outside[4] = {true, true, true, true};
        crosses_[0] = crosses_[1] = false;
        low_ = HUGE_VAL;
        high_ = -HUGE_VAL;
        for (const MappedPoint& p : body_.points) {
            for (int c = 0; c < map_.cut_count; ++c) {
                const double error = kMapError * sizes.cut[c];
                all_before[c] = all_before[c] && p.cut[c] <= error;
                crosses_[c] = crosses_[c] || !(p.cut[c] > error);
            }
            const double x = p.form[0], y = p.form[1], w = p.form[2];
            const double half_width = w * map_.half_width, half_height = w * map_.half_height;
            outside[0] = outside[0] && x < -half_width;
            outside[1] = outside[1] && x > half_width;
            outside[2] = outside[2] && y < -half_height;
            outside[3] = outside[3] && y > half_height;
            if (w < map_.least_w) continue;  // then it crosses, too
            const double inverse = 1.0 / w;
            low_ = std::min(low_, y * inverse);
            high_ = std::max(high_, y * inverse);
            most_near = std::max(most_near, p.form[3] * inverse);
            least_near = std::min(least_near, p.form[3] * inverse);
        }
        for (int c = 0; c < map_.cut_count; ++c)
            if (all_before[c]) return false;
        // For these tests alone w may have any sign: a point with w < 0 is not to the left where it says so.
        crossing_ = crosses_[0] || crosses_[1];
        if (!crossing_ && (outside[0] || outside[1] || outside[2] || outside[3])) return false;
        if (crossing_) most_near = map_.most_nearness;
        least_near_ = least_near;
        bounds_.nearness = std::max(std::fabs(most_near), std::fabs(std::min(least_near, most_near)));
        result_.most_nearness = static_cast<float>(most_near + 0x1p-22 * std::fabs(most_near));
        return true;
    }

    void clip_rows() {
        if (crossing_) return;
        first_row_ = static_cast<std::uint32_t>(std::clamp(low_ + map_.half_height, 0.0, 1.0 * map_.height));
        end_row_ = static_cast<std::uint32_t>(std::clamp(std::ceil(high_ + map_.half_height), 0.0, 1.0 * map_.height));
    }

    // Faces that certainly look towards the eye and reach beyond the cuts.
    bool add_faces() {
        out_.seen.assign(body_.faces.size(), 0);
        out_.fronts.clear();
        out_.lines.clear();
        out_.left.clear();
        out_.right.clear();
        bool any = false;
        for (std::size_t f = 0; f < body_.faces.size(); ++f) {
            const ShapeFace& face = body_.faces[f];
            const MappedPoint& a = body_.points[face.a];
            const MappedPoint& b = body_.points[body_.mirrored ? face.c : face.b];
            const MappedPoint& c = body_.points[body_.mirrored ? face.b : face.c];
            FacePlane plane;
            if (crossing_ && !reaches_beyond(a) && !reaches_beyond(b) && !reaches_beyond(c)) continue;
            if (!find_plane(a, b, c, bounds_, plane)) continue;
            out_.seen[f] = 1;
            any = true;
            const double error = plane.error + body_.behind;
            if (!add_plane(plane.nearness, error)) return false;
            if (crossing_ && !cut_face(plane.nearness, error)) return false;
        }
        return any;
    }

    // Certainly beyond the cuts. A face none of whose corners is must not count: its plane, drawn out, may come beyond.
    [[nodiscard]] bool reaches_beyond(const MappedPoint& p) const {
        bool beyond = true;
        for (int c = 0; c < map_.cut_count; ++c) beyond = beyond && p.cut[c] > kMapError * body_.sizes.cut[c];
        return beyond;
    }

    // Returns false if floats cannot hold the plane.
    bool add_plane(const Line& plane, double error) {
        // The middle of the corner's pixel, and from there to the farthest corner of the square.
        const double middle = plane.w + plane.x * (0.5 - map_.half_width) + plane.y * (0.5 - map_.half_height) -
                              0.5 * (std::fabs(plane.x) + std::fabs(plane.y));
        // Three coefficients and four operations are rounded to float, of terms that are not larger than `range`.
        const double range = std::fabs(middle) + std::fabs(plane.x) * map_.width + std::fabs(plane.y) * map_.height;
        if (!(range + error < 1e30)) return false;
        const double base = middle - error - 0x1p-21 * (range + bounds_.nearness);
        out_.planes.push_back({static_cast<float>(base), static_cast<float>(plane.x), static_cast<float>(plane.y)});
        out_.fronts.push_back(
            {static_cast<float>(plane.x), static_cast<float>(plane.y), static_cast<float>(plane.w - error), 1.0f});
        return true;
    }

    // For a body with many faces: no point of it is farther than its farthest corner.
    bool limit_planes() {
        if (out_.planes.size() - result_.first_plane <= kMaxPlanes) return true;
        if (crossing_) return false;
        out_.planes.resize(result_.first_plane);
        out_.fronts.clear();
        return add_plane({0.0, 0.0, least_near_}, kMapError * 4.0 * bounds_.nearness + farthest_error());
    }
    [[nodiscard]] double farthest_error() const {
        // z / w of a point: both are off, and w is at least the least.
        const MapSizes& sizes = body_.sizes;
        return 2.0 * kMapError * (sizes.form[3] + bounds_.nearness * sizes.form[2]) / map_.least_w;
    }

    // Only the part of this face beyond the cuts covers anything.
    bool cut_face(const Line& plane, double plane_error) {
        for (int c = 0; c < map_.cut_count; ++c) {
            if (!crosses_[c]) continue;
            const CutPlane& cut = map_.cuts[c];
            const Line line{cut.column + cut.nearness * plane.x, cut.row + cut.nearness * plane.y,
                            cut.constant + cut.nearness * plane.w};
            const double size = std::fabs(cut.column) * map_.half_width + std::fabs(cut.row) * map_.half_height +
                                std::fabs(cut.constant) + std::fabs(cut.nearness) * bounds_.nearness;
            if (!add_line(line, std::fabs(cut.nearness) * plane_error + 0x1p-40 * size)) return false;
        }
        return true;
    }

    // Edges with exactly one visible face, in the direction of that face.
    bool add_contour() {
        for (const ShapeEdge& edge : body_.edges) {
            const bool left = out_.seen[edge.left] != 0, right = edge.right != kNone && out_.seen[edge.right] != 0;
            if (left == right) continue;
            const MappedPoint &a = body_.points[edge.a], &b = body_.points[edge.b];
            bool before = false;
            for (int c = 0; c < map_.cut_count; ++c) {
                const double error = kMapError * body_.sizes.cut[c];
                before = before || (a.cut[c] < -error && b.cut[c] < -error);
            }
            if (before) continue;
            const Vec3 v = left != body_.mirrored ? cross(a, b) : cross(b, a);
            if (!add_line({v.x, v.y, v.w}, bounds_.line)) return false;
        }
        return true;
    }

    // Rounds the half-plane line ≥ error inward. Returns false if no square of the picture is left.
    bool add_line(const Line& line, double error) {
        const double w = line.w - error, ax = std::fabs(line.x), ay = std::fabs(line.y);
        const double most = ax * map_.half_width + ay * map_.half_height;
        if (!(w + most >= 0.0)) return false;             // also where it is not a number
        if (w - most >= 0.0) return true;                 // holds in the whole picture
        const double size = 1.0 / (most + std::fabs(w));  // of the line: 1
        out_.lines.push_back(
            {static_cast<float>(line.x * size), static_cast<float>(line.y * size), static_cast<float>(w * size), 0.0f});
        if (ax * kSteepest < ay || ax == 0.0) return add_row_limit(line.y, w - ax * map_.half_width);
        const double slope = -line.y / line.x, at_middle = -w / line.x;
        const double at_bottom = at_middle - slope * map_.half_height;
        const double at_top = at_middle + slope * map_.half_height;
        // A line that lies along the picture's rim may be a rounding beyond it at both ends: there it has no slope to
        // divide by.
        double x = at_bottom, y = -map_.half_height;
        if (std::fabs(at_bottom) > map_.half_width) {
            if (std::fabs(at_top) <= map_.half_width) {
                x = at_top;
                y = map_.half_height;
            } else if ((at_bottom < 0.0) != (at_top < 0.0)) {
                x = 0.0;
                y = -at_middle / slope;
            }
        }
        const bool left = line.x > 0.0;
        // In float: x, slope and y are rounded, a difference, a product and a sum are; |slope · difference| ≤ 2 width
        // where the result lies in the picture.
        const double margin = 0x1p-22 * (2.0 * map_.width + std::fabs(slope) * map_.height);
        // The worse of a row's two ends: at j + 1 − y it is that of j − (y − 1).
        const bool upper_end = (slope > 0.0) == left;
        const Side side{static_cast<float>(x + map_.half_width + (left ? margin : -margin)), static_cast<float>(slope),
                        static_cast<float>(y + map_.half_height - (upper_end ? 1.0 : 0.0))};
        (left ? out_.left : out_.right).push_back(side);
        return true;
    }

    // y · row + w ≥ 0.
    bool add_row_limit(double y, double w) {
        const double row = std::clamp(-w / y + map_.half_height, -1.0, map_.height + 1.0);
        if (y > 0.0)
            first_row_ = std::max(first_row_, static_cast<std::uint32_t>(std::max(0.0, std::ceil(row + kRowMargin))));
        else
            end_row_ = std::min(end_row_, static_cast<std::uint32_t>(std::max(0.0, std::floor(row - kRowMargin))));
        return first_row_ < end_row_;
    }

    void finish() {
        for (const Side& side : out_.left) out_.sides.push_back(side);
        for (const Side& side : out_.right) out_.sides.push_back(side);
        result_.left_count = static_cast<std::uint32_t>(out_.left.size());
        result_.right_count = static_cast<std::uint32_t>(out_.right.size());
        result_.plane_count = static_cast<std::uint32_t>(out_.planes.size()) - result_.first_plane;
        add_shadow();
        result_.first_row = first_row_;
        result_.end_row = end_row_;
        result_.occluder = occluder_;
        out_.bodies.push_back(result_);
    }

    void add_shadow() {
        result_.first_shadow = static_cast<std::uint32_t>(out_.shadows.size() / (4 * kShadowLanes));
        const std::size_t count = out_.fronts.size() + out_.lines.size();
        if (count > kMaxShadowPlanes) return;
        result_.shadow_count = static_cast<std::uint32_t>(count);
        for (const ShadowPlane& line : out_.lines) out_.fronts.push_back(line);
        const std::size_t groups = (count + kShadowLanes - 1) / kShadowLanes;
        for (std::size_t g = 0; g < groups; ++g)
            for (float ShadowPlane::*part : {&ShadowPlane::x, &ShadowPlane::y, &ShadowPlane::w, &ShadowPlane::z})
                for (std::size_t i = 0; i < kShadowLanes; ++i)
                    out_.shadows.push_back(out_.fronts[std::min(kShadowLanes * g + i, count - 1)].*part);
    }

    static constexpr double kSteepest = 1024.0;    // columns a row, beyond which a side counts as horizontal
    static constexpr double kRowMargin = 0x1p-20;  // of rows, whose division and sum round

    const PixelMap& map_;
    const Body& body_;
    Bounds bounds_;
    OccluderId occluder_;
    PreparedBodies& out_;
    PreparedBody result_{};
    bool crosses_[2] = {}, crossing_ = false;
    double low_ = 0.0, high_ = 0.0, least_near_ = 0.0;
    std::uint32_t first_row_ = 0, end_row_ = 0;
};

}  // namespace

void prepare(const PixelMap& map, const Body& body, OccluderId occluder, PreparedBodies& out) {
    Preparation(map, body, occluder, out).run();
}

}  // namespace crofton::occlude
