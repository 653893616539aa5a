// SPDX-License-Identifier: MIT
// Decides whether two boxes overlap if they are closer to touching than rounding can tell.
#include <algorithm>
#include <bit>
#include <cmath>
#include <crofton/geometry/expansion.hpp>
#include <cstdint>

#include "box_pair.hpp"

namespace crofton::convex {
namespace {

// 0, or with an exponent that leaves products of four such numbers all their digits.
bool is_moderate(double value) {
    constexpr std::uint64_t kLeast = 1023 - 200, kSpan = 400;
    const std::uint64_t twice = std::bit_cast<std::uint64_t>(value) << 1;
    return static_cast<int>(twice == 0) | static_cast<int>((twice >> 53) - kLeast <= kSpan);
}
bool is_moderate(const glm::dvec3& v) {
    return static_cast<int>(is_moderate(v.x)) & static_cast<int>(is_moderate(v.y)) & static_cast<int>(is_moderate(v.z));
}
bool is_moderate(const ShapeAtPose& box) {
    const glm::dmat3& r = box.pose.rotation;
    return static_cast<int>(is_moderate(box.shape.half_extents())) &
           static_cast<int>(is_moderate(box.pose.translation)) & static_cast<int>(is_moderate(r[0])) &
           static_cast<int>(is_moderate(r[1])) & static_cast<int>(is_moderate(r[2]));
}

// a · b exactly; most numbers in poses of boxes that are not turned are 0 or 1.
detail::TwoTerms product(double a, double b) {
    if (b == 0.0 || b == 1.0) return {a * b, 0.0};
    return a == 0.0 || a == 1.0 ? detail::TwoTerms{a * b, 0.0} : detail::two_product(a, b);
}

bool is_difference_zero(double a, double b, double c, double d) {
    const auto p = product(a, b), q = product(c, d);
    return p.high == q.high && p.low == q.low;
}
// u × v = 0, exactly.
bool are_parallel(const glm::dvec3& u, const glm::dvec3& v) {
    return is_difference_zero(u.y, v.z, u.z, v.y) && is_difference_zero(u.z, v.x, u.x, v.z) &&
           is_difference_zero(u.x, v.y, u.y, v.x);
}

// Tests overlap along a coordinate exactly, for boxes with centers at a and b and with half extents along it.
bool overlap_along_line(double a, double b, double half_a, double half_b) {
    const double low = std::min(a, b), high = std::max(a, b);
    const auto apart = detail::two_sum(high, -low), radius = detail::two_sum(half_a, half_b);
    // The difference of two numbers as near as these is exact, and so is the sign of a sum of two.
    const double rough = radius.high - apart.high, rest = radius.low - apart.low;
    const bool close = apart.high <= 2.0 * radius.high && radius.high <= 2.0 * apart.high;
    if (close && (radius.low == 0.0 || apart.low == 0.0)) return rough + rest >= 0.0;
    return (exact_sum(half_a, half_b) - exact_difference(high, low)).sign() >= 0;
}

// The axes across edge i of a, and across edge j of b.
constexpr int products_with(int i, int j) {
    return (7 << 6) << 3 * i | (73 << 6) << j;
}

// A number of two doubles: `high` and what it lacks. Sums and products of such keep twice the digits.
struct Doubled {
    double high = 0.0, low = 0.0;
    void add(double term) {
        const auto [sum, rest] = detail::two_sum(high, term);
        high = sum;
        low += rest;
    }
    void add_product(const Doubled& a, double b) {
        const auto [product, rest] = detail::two_product(a.high, b);
        add(product);
        low += rest + a.low * b;
    }
    [[nodiscard]] double value() const { return high + low; }
};

// Boxes whose edges along coordinate k are upright are upright prisms over parallelograms. Their heights are told
// exactly. In the plane across, what is across each of the four other edges, unscaled, tells whether the parallelograms
// meet. Edges are no longer than 1 + 1e-6, and seven products of two numbers and their sums are off by less than 16 u
// of the size, which is below `pair.error`. Nothing: nearer to a touch than that, or no such boxes.
std::optional<bool> upright_boxes_meet(const Pair& pair) {
    const glm::dmat3 &ra = pair.pose_a.rotation, &rb = pair.pose_b.rotation;
    const auto [k, i, j] = upright_of(ra, rb);
    if (k < 0) return std::nullopt;
    const glm::dvec3 &half_a = pair.a.half_extents(), &half_b = pair.b.half_extents();
    const auto cross = [next = kNext[k], last = kLast[k]](const glm::dvec3& u, const glm::dvec3& v) {
        return coordinate(u, next) * coordinate(v, last) - coordinate(u, last) * coordinate(v, next);
    };
    const glm::dvec3 u[2] = {coordinate(half_a, kNext[i]) * ra[kNext[i]], coordinate(half_a, kLast[i]) * ra[kLast[i]]},
                     v[2] = {coordinate(half_b, kNext[j]) * rb[kNext[j]], coordinate(half_b, kLast[j]) * rb[kLast[j]]};
    bool apart = false, surely_meet = true;
    const auto try_across = [&](const glm::dvec3& edge, const glm::dvec3(&of_own)[2], int own,
                                const glm::dvec3(&of_other)[2]) {
        const double radius = std::abs(cross(edge, of_own[1 - own])) +
                              (std::abs(cross(edge, of_other[0])) + std::abs(cross(edge, of_other[1])));
        const double extent = radius - std::abs(cross(edge, pair.offset));
        apart = apart || extent < -pair.error;
        surely_meet = surely_meet && extent > pair.error;
    };
    try_across(ra[kNext[i]], u, 0, v);
    try_across(ra[kLast[i]], u, 1, v);
    try_across(rb[kNext[j]], v, 0, u);
    try_across(rb[kLast[j]], v, 1, u);
    if (apart) return false;
    if (!overlap_along_line(coordinate(pair.pose_a.translation, k), coordinate(pair.pose_b.translation, k),
                            coordinate(half_a, i), coordinate(half_b, j)))
        return false;
    return surely_meet ? std::optional(true) : std::nullopt;
}

using ExactNormal = Expansion<4>[3];

// How much the boxes a and b overlap along a normal, times its length; exactly.
class MeetingBoxes {
  public:
    MeetingBoxes(const Pair& pair)
        : half_a_(pair.a.half_extents()),
          half_b_(pair.b.half_extents()),
          a_(pair.pose_a),
          b_(pair.pose_b),
          doubt_(0x1p-93 * pair.size) {
        for (int k = 0; k < 3; ++k) {
            const auto [high, low] = detail::two_sum(b_.translation[k], -a_.translation[k]);
            way_[k] = {high, low};
        }
    }

