// SPDX-License-Identifier: MIT
// Oracle: the proof, in rational numbers, that a box is hidden in a picture. Each pixel square that the box's picture
// meets is behind one of the named occluders: all of it, and nearer than any point of the box.
#pragma once
#include <gmpxx.h>

#include <array>
#include <crofton/geometry/box.hpp>
#include <crofton/occlude/occlusion.hpp>
#include <oracle/exact_boxes.hpp>
#include <oracle/witness_rays.hpp>
#include <span>
#include <vector>

namespace crofton::oracle {

// The view's rays are taken from its rows, as they are stored; the picture leaves 2^-6 of a pixel free on each side.
class HiddenCertificate {
  public:
    HiddenCertificate(const occlude::OcclusionView& view, double near_distance, std::uint32_t width,
                      std::uint32_t height)
        : view_(view), near_(near_distance), size_{width, height} {
        for (std::size_t r = 0; r < 4; ++r)
            for (std::size_t k = 0; k < 4; ++k) rows_[r][k] = Rational(view.rows[r][k]);
        for (std::size_t k = 0; k < 2; ++k) {
            half_[k] = Rational(size_[k]) / 2;
            scale_[k] = half_[k] - Rational(1) / 64;
        }
    }

    // Whether there is a proof with these occluders. None for a box that comes before the near plane.
    [[nodiscard]] bool proves(const Obb& box, std::span<const Obb> named) const {
        std::vector<std::array<Rational, 2>> picture;
        Rational nearest;
        for (unsigned i = 0; i < 8; ++i) {
            const Vec3q y = corner_of(box, i);
            const Rational t = view_.perspective ? form(2, y) : -form(3, y), w = form(2, y);
            if (t < near_) return false;
            if (i == 0 || t < nearest) nearest = t;
            picture.push_back({form(0, y) / w * scale_[0] + half_[0], form(1, y) / w * scale_[1] + half_[1]});
        }
        std::array<long, 2> first{}, last{};
        for (std::size_t k = 0; k < 2; ++k) {
            Rational low = picture[0][k], high = low;
            for (const auto& p : picture) {
                if (p[k] < low) low = p[k];
                if (p[k] > high) high = p[k];
            }
            // A square is closed: one that the picture only touches counts.
            first[k] = clamp(ceil_of(low) - 1, k);
            last[k] = clamp(floor_of(high), k);
        }
        for (long y = first[1]; y <= last[1]; ++y)
            for (long x = first[0]; x <= last[0]; ++x)
                if (meets(picture, x, y) && !is_covered(x, y, nearest, named)) return false;
        return true;
    }

  private:
    // Relative to the view's origin.
    [[nodiscard]] Vec3q corner_of(const Obb& box, unsigned i) const {
        Vec3q y = minus(rational(box.center), rational(view_.origin));
        for (int k = 0; k < 3; ++k) {
            const Rational half((i >> k & 1u) ? double(box.half_extents[k]) : -double(box.half_extents[k]));
            for (std::size_t j = 0; j < 3; ++j) y[j] += half * Rational(double(box.axes[k][int(j)]));
        }
        return y;
    }
    [[nodiscard]] Rational form(std::size_t r, const Vec3q& y) const {
        return rows_[r][0] * y[0] + rows_[r][1] * y[1] + rows_[r][2] * y[2] + rows_[r][3];
    }
    static long floor_of(const Rational& v) {
        mpz_class result;
        mpz_fdiv_q(result.get_mpz_t(), v.get_num_mpz_t(), v.get_den_mpz_t());
        return result.get_si();
    }
    static long ceil_of(const Rational& v) { return -floor_of(-v); }
    [[nodiscard]] long clamp(long v, std::size_t k) const {
        return std::max(0l, std::min(v, static_cast<long>(size_[k]) - 1));
    }

    // Whether the closed square meets the convex hull of the points: no line through two of them parts the two, and the
    // square's own sides do not.
    static bool meets(const std::vector<std::array<Rational, 2>>& points, long x, long y) {
        const std::array<Rational, 2> at{Rational(x), Rational(y)};
        for (std::size_t k = 0; k < 2; ++k) {
            bool below = true, above = true;
            for (const auto& p : points) {
                below = below && p[k] < at[k];
                above = above && p[k] > at[k] + 1;
            }
            if (below || above) return false;
        }
        for (const auto& a : points)
            for (const auto& b : points) {
                const auto side = [&](const Rational& px, const Rational& py) -> Rational {
                    return (b[0] - a[0]) * (py - a[1]) - (b[1] - a[1]) * (px - a[0]);
                };
                bool all_left = true, all_right = true;
                for (const auto& p : points) all_left = all_left && side(p[0], p[1]) >= 0;
                for (long c = 0; c < 4 && all_left; ++c)
                    all_right = all_right && side(at[0] + (c & 1), at[1] + (c >> 1)) < 0;
                if (all_left && all_right) return false;
            }
        return true;
    }

