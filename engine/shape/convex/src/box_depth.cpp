// SPDX-License-Identifier: MIT
// Penetration depth of two boxes, and the points at that depth.
#include <algorithm>
#include <cmath>

#include "box_pair.hpp"

namespace crofton::convex {
namespace {

// Of the size. The direction across two edges is off by up to 1.4e-10 (BoxPair), and its extent by as much of the size.
constexpr double kEdgeError = 2e-10;
// Of the size: how far a deepest point may be beside the face or edge that it is on.
constexpr double kBeside = 1e-10;

class BoxDepth {
  public:
    BoxDepth(const Pair& pair, const BoxPair& axes, const BoxAxis& least, Depth& depth)
        : pair_(pair), axes_(axes), least_(least), depth_(depth) {}

    // `slack`: how far the least extent may be above the least of all axes. False if the deepest points are not found.
    [[nodiscard]] bool set(double slack) {
        depth_.normal = axes_.normal(least_.number);
        double along = 0.0;
        deepest_ = pair_.support(depth_.normal, along);
        depth_.upper = along + pair_.error;
        depth_.lower = std::max(0.0, least_.extent - slack);
        if (!(depth_.upper <= least_.extent + slack + 2.0 * pair_.error)) return false;
        return least_.number < 6 ? set_points_at_face() : set_points_at_edges();
    }

  private:
    [[nodiscard]] bool set_points_at_face();
    [[nodiscard]] bool set_points_at_edges();
    // Whether a point of the reference's face, around a's origin, is within the face but for `kBeside`.
    [[nodiscard]] bool is_on_face(const glm::dvec3& foot) const;
    void set_points(const glm::dvec3& on_a, const glm::dvec3& on_b) {
        depth_.face.count = 0;
        depth_.face.weight[0] = 1.0;
        depth_.face.add({on_a, on_b, on_a - on_b, 0, 0});
        depth_.has_face = true;
    }

    const Pair& pair_;
    const BoxPair& axes_;
    const BoxAxis& least_;
    Depth& depth_;
    Corner deepest_{};  // the corners that are farthest into the other box
};

bool BoxDepth::is_on_face(const glm::dvec3& foot) const {
    const bool of_a = least_.number < 3;
    const int k = least_.number % 3;
    const glm::dvec3 local = axes_.into_frame(of_a, of_a ? foot : foot - pair_.offset),
                     &half = (of_a ? pair_.a : pair_.b).half_extents();
    const double beside = kBeside * pair_.size;
    return std::abs(coordinate(local, kNext[k])) <= coordinate(half, kNext[k]) + beside &&
           std::abs(coordinate(local, kLast[k])) <= coordinate(half, kLast[k]) + beside;
}

// The other box's deepest corner, if it is above the face. Else an edge or face of the other box is nearly as deep, and
// what it has in common with the face is.
bool BoxDepth::set_points_at_face() {
    const bool of_a = least_.number < 3;
    const glm::dvec3 way = least_.extent * depth_.normal, foot = of_a ? deepest_.on_b + way : deepest_.on_a - way;
    if (is_on_face(foot)) {
        set_points(of_a ? foot : deepest_.on_a, of_a ? deepest_.on_b : foot);
        return true;
    }
    const ShapeAtPose a{pair_.a, pair_.pose_a}, b{pair_.b, pair_.pose_b};
    const BoxClip clip(a, b, axes_, of_a, axes_.face_towards_other(least_.number), depth_.normal);
    if (!(clip.deepest() >= least_.extent - kBeside * pair_.size)) return false;
    const glm::dvec3 place = of_a ? clip.deepest_place() : clip.deepest_place() + pair_.offset;
    set_points(of_a ? place : place + way, of_a ? place - way : place);
    return true;
}

// Where the edges cross, seen along the normal. False where rounding moves that too far.
bool BoxDepth::set_points_at_edges() {
    const int i = (least_.number - 6) / 3, j = (least_.number - 6) % 3;
    const glm::dvec3 &u = pair_.pose_a.rotation[i], &v = pair_.pose_b.rotation[j];
    const double half_a = coordinate(pair_.a.half_extents(), i), half_b = coordinate(pair_.b.half_extents(), j);
    const glm::dvec3 from_a = deepest_.on_a - ((deepest_.a >> i & 1) != 0 ? half_a : -half_a) * u,
                     from_b = deepest_.on_b - ((deepest_.b >> j & 1) != 0 ? half_b : -half_b) * v;
    const glm::dvec3 across = glm::cross(u, v), between = from_b - from_a;
    const double share = 1.0 / glm::dot(across, across), s = share * glm::dot(glm::cross(between, v), across),
                 t = share * glm::dot(glm::cross(between, u), across);
    const glm::dvec3 on_a = from_a + std::clamp(s, -half_a, half_a) * u,
                     on_b = from_b + std::clamp(t, -half_b, half_b) * v;
    if (!(glm::length(on_a - on_b - least_.extent * depth_.normal) <= kBeside * pair_.size)) return false;
    set_points(on_a, on_b);
    return true;
}

}  // namespace

Warm depth_of_boxes(const Pair& pair, Depth& depth) {
    BoxPair axes(pair);
    const double far = -(pair.rounding() + 1.5 * pair.doubt()) - axes.error();
    BoxAxis least = axes.least(far);
    if (least.extent < far) return Warm::apart;
    double slack = axes.error() + (kSameDepth + kEdgeError) * pair.size;
    if (axes.sliver_width() > kEdgeError * pair.size)
        axes.try_slivers(least);
    else
        slack += axes.sliver_width();
    if (!(least.extent > slack)) return Warm::unknown;
    return BoxDepth(pair, axes, least, depth).set(slack) ? Warm::touching : Warm::unknown;
}

}  // namespace crofton::convex