    // Along u × v.
    [[nodiscard]] bool overlap_along(const glm::dvec3& u, const glm::dvec3& v) const {
        if (const double rough = rough_overlap(u, v); std::abs(rough) > doubt_) return rough > 0.0;
        ExactNormal normal;
        for (int k = 0; k < 3; ++k)
            normal[k] = exact_product(u[kNext[k]], v[kLast[k]]) - exact_product(u[kLast[k]], v[kNext[k]]);
        return overlap_along(normal);
    }

  private:
    // Let w be 2^-53, and edges have the length 1. A coordinate of the normal is off by 6w², its low part is 4w; a
    // product with an edge is off by 370w², its low part is 38w; a radius of half extent h is off by 410w² h, or twice
    // that with the wrong sign. The way's product is off by 420w² of the size, or twice. Half extents together are 1.8
    // times the size, partial sums below 2.8 times; the low parts of the last sum are 125w, which 20 additions round
    // by 2500w². All of that is below 2^13 w² of the size, which is `doubt_`.
    [[nodiscard]] double rough_overlap(const glm::dvec3& u, const glm::dvec3& v) const {
        Doubled normal[3];
        for (int k = 0; k < 3; ++k) {
            const auto p = detail::two_product(coordinate(u, kNext[k]), coordinate(v, kLast[k])),
                       q = detail::two_product(coordinate(u, kLast[k]), coordinate(v, kNext[k]));
            normal[k] = {p.high, p.low - q.low};
            normal[k].add(-q.high);
        }
        Doubled overlap;
        const auto add_radius = [&](const glm::dvec3& half, const glm::dmat3& edges) {
            for (int i = 0; i < 3; ++i) {
                if (edges[i] == u || edges[i] == v) continue;  // across the normal
                Doubled along;
                for (int k = 0; k < 3; ++k) along.add_product(normal[k], coordinate(edges[i], k));
                overlap.add_product(along, along.value() < 0.0 ? -coordinate(half, i) : coordinate(half, i));
            }
        };
        add_radius(half_a_, a_.rotation);
        add_radius(half_b_, b_.rotation);
        Doubled way;
        for (int k = 0; k < 3; ++k) {
            way.add_product(normal[k], way_[k].high);
            way.low += normal[k].high * way_[k].low;
        }
        const double sign = way.value() < 0.0 ? 1.0 : -1.0;
        overlap.add(sign * way.high);
        overlap.low += sign * way.low;
        return overlap.value();
    }

