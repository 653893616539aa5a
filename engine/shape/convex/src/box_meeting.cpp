// SPDX-License-Identifier: MIT
// Whether boxes meet that are nearer to a touch than rounding tells.
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

// A sum whose terms are added one by one, and bounds on what it is off by.
struct RoughSum {
    double sum = 0.0, error = 0.0;
    void add(double term) {
        const auto [high, low] = detail::two_sum(sum, term);
        sum = high;
        error += std::abs(low);
    }
    void add_product(double a, double b) {
        const auto [high, low] = product(a, b);
        add(high);
        error += std::abs(low);
    }
    // 2 for those of adding up the errors.
    [[nodiscard]] bool is_sure() const { return error == 0.0 || std::abs(sum) > 2.0 * error; }
};

// Whether each of the frame's axes is one of the world's, or its opposite.
bool has_straight_axes(const glm::dmat3& r) {
    const auto along_one = [](const glm::dvec3& v) {
        const int zeros = static_cast<int>(v.x == 0.0) + static_cast<int>(v.y == 0.0) + static_cast<int>(v.z == 0.0);
        return zeros == 2 && std::abs(v.x + v.y + v.z) == 1.0;
    };
    return along_one(r[0]) && along_one(r[1]) && along_one(r[2]);
}

// The same of two boxes in one such frame, along its axis k.
bool straight_boxes_overlap(const Pair& pair, int k) {
    const glm::dvec3& axis = pair.pose_a.rotation[k];
    const int i = axis.x != 0.0 ? 0 : axis.y != 0.0 ? 1 : 2;
    const double a = pair.pose_a.translation[i], b = pair.pose_b.translation[i], half_a = pair.a.half_extents()[k],
                 half_b = pair.b.half_extents()[k], low = std::min(a, b), high = std::max(a, b);
    const auto apart = detail::two_sum(high, -low), radius = detail::two_sum(half_a, half_b);
    // The difference of two numbers as near as these is exact, and so is the sign of a sum of two.
    const double rough = radius.high - apart.high, rest = radius.low - apart.low;
    const bool close = apart.high <= 2.0 * radius.high && radius.high <= 2.0 * apart.high;
    if (close && (radius.low == 0.0 || apart.low == 0.0)) return rough + rest >= 0.0;
    return (exact_sum(half_a, half_b) - exact_difference(high, low)).sign() >= 0;
}

using ExactNormal = Expansion<4>[3];

// How much the boxes a and b overlap along a normal, times its length; exactly.
class MeetingBoxes {
  public:
    MeetingBoxes(const Pair& pair)
        : half_a_(pair.a.half_extents()), half_b_(pair.b.half_extents()), a_(pair.pose_a), b_(pair.pose_b) {}

    [[nodiscard]] bool overlap_along(const glm::dvec3& u, const glm::dvec3& v) {
        // Of a floor's faces the normal is along a coordinate.
        bool zero[3];
        for (int k = 0; k < 3; ++k) zero[k] = is_difference_zero(u[kNext[k]], v[kLast[k]], u[kLast[k]], v[kNext[k]]);
        for (int k = 0; k < 3; ++k)
            if (zero[kNext[k]] && zero[kLast[k]]) return zero[k] || overlap_along_coordinate_once(k);
        ExactNormal normal;
        for (int k = 0; k < 3; ++k)
            normal[k] = exact_product(u[kNext[k]], v[kLast[k]]) - exact_product(u[kLast[k]], v[kNext[k]]);
        return overlap_along(normal);
    }

  private:
    // Of upright boxes many products of edges are along one coordinate.
    [[nodiscard]] bool overlap_along_coordinate_once(int k) {
        if (!overlap_known_[k]) overlap_known_[k] = overlap_along_coordinate(k);
        return overlap_known_[k];
    }
    [[nodiscard]] bool overlap_along_coordinate(int k) const {
        const auto apart = detail::two_sum(b_.translation[k], -a_.translation[k]);
        const double sign = apart.high < 0.0 ? 1.0 : -1.0;
        RoughSum rough;
        rough.add(sign * apart.high);
        rough.add(sign * apart.low);
        for (int i = 0; i < 3; ++i) {
            rough.add_product(half_a_[i], std::abs(a_.rotation[i][k]));
            rough.add_product(half_b_[i], std::abs(b_.rotation[i][k]));
        }
        if (rough.is_sure()) return rough.sum >= 0.0;
        const auto radius = [k](const glm::dvec3& half, const RigidTransform& pose) {
            return (exact_product(half[0], std::abs(pose.rotation[0][k])) +
                    exact_product(half[1], std::abs(pose.rotation[1][k]))) +
                   exact_product(half[2], std::abs(pose.rotation[2][k]));
        };
        const Expansion<2> way = exact_difference(b_.translation[k], a_.translation[k]);
        return ((radius(half_a_, a_) + radius(half_b_, b_)) - (way.sign() < 0 ? -way : way)).sign() >= 0;
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
    bool overlap_known_[3] = {false, false, false};  // along the coordinates
};

}  // namespace

// Edges that are parallel have no axis across them. If edge i of a is parallel to one of b, what is across edge i and
// another of b is across two edges of b: a face's axis. The same holds where edge j of b is parallel to one of a.
std::optional<bool> BoxPair::meet_exactly() const {
    if (straight_ || (common_frame_ && has_straight_axes(pair_.pose_a.rotation))) {
        for (int k = 0; k < 3; ++k)
            if ((near_ >> k & 1) != 0 && !straight_boxes_overlap(pair_, k)) return false;
        return true;
    }
    if (!is_moderate({pair_.a, pair_.pose_a}) || !is_moderate({pair_.b, pair_.pose_b})) return std::nullopt;
    const glm::dmat3 &ra = pair_.pose_a.rotation, &rb = pair_.pose_b.rotation;
    int near = near_;
    for (int n = 0; n < 9; ++n) {
        if ((slivers_ >> n & 1) == 0 || !are_parallel(ra[n / 3], rb[n % 3])) continue;
        constexpr int kRow = 7 << 6, kColumn = 73 << 6;
        near &= ~(kRow << 3 * (n / 3) | kColumn << n % 3);
    }
    MeetingBoxes boxes(pair_);
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
    BoxPair axes(pair);
    const double far = -(pair.rounding() + 1.5 * pair.doubt()) - axes.error();
    const BoxAxis least = axes.least(far);
    if (least.extent < far) return false;
    if (!(least.extent >= far)) return std::nullopt;
    const std::optional<bool> cores = axes.meet_exactly();
    return cores && !*cores && pair.rounding() > 0.0 ? std::nullopt : cores;
}

}  // namespace crofton::convex
