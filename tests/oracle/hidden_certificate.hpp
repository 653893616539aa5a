// SPDX-License-Identifier: MIT
// Oracle: the proof, in rational numbers, that a box is hidden in a picture. Either the box is in the shadow of one of
// the named occluders. Or each pixel square that its picture meets is behind one of them: all of it, and nearer than
// any point of the box, or with all of the box behind the occluder's faces.
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
        std::vector<Vec3q> points;
        Rational nearest;
        for (unsigned i = 0; i < 8; ++i) {
            const Vec3q y = corner_of(box, i);
            const Rational t = view_.perspective ? form(2, y) : -form(3, y), w = form(2, y);
            if (t < near_) return false;
            if (i == 0 || t < nearest) nearest = t;
            points.push_back(y);
            picture.push_back({form(0, y) / w * scale_[0] + half_[0], form(1, y) / w * scale_[1] + half_[1]});
        }
        if (is_in_shadow(points, named) || is_in_shadow(part_in_picture(box), named)) return true;
        std::vector<bool> behind;
        for (const Obb& occluder : named) behind.push_back(is_behind(points, occluder));
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
                if (meets(picture, x, y) && !is_covered(x, y, nearest, named, behind)) return false;
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

    // n · y + d ≥ 0.
    struct HalfSpace {
        Vec3q n;
        Rational d;

        [[nodiscard]] Rational at(const Vec3q& y) const { return n[0] * y[0] + n[1] * y[1] + n[2] * y[2] + d; }
    };
    // The corners of what the picture shows of a box: where three planes of the two meet.
    [[nodiscard]] std::vector<Vec3q> part_in_picture(const Obb& box) const {
        std::vector<HalfSpace> planes;
        const Frame frame = frame_of(box);
        for (std::size_t k = 0; k < 3; ++k)
            for (const int sign : {-1, 1}) {
                HalfSpace plane{cross(frame.axes[(k + 1) % 3], frame.axes[(k + 2) % 3]), frame.half[k]};
                for (Rational& v : plane.n) v *= Rational(sign) / frame.volume;
                plane.d -= plane.at(frame.center) - plane.d;
                planes.push_back(plane);
            }
        for (std::size_t r = 0; r < 2; ++r)
            for (const int sign : {-1, 1}) {
                HalfSpace plane;
                for (std::size_t k = 0; k < 3; ++k)
                    plane.n[k] = sign * scale_[r] * rows_[r][k] + half_[r] * rows_[2][k];
                plane.d = sign * scale_[r] * rows_[r][3] + half_[r] * rows_[2][3];
                planes.push_back(plane);
            }
        std::vector<Vec3q> found;
        for (std::size_t a = 0; a < planes.size(); ++a)
            for (std::size_t b = a + 1; b < planes.size(); ++b)
                for (std::size_t c = b + 1; c < planes.size(); ++c) {
                    const HalfSpace &p = planes[a], &q = planes[b], &r = planes[c];
                    const Rational volume = determinant(p.n, q.n, r.n);
                    if (volume == 0) continue;
                    const Vec3q qr = cross(q.n, r.n), rp = cross(r.n, p.n), pq = cross(p.n, q.n);
                    Vec3q y;
                    for (std::size_t k = 0; k < 3; ++k) y[k] = -(p.d * qr[k] + q.d * rp[k] + r.d * pq[k]) / volume;
                    if (std::all_of(planes.begin(), planes.end(), [&](const HalfSpace& h) { return h.at(y) >= 0; }))
                        found.push_back(y);
                }
        return found;
    }
    // The shadow of a convex body is convex.
    [[nodiscard]] bool is_in_shadow(const std::vector<Vec3q>& points, std::span<const Obb> named) const {
        std::vector<Line> lines;
        std::vector<Rational> distances;
        for (const Vec3q& y : points) {
            distances.push_back(view_.perspective ? form(2, y) : Rational(-form(3, y)));
            lines.push_back(line_to(y, distances.back()));
        }
        return !points.empty() && std::any_of(named.begin(), named.end(),
                                              [&](const Obb& occluder) { return covers(lines, distances, occluder); });
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
    [[nodiscard]] Line line_to(const Vec3q& point, const Rational& t) const {
        Line line;
        if (!view_.perspective) line = line_through(0, 0);
        for (std::size_t k = 0; k < 3; ++k) {
            if (view_.perspective) line.along[k] = point[k] / t;
            line.from[k] = view_.perspective ? Rational(0) : Rational(point[k] - t * line.along[k]);
        }
        return line;
    }

    // A box's own coordinates of a point, or of a direction.
    struct Frame {
        std::array<Vec3q, 3> axes;
        Vec3q center;
        std::array<Rational, 3> half;
        Rational volume;

        [[nodiscard]] Rational coordinate(std::size_t k, const Vec3q& v) const {
            return determinant(v, axes[(k + 1) % 3], axes[(k + 2) % 3]) / volume;
        }
    };
    [[nodiscard]] Frame frame_of(const Obb& box) const {
        Frame frame{{rational(box.axes[0]), rational(box.axes[1]), rational(box.axes[2])},
                    minus(rational(box.center), rational(view_.origin)),
                    {},
                    {}};
        frame.volume = determinant(frame.axes[0], frame.axes[1], frame.axes[2]);
        for (std::size_t k = 0; k < 3; ++k) frame.half[k] = Rational(double(box.half_extents[int(k)]));
        return frame;
    }

    // On the inner side of each face that looks towards the eye. A ray that meets the occluder enters it by one of
    // these faces, where it comes to the inner side of the last of them: before any such point. Faces that lie before
    // the near plane do not count: squares are covered only where rays enter beyond it.
    [[nodiscard]] bool is_behind(const std::vector<Vec3q>& points, const Obb& box) const {
        const Frame frame = frame_of(box);
        for (std::size_t k = 0; k < 3; ++k) {
            bool low, high;
            if (view_.perspective) {
                const Rational eye = frame.coordinate(k, minus(Vec3q{0, 0, 0}, frame.center));
                low = eye < -frame.half[k];
                high = eye > frame.half[k];
            } else {
                const Rational slope = frame.coordinate(k, line_through(0, 0).along);
                low = slope > 0;
                high = slope < 0;
            }
            low = low && reaches_beyond_near(box, k, false);
            high = high && reaches_beyond_near(box, k, true);
            for (const Vec3q& point : points) {
                const Rational at = frame.coordinate(k, minus(point, frame.center));
                if ((low && at < -frame.half[k]) || (high && at > frame.half[k])) return false;
            }
        }
        return true;
    }

    // Rays through the four corners enter the occluder before `nearest`: the hull of the four points is inside of it,
    // and every ray of the square meets that hull before. Where the box is behind its faces, they need only meet it.
    [[nodiscard]] bool is_covered(long x, long y, const Rational& nearest, std::span<const Obb> named,
                                  const std::vector<bool>& behind) const {
        std::vector<Line> lines;
        for (long c = 0; c < 4; ++c) lines.push_back(line_through(x + (c & 1), y + (c >> 1)));
        const std::vector<Rational> before(4, nearest);
        for (std::size_t i = 0; i < named.size(); ++i)
            if (covers(lines, behind[i] ? std::vector<Rational>() : before, named[i])) return true;
        return false;
    }
    // Whether all rays enter the occluder, each before its distance where there is one. So that what is met is drawn,
    // either the occluder is beyond the near plane, or one face of it is entered beyond by all.
    [[nodiscard]] bool covers(const std::vector<Line>& lines, const std::vector<Rational>& before,
                              const Obb& box) const {
        const Frame frame = frame_of(box);
        std::array<bool, 6> beyond_near;
        beyond_near.fill(true);
        for (std::size_t l = 0; l < lines.size(); ++l) {
            const Vec3q from = minus(lines[l].from, frame.center);
            Rational enter, leave;
            bool enters = false;
            for (std::size_t k = 0; k < 3; ++k) {
                const Rational at = frame.coordinate(k, from), slope = frame.coordinate(k, lines[l].along);
                const Rational& half = frame.half[k];
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
            if (enter > leave || enter < near_ || (!before.empty() && enter >= before[l])) return false;
        }
        return is_beyond_near(box) ||
               std::any_of(beyond_near.begin(), beyond_near.end(), [](bool beyond) { return beyond; });
    }
    [[nodiscard]] bool corner_is_beyond_near(const Obb& box, unsigned i) const {
        const Vec3q y = corner_of(box, i);
        return (view_.perspective ? form(2, y) : Rational(-form(3, y))) >= near_;
    }
    [[nodiscard]] bool is_beyond_near(const Obb& box) const {
        bool beyond = true;
        for (unsigned i = 0; i < 8; ++i) beyond = beyond && corner_is_beyond_near(box, i);
        return beyond;
    }
    [[nodiscard]] bool reaches_beyond_near(const Obb& box, std::size_t axis, bool high) const {
        bool reaches = false;
        for (unsigned i = 0; i < 8; ++i)
            reaches = reaches || ((i >> axis & 1u) == unsigned(high) && corner_is_beyond_near(box, i));
        return reaches;
    }

    const occlude::OcclusionView& view_;
    Rational near_;
    std::array<std::array<Rational, 4>, 4> rows_;
    std::array<std::uint32_t, 2> size_;
    std::array<Rational, 2> half_, scale_;
};

}  // namespace crofton::oracle