    template <std::size_t N>
    [[nodiscard]] static Expansion<N> magnitude(const Expansion<N>& e) {
        return e.sign() < 0 ? -e : e;
    }
    [[nodiscard]] static Expansion<24> dot(const ExactNormal& n, const glm::dvec3& v) {
        return (n[0] * v.x + n[1] * v.y) + n[2] * v.z;
    }
    [[nodiscard]] static Expansion<144> radius(const ExactNormal& n, const glm::dvec3& half, const glm::dmat3& edges) {
        return (magnitude(dot(n, edges[0])) * half.x + magnitude(dot(n, edges[1])) * half.y) +
               magnitude(dot(n, edges[2])) * half.z;
    }
    [[nodiscard]] bool overlap_along(const ExactNormal& n) const {
        const auto way = [&](int k) { return exact_difference(b_.translation[k], a_.translation[k]) * n[k]; };
        const Expansion<48> along = magnitude((way(0) + way(1)) + way(2));
        return ((radius(n, half_a_, a_.rotation) + radius(n, half_b_, b_.rotation)) - along).sign() >= 0;
    }

    const glm::dvec3 &half_a_, &half_b_;
    const RigidTransform &a_, &b_;
    Doubled way_[3];  // from a's origin to b's
    double doubt_;
};

}  // namespace

// Edges that are parallel have no axis across them. If edge i of a is parallel to one of b, what is across edge i and
// another of b is across two edges of b: a face's axis. The same holds where edge j of b is parallel to one of a. If
// both are upright, what is across two others is along their coordinate, as their own faces' axis is.
std::optional<bool> BoxPair::meet_exactly() const {
    const glm::dmat3 &ra = pair_.pose_a.rotation, &rb = pair_.pose_b.rotation;
    const auto edges_overlap = [this](int k, int i, int j) {
        return overlap_along_line(coordinate(pair_.pose_a.translation, k), coordinate(pair_.pose_b.translation, k),
                                  coordinate(half_a_, i), coordinate(half_b_, j));
    };
    if (straight_) {
        for (int k = 0; k < 3; ++k)
            if ((near_ >> k & 1) != 0 && !edges_overlap(k, k, k)) return false;
        return true;
    }
    int near = near_;
    for (int n = 0; n < 3 && near != 0; ++n) {
        const int k = (std::max(upright_.k, 0) + n) % 3;
        const int i = upright_edge(ra, k), j = i < 0 ? i : upright_edge(rb, k);
        if (j < 0) continue;
        const int along = 1 << i | 8 << j | (0x7fc0 & ~products_with(i, j));
        if ((near & along) != 0 && !edges_overlap(k, i, j)) return false;
        near &= ~(along | products_with(i, j));
    }
    if (near == 0) return true;
    if (!is_moderate({pair_.a, pair_.pose_a}) || !is_moderate({pair_.b, pair_.pose_b})) return std::nullopt;
    for (int n = 0; n < 9; ++n)
        if ((slivers_ >> n & 1) != 0 && are_parallel(ra[n / 3], rb[n % 3])) near &= ~products_with(n / 3, n % 3);
    const MeetingBoxes boxes(pair_);
    for (int n = 0; n < 15; ++n) {
        if ((near >> n & 1) == 0) continue;
        const bool overlap = n < 3   ? boxes.overlap_along(ra[kNext[n]], ra[kLast[n]])
                             : n < 6 ? boxes.overlap_along(rb[kNext[n - 3]], rb[kLast[n - 3]])
                                     : boxes.overlap_along(ra[(n - 6) / 3], rb[(n - 6) % 3]);
        if (!overlap) return false;
    }
    return true;
}

std::optional<bool> boxes_overlap_by_more(const Pair& pair, double depth) {
    BoxPair axes(pair);
    const double surely_less = depth - axes.error();
    const BoxAxis least = axes.least(surely_less);
    if (least.extent < surely_less) return false;
    if (least.extent > depth + axes.error() + kSameDepth * pair.size + axes.sliver_width()) return true;
    return std::nullopt;
}

// Roundings are left to `settle` where the cores are apart.
std::optional<bool> boxes_meet(const Pair& pair) {
    if (pair.rounding() == 0.0 && pair.pose_a.rotation != pair.pose_b.rotation)
        if (const std::optional<bool> upright = upright_boxes_meet(pair)) return upright;
    BoxPair axes(pair);
    const double far = -(pair.rounding() + 1.5 * pair.doubt()) - axes.error();
    const BoxAxis least = axes.least(far);
    if (least.extent < far) return false;
    if (!(least.extent >= far)) return std::nullopt;
    const std::optional<bool> cores = axes.meet_exactly();
    return cores && !*cores && pair.rounding() > 0.0 ? std::nullopt : cores;
}

}  // namespace crofton::convex
