// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "box_pair.hpp"

namespace crofton::convex {
namespace {

// Side i of a box's face leads from corner i of kBoxFaces to the next: across which of the face's two axes it is, on
// which side, and its edge.
struct FaceSide {
    int axis;
    double sign;
    std::uint16_t edge;
};
struct FaceSides {
    FaceSide side[4];
};
constexpr FaceSides sides_of(int face) {
    FaceSides sides{};
    const int k = face / 2, u = k == 2 ? 0 : k + 1;
    for (int i = 0; i < 4; ++i) {
        const int from = kBoxFaces[face][i], to = kBoxFaces[face][(i + 1) % 4], common = 7 & ~(from ^ to) & ~(1 << k);
        sides.side[i] = {common == 1 << u ? 0 : 1, (from & common) != 0 ? 1.0 : -1.0, box_edge(from, to)};
    }
    return sides;
}
constexpr FaceSides kSides[6] = {sides_of(0), sides_of(1), sides_of(2), sides_of(3), sides_of(4), sides_of(5)};

}  // namespace

BoxClip::BoxClip(const Placed& a, const Placed& b, const BoxPair& pair, bool reference_is_a, int face,
                 const glm::dvec3& direction)
    : reference_(reference_is_a ? a : b),
      other_(reference_is_a ? b : a),
      seen_(pair.seen_by(reference_is_a)),
      direction_(pair.into_frame(reference_is_a, reference_is_a ? direction : -direction)),
      reference_is_a_(reference_is_a),
      face_(face),
      k_(face / 2),
      u_(k_ == 2 ? 0 : k_ + 1),
      v_(k_ == 0 ? 2 : k_ - 1) {
    if (!(std::abs(direction_[k_]) > 0.05)) return;
    // The face that looks against the direction most.
    const glm::dvec3 facing(glm::dot(seen_.edge[0], direction_), glm::dot(seen_.edge[1], direction_),
                            glm::dot(seen_.edge[2], direction_));
    const double x = std::abs(facing.x), y = std::abs(facing.y), z = std::abs(facing.z);
    const int k = x >= y && x >= z ? 0 : y >= z ? 1 : 2;
    incident_ = 2 * k + (facing[k] < 0.0 ? 1 : 0);
    find_corners(incident_);
    clip();
}

// The shadow of the incident face is a parallelogram: its middle and two half edges are cast.
void BoxClip::find_corners(int incident_face) {
    const glm::dvec3& h = other_.body.half_extents();
    const int k = incident_face / 2, u = k == 2 ? 0 : k + 1, v = k == 0 ? 2 : k - 1;
    const double level = (face_ & 1) != 0 ? reference_.body.half_extents()[k_] : -reference_.body.half_extents()[k_];
    const double steep = 1.0 / direction_[k_], du = direction_[u_] * steep, dv = direction_[v_] * steep;
    struct Shadow {
        double x, y, height;
    };
    const auto cast = [&](const glm::dvec3& q, double rise) {
        return Shadow{q[u_] - rise * du, q[v_] - rise * dv, rise * steep};
    };
    const glm::dvec3 center = seen_.center + ((incident_face & 1) != 0 ? h[k] : -h[k]) * seen_.edge[k],
                     half_u = h[u] * seen_.edge[u], half_v = h[v] * seen_.edge[v];
    const Shadow middle = cast(center, center[k_] - level), along = cast(half_u, half_u[k_]),
                 up = cast(half_v, half_v[k_]);
    for (int i = 0; i < 4; ++i) {
        const int corner = kBoxFaces[incident_face][i];
        const double s = (corner >> u & 1) != 0 ? 1.0 : -1.0, t = (corner >> v & 1) != 0 ? 1.0 : -1.0;
        corner_[i] = {middle.x + s * along.x + t * up.x, middle.y + s * along.y + t * up.y,
                      middle.height + s * along.height + t * up.height, (i + 3) & 3, i};
    }
    count_ = 4;
}

// Returns the number of corners in `to`, which has room for kMost + 1, or −1 with nothing written where none is
// outside.
int BoxClip::clip_side(const FlatCorner* from, int count, int side, double level, int face, FlatCorner* to) {
    const FaceSide& at = kSides[face].side[side];
    double height[kMost + 1];
    unsigned outside = 0, inside = 0;
    for (int i = 0; i < count; ++i) {
        height[i] = at.sign * (at.axis == 0 ? from[i].x : from[i].y) - level;
        outside |= (height[i] > 0.0 ? 1U : 0U) << i;
        inside |= (height[i] < 0.0 ? 1U : 0U) << i;
    }
    if (outside == 0) return -1;
    height[count] = height[0];
    outside |= (outside & 1U) << count;
    inside |= (inside & 1U) << count;
    const unsigned leaves = inside & (outside >> 1), enters = outside & (inside >> 1);
    int kept = 0;
    for (int i = 0; i < count && kept < kMost; ++i) {
        const FlatCorner& p = from[i];
        if ((outside >> i & 1U) == 0) {
            to[kept] = p;
            if ((inside >> i & 1U) == 0 && (outside >> (i + 1) & 1U) != 0) to[kept].after = -1 - side;
            ++kept;
        }
        if (((leaves | enters) >> i & 1U) == 0) continue;
        const FlatCorner& q = from[i + 1 == count ? 0 : i + 1];
        const double t = height[i] / (height[i] - height[i + 1]);
        const bool out = (leaves >> i & 1U) != 0;
        to[kept++] = {p.x + t * (q.x - p.x), p.y + t * (q.y - p.y), p.height + t * (q.height - p.height),
                      out ? p.after : -1 - side, out ? -1 - side : p.after};
    }
    return std::min(kept, kMost);
}

void BoxClip::clip() {
    FlatCorner other[kMost + 1];
    FlatCorner *now = corner_, *next = other;
    const glm::dvec3& h = reference_.body.half_extents();
    for (int side = 0; side < 4 && count_ > 0; ++side) {
        const double level = h[kSides[face_].side[side].axis == 0 ? u_ : v_];
        const int kept = clip_side(now, count_, side, level, face_, next);
        if (kept < 0) continue;
        count_ = kept;
        std::swap(now, next);
    }
    if (now != corner_) std::copy(now, now + count_, corner_);
}

Feature BoxClip::on_reference(const FlatCorner& corner) const {
    const Feature self{FeatureKind::face, static_cast<std::uint16_t>(face_)};
    if (corner.before >= 0 && corner.after >= 0) return self;
    if (corner.before >= 0 || corner.after >= 0)
        return {FeatureKind::edge, kSides[face_].side[-1 - std::min(corner.before, corner.after)].edge};
    // The common corner of two sides is where the later begins; of sides apart, the face stands for it.
    const int first = -1 - corner.before, second = -1 - corner.after;
    if (((first + 1) & 3) == second) return {FeatureKind::vertex, kBoxFaces[face_][second]};
    if (((second + 1) & 3) == first) return {FeatureKind::vertex, kBoxFaces[face_][first]};
    return self;
}

Feature BoxClip::on_incident(const FlatCorner& corner) const {
    if (corner.before >= 0 && corner.after >= 0) {
        if (corner.before == corner.after) return {FeatureKind::edge, kSides[incident_].side[corner.after].edge};
        return {FeatureKind::vertex, kBoxFaces[incident_][corner.after]};
    }
    const int edge = std::max(corner.before, corner.after);
    if (edge >= 0) return {FeatureKind::edge, kSides[incident_].side[edge].edge};
    return {FeatureKind::face, static_cast<std::uint16_t>(incident_)};
}

void BoxClip::gather(const Touch& touch, double margin, GatheredPoints& to) const {
    const double ra = reference_.body.radius(), ri = other_.body.radius();
    const double level = (face_ & 1) != 0 ? reference_.body.half_extents()[k_] : -reference_.body.half_extents()[k_];
    const glm::dmat3& r = reference_.pose.rotation;
    // From the middle of the cores' points to that of the surfaces'.
    const glm::dvec3 out = reference_is_a_ ? touch.normal : -touch.normal;
    const glm::dvec3 base = reference_.pose.translation + level * r[k_] + (0.5 * (ra - ri)) * out;
    for (int i = 0; i < count_; ++i) {
        const FlatCorner& c = corner_[i];
        const double depth = std::min((ra + ri) - c.height, touch.depth);
        if (!(depth >= -margin)) continue;
        const Feature on_reference = this->on_reference(c), on_incident = this->on_incident(c);
        to.point[to.count++] = {base + (c.x * r[u_] + c.y * r[v_] + (0.5 * c.height) * out),
                                depth,
                                reference_is_a_ ? on_reference : on_incident,
                                reference_is_a_ ? on_incident : on_reference,
                                {},
                                {}};
    }
}

double BoxClip::corner_within(int corner) const {
    const glm::dvec3 &h = other_.body.half_extents(), &half = reference_.body.half_extents();
    glm::dvec3 q = seen_.center;
    for (int k = 0; k < 3; ++k) q += ((corner >> k & 1) != 0 ? h[k] : -h[k]) * seen_.edge[k];
    return std::min(half[u_] - std::abs(q[u_]), half[v_] - std::abs(q[v_]));
}

// Let n be the outward normal and p a point of the clipped polygon, at depth d. Its shadow is ρ from the rim of the
// face. Then the difference body has all of d n + a disc of radius ρ across n. At an angle t from n its extent is at
// least d cos t + ρ sin t. That is no less than d up to t = 2 atan(ρ / d).
// Beyond, step from p through both boxes to their far faces: the difference body has a point `behind` against n and
// `aside` across it. The extent is at least −behind cos t − aside sin t. Beyond a right angle, hence where ρ > d, that
// grows with t. Its first value is no less than d where behind (ρ² − d²) − aside 2 ρ d ≥ d (ρ² + d²).
// With d < 0 the pair of p alone is enough: no axis has less than d. Frames are rigid to 1e-6, which the factors 0.999
// cover.
bool BoxClip::proves_least(double extent, double allowed) const {
    if (count_ == 0) return false;
    double x = 0.0, y = 0.0, depth = 0.0, most = -corner_[0].height;
    for (int i = 0; i < count_; ++i) {
        x += corner_[i].x;
        y += corner_[i].y;
        depth -= corner_[i].height;
        most = std::max(most, -corner_[i].height);
    }
    allowed *= 0.999;
    if (extent < 0.0) return extent - most <= allowed;
    const double share = 1.0 / count_;
    x *= share, y *= share, depth *= share;
    const glm::dvec3 &half = reference_.body.half_extents(), &h = other_.body.half_extents();
    const double rim = 0.999 * std::min(half[u_] - std::abs(x), half[v_] - std::abs(y));
    if (!(depth > 0.0) || !(rim > depth) || !(extent - depth <= allowed)) return false;
    // A step through the other box, along the edge of its face that was clipped.
    const glm::dvec3& edge = seen_.edge[incident_ / 2];
    const double step = 2.0 * h[incident_ / 2], along = step * std::abs(glm::dot(edge, direction_));
    const double behind = 0.999 * (2.0 * half[k_] + along) - depth, aside2 = step * step * 1.001 - along * along;
    const double aside = std::sqrt(std::max(aside2, 0.0)) + 1e-5 * half[k_];
    return behind * (rim * rim - depth * depth) - aside * 2.0 * rim * depth >= depth * (rim * rim + depth * depth);
}

}  // namespace crofton::convex