    // The ray through a corner of pixels: from + t · along, t its distance along the view's axis.
    struct Line {
        Vec3q from, along;
    };
    [[nodiscard]] Line line_through(long x, long y) const {
        const Rational u = (x - half_[0]) / scale_[0], v = (y - half_[1]) / scale_[1];
        const std::size_t third = view_.perspective ? 2 : 3;
        const auto solve = [&](const Rational& a, const Rational& b, const Rational& c) {
            const auto row = [&](std::size_t r) { return Vec3q{rows_[r][0], rows_[r][1], rows_[r][2]}; };
            const Vec3q p = row(0), q = row(1), r = row(third);
            const Rational volume = determinant(p, q, r);
            const Vec3q qr = cross(q, r), rp = cross(r, p), pq = cross(p, q);
            Vec3q result;
            for (std::size_t k = 0; k < 3; ++k) result[k] = (a * qr[k] + b * rp[k] + c * pq[k]) / volume;
            return result;
        };
        if (view_.perspective) return {Vec3q{0, 0, 0}, solve(u, v, 1)};
        return {solve(u - rows_[0][3], v - rows_[1][3], -rows_[3][3]), solve(0, 0, -1)};
    }
    // Rays through the four corners enter the occluder before `nearest`: the hull of the four points is inside of it,
    // and every ray of the square meets that hull before. One face is entered beyond the near plane by all four, so
    // that what is met is drawn.
    [[nodiscard]] bool is_covered(long x, long y, const Rational& nearest, std::span<const Obb> named) const {
        std::array<Line, 4> lines;
        for (long c = 0; c < 4; ++c) lines[std::size_t(c)] = line_through(x + (c & 1), y + (c >> 1));
        for (const Obb& box : named)
            if (covers(lines, nearest, box)) return true;
        return false;
    }
    [[nodiscard]] bool covers(const std::array<Line, 4>& lines, const Rational& nearest, const Obb& box) const {
        const std::array<Vec3q, 3> axes = {rational(box.axes[0]), rational(box.axes[1]), rational(box.axes[2])};
        const Rational volume = determinant(axes[0], axes[1], axes[2]);
        std::array<bool, 6> beyond_near;
        beyond_near.fill(true);
        for (const Line& line : lines) {
            const Vec3q from = minus(line.from, minus(rational(box.center), rational(view_.origin)));
            Rational enter, leave;
            bool enters = false;
            for (std::size_t k = 0; k < 3; ++k) {
                const Vec3q &u = axes[(k + 1) % 3], &v = axes[(k + 2) % 3];
                const Rational at = determinant(from, u, v) / volume, slope = determinant(line.along, u, v) / volume;
                const Rational half(double(box.half_extents[int(k)]));
                if (slope == 0) {  // in this slab or beside it, all along
                    if (abs(at) > half) return false;
                    beyond_near[2 * k] = beyond_near[2 * k + 1] = false;
                    continue;
                }
                const Rational low = (slope > 0 ? Rational(-half - at) : Rational(half - at)) / slope,
                               high = (slope > 0 ? Rational(half - at) : Rational(-half - at)) / slope;
                const std::size_t face = 2 * k + (slope > 0 ? 0 : 1);
                beyond_near[face] = beyond_near[face] && low >= near_;
                beyond_near[2 * k + (slope > 0 ? 1 : 0)] = false;
                if (!enters || low > enter) enter = low;
                if (!enters || high < leave) leave = high;
                enters = true;
            }
            if (enter > leave || enter >= nearest || enter < near_) return false;
        }
        return std::any_of(beyond_near.begin(), beyond_near.end(), [](bool beyond) { return beyond; });
    }

    const occlude::OcclusionView& view_;
    Rational near_;
    std::array<std::array<Rational, 4>, 4> rows_;
    std::array<std::uint32_t, 2> size_;
    std::array<Rational, 2> half_, scale_;
};

}  // namespace crofton::oracle
