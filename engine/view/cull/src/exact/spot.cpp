// SPDX-License-Identifier: MIT
// Spot light against convex volume, exactly. If they share a point, so do the volume, the light's cone and the sphere
// of its range. Then the point of volume and cone nearest to the apex is in that sphere. It is the apex; or the foot of
// the apex on a plane, on the line of two planes or the corner of three. Or it is on the cone's surface: the end of the
// shortest way along it to a plane, or where the line of two planes pierces it. So it is enough to ask whether any of
// these points lies in volume, cone and sphere. Each is (X + Y √D) / W with sums and products for X, Y, D and W, and so
// is the sign of A + B √D, by squares.
#include "exact/spot.hpp"

#include <array>
#include <cmath>
#include <type_traits>

#include "exact/numbers.hpp"

namespace crofton::cull {
namespace {

template <class Number>
Vector3<Number> operator*(const Vector3<Number>& a, const Number& f) {
    return {a[0] * f, a[1] * f, a[2] * f};
}
template <class Number>
Vector3<Number> plus(const Vector3<Number>& a, const Vector3<Number>& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
template <class Number>
Vector3<Number> minus(const Vector3<Number>& a, const Vector3<Number>& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

template <class Number>
class SpotTest {
  public:
    static constexpr bool kExact = std::is_same_v<Number, Exact>;

    SpotTest(const Frustum& frustum, const SpotLight& spot)
        : frustum_(frustum),
          range_(static_cast<double>(spot.range)),
          cosine_(static_cast<double>(spot.cos_half_angle)) {
        for (int j = 0; j < 3; ++j) axis_[static_cast<std::size_t>(j)] = Number(static_cast<double>(spot.axis[j]));
        square_ = dot(axis_, axis_);
        for (std::uint32_t i = 0; i < frustum.plane_count; ++i) {
            const Plane& plane = frustum.planes[i];
            value_[i] = Number(plane.offset);
            for (int j = 0; j < 3; ++j) {
                normal_[i][static_cast<std::size_t>(j)] = Number(plane.normal[j]);
                value_[i] = value_[i] + Number(plane.normal[j]) * (Number(spot.apex[j]) - Number(frustum.origin[j]));
            }
        }
    }

    [[nodiscard]] Answer run() {
        note(try_apex());
        for (std::uint32_t i = 0; result_ != Answer::yes && i < frustum_.plane_count; ++i) {
            try_foot(i);
            try_rays(i);
            for (std::uint32_t j = i + 1; result_ != Answer::yes && j < frustum_.plane_count; ++j) {
                if (are_parallel(i, j)) continue;
                try_line(i, j);
                for (std::uint32_t k = j + 1; k < frustum_.plane_count; ++k)
                    if (!are_parallel(i, k) && !are_parallel(j, k)) try_corner(i, j, k);
            }
        }
        return result_;
    }

  private:
    // (x + y √d) / w relative to the apex, w > 0.
    struct Point {
        Vector3<Number> x, y;
        Number d, w;
        bool has_root, on_cone;
        std::uint32_t on_planes;
    };

    static Answer at_least_zero(const Number& a) {
        if (a.is_negative()) return Answer::no;
        return kExact || a.is_positive() ? Answer::yes : Answer::unknown;
    }
    // a + b √d ≥ 0, d ≥ 0
    static Answer at_least_zero(const Number& a, const Number& b, const Number& d) {
        const Answer of_a = at_least_zero(a), of_b = at_least_zero(b);
        if (of_a == of_b && of_a != Answer::unknown) return of_a;
        const Number difference = a * a - b * b * d;  // which of the two outweighs the other
        if (difference.is_positive()) return of_a;
        if (difference.is_negative()) return of_b;
        return kExact ? Answer::yes : Answer::unknown;
    }

    void note(Answer answer) {
        if (answer == Answer::yes || (answer == Answer::unknown && result_ == Answer::no)) result_ = answer;
    }

    bool are_parallel(std::uint32_t i, std::uint32_t j) const {
        const glm::dvec3 &a = frustum_.planes[i].normal, &b = frustum_.planes[j].normal;
        return a == b || a == -b;
    }

    Answer try_apex() const {
        Answer result = Answer::yes;
        for (std::uint32_t i = 0; i < frustum_.plane_count; ++i) {
            const Answer one = at_least_zero(value_[i]);
            if (one == Answer::no) return one;
            if (one == Answer::unknown) result = one;
        }
        return result;
    }

    // Is the point in volume, cone and sphere?
    Answer contains(const Point& p) const {
        Answer result = Answer::yes;
        const auto fails = [&](Answer one) {
            if (one == Answer::unknown) result = one;
            return one == Answer::no;
        };
        const auto sign = [&](const Number& a, const Number& b) {
            return p.has_root ? at_least_zero(a, b, p.d) : at_least_zero(a);
        };
        for (std::uint32_t i = 0; i < frustum_.plane_count; ++i)
            if (!(p.on_planes >> i & 1) && fails(sign(dot(normal_[i], p.x) + value_[i] * p.w, dot(normal_[i], p.y))))
                return Answer::no;
        const Number ax = dot(axis_, p.x), ay = dot(axis_, p.y);
        if (fails(sign(ax, ay))) return Answer::no;
        const Number xx = p.has_root ? dot(p.x, p.x) + dot(p.y, p.y) * p.d : dot(p.x, p.x);
        const Number xy = dot(p.x, p.y), two(2.0);
        const Number limit = cosine_ * cosine_ * square_;
        if (!p.on_cone) {
            const Number along = p.has_root ? ax * ax + ay * ay * p.d : ax * ax;
            if (fails(sign(along - limit * xx, two * (ax * ay - limit * xy)))) return Answer::no;
        }
        if (fails(sign(range_ * range_ * p.w * p.w - xx, Number(0.0) - two * xy))) return Answer::no;
        return result;
    }

    // With w of any sign; where it is 0 there is no such point.
    void try_point(Point p) {
        if (result_ == Answer::yes) return;
        if (p.w.is_negative()) {
            const Number minus_one(-1.0);
            p.x = p.x * minus_one;
            p.y = p.y * minus_one;
            p.w = p.w * minus_one;
        }
        if (p.w.is_positive())
            note(contains(p));
        else if (!kExact)
            note(Answer::unknown);
    }
    void try_rational(const Vector3<Number>& x, const Number& w, std::uint32_t on_planes) {
        try_point({x, {}, Number(0.0), w, false, false, on_planes});
    }
    // Both signs of the root; what has none is no point.
    void try_roots(const Vector3<Number>& x, const Vector3<Number>& y, const Number& d, const Number& w,
                   std::uint32_t on_planes) {
        if (d.is_negative()) return;
        if (!kExact && !d.is_positive()) return note(Answer::unknown);
        try_point({x, y, d, w, true, true, on_planes});
        try_point({x, y * Number(-1.0), d, w, true, true, on_planes});
    }

    void try_foot(std::uint32_t i) {
        try_rational(normal_[i] * (Number(0.0) - value_[i]), dot(normal_[i], normal_[i]), 1u << i);
    }

    // The rays of the cone's surface in the plane of axis and normal: along a c M ± m √D, with m = n |a|² − (n·a) a, M
    // = |m|², D = (1 − c²) |a|² M. They meet the plane at −s times that over n · it = P ± Q √D.
    void try_rays(std::uint32_t i) {
        const Number along = dot(normal_[i], axis_);
        const Vector3<Number> m = minus(normal_[i] * square_, axis_ * along);
        const Number size = dot(m, m), d = (Number(1.0) - cosine_ * cosine_) * square_ * size;
        const Number p = cosine_ * size * along, q = dot(normal_[i], m);
        const Vector3<Number> straight = axis_ * (cosine_ * size);
        const Number minus_s = Number(0.0) - value_[i];
        try_roots(minus(straight * p, m * (q * d)) * minus_s, minus(m * p, straight * q) * minus_s, d,
                  p * p - q * q * d, 1u << i);
    }

    // The line of two planes: its foot, and where the cone's surface is, (a·y)² = c² |a|² |y|².
    void try_line(std::uint32_t i, std::uint32_t j) {
        const Vector3<Number> line = cross(normal_[i], normal_[j]);
        const Number size = dot(line, line);
        const Vector3<Number> foot = plus(cross(line, normal_[j]) * value_[i], cross(normal_[i], line) * value_[j]);
        const std::uint32_t planes = 1u << i | 1u << j;
        try_rational(foot, size, planes);
        const Number limit = cosine_ * cosine_ * square_;
        const Number al = dot(axis_, line), af = dot(axis_, foot);
        const Number a = al * al - limit * size, b = al * af - limit * dot(line, foot),
                     c = af * af - limit * dot(foot, foot);
        if (!kExact || a.is_negative() || a.is_positive())
            try_roots(minus(foot * a, line * b), line, b * b - a * c, a * size, planes);
        else  // 2 b t + c = 0
            try_point({minus(foot * (b + b), line * c), {}, Number(0.0), (b + b) * size, false, true, planes});
    }

    void try_corner(std::uint32_t i, std::uint32_t j, std::uint32_t k) {
        const Vector3<Number> jk = cross(normal_[j], normal_[k]), ki = cross(normal_[k], normal_[i]),
                              ij = cross(normal_[i], normal_[j]);
        const Vector3<Number> sum = plus(plus(jk * value_[i], ki * value_[j]), ij * value_[k]);
        try_rational(sum * Number(-1.0), dot(normal_[i], jk), 1u << i | 1u << j | 1u << k);
    }

    const Frustum& frustum_;
    Answer result_ = Answer::no;
    Vector3<Number> normal_[Frustum::kMaxPlanes], axis_;
    Number value_[Frustum::kMaxPlanes], square_, range_, cosine_;
};

}  // namespace

SpotLight as_read(const SpotLight& spot) {
    SpotLight result = spot;
    float largest = 0.0f;
    for (int j = 0; j < 3; ++j) largest = std::fmax(largest, std::fabs(spot.axis[j]));
    for (int j = 0; j < 3; ++j)
        result.axis[j] =
            std::fabs(spot.axis[j]) < 0x1p-30f * largest ? 0.0f : std::ldexp(spot.axis[j], -std::ilogb(largest));
    if (spot.cos_half_angle < 0x1p-30f) result.cos_half_angle = 0.0f;
    return result;
}

bool meets(const Frustum& frustum, const SpotLight& spot) {
    const Answer answer = SpotTest<Bounded>(frustum, spot).run();
    if (answer != Answer::unknown) return answer == Answer::yes;
    return SpotTest<Exact>(frustum, spot).run() == Answer::yes;
}

}  // namespace crofton::cull
