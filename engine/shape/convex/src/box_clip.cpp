// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <limits>

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

// A corner of the clipped polygon is where two lines meet. `before` and `after` are edges of the incident face, 0 to 3,
// or sides of the reference, −1 − number.
constexpr unsigned lines(int before, int after) {
    return static_cast<unsigned>(8 * (before + 4) + (after + 4));
}
constexpr int before_of(unsigned lines) {
    return static_cast<int>(lines >> 3) - 4;
}
constexpr int after_of(unsigned lines) {
    return static_cast<int>(lines & 7U) - 4;
}

constexpr Feature on_reference(int face, int before, int after) {
    const Feature self{FeatureKind::face, static_cast<std::uint16_t>(face)};
    if (before >= 0 && after >= 0) return self;
    if (before >= 0 || after >= 0) return {FeatureKind::edge, kSides[face].side[-1 - std::min(before, after)].edge};
    // The common corner of two sides is where the later begins; of sides apart, the face stands for it.
    const int first = -1 - before, second = -1 - after;
    if (((first + 1) & 3) == second) return {FeatureKind::vertex, kBoxFaces[face][second]};
    if (((second + 1) & 3) == first) return {FeatureKind::vertex, kBoxFaces[face][first]};
    return self;
}

constexpr Feature on_incident(int face, int before, int after) {
    if (before >= 0 && after >= 0) {
        if (before == after) return {FeatureKind::edge, kSides[face].side[after].edge};
        return {FeatureKind::vertex, kBoxFaces[face][after]};
    }
    const int edge = std::max(before, after);
    if (edge >= 0) return {FeatureKind::edge, kSides[face].side[edge].edge};
    return {FeatureKind::face, static_cast<std::uint16_t>(face)};
}

// The features of a corner, by its lines.
struct FaceFeatures {
    Feature reference[6][64], incident[6][64];
};
constexpr FaceFeatures features_of_corners() {
    FaceFeatures features{};
    for (int face = 0; face < 6; ++face)
        for (unsigned at = 0; at < 64; ++at) {
            features.reference[face][at] = on_reference(face, before_of(at), after_of(at));
            features.incident[face][at] = on_incident(face, before_of(at), after_of(at));
        }
    return features;
}
constexpr FaceFeatures kFeatures = features_of_corners();

}  // namespace

BoxClip::BoxClip(const ShapeAtPose& a, const ShapeAtPose& b, const BoxPair& pair, bool reference_is_a, int face,
                 const glm::dvec3& direction)
    : reference_(reference_is_a ? a : b),
      other_(reference_is_a ? b : a),
      seen_(pair.seen_by(reference_is_a)),
      direction_(pair.into_frame(reference_is_a, reference_is_a ? direction : -direction)),
      reference_is_a_(reference_is_a),
      rounding_(4.0 * pair.error()),
      face_(face),
      k_(face / 2),
      u_(k_ == 2 ? 0 : k_ + 1),
      v_(k_ == 0 ? 2 : k_ - 1) {
    if (pair.is_straight()) {
        incident_ = face ^ 1;
        find_straight_corners();
        clip();
        return;
    }
    if (!(std::abs(coordinate(direction_, k_)) > 0.05)) return;
    // The face that looks against the direction most.
    const glm::dvec3 facing(glm::dot(seen_.edge[0], direction_), glm::dot(seen_.edge[1], direction_),
                            glm::dot(seen_.edge[2], direction_));
    const double x = std::abs(facing.x), y = std::abs(facing.y), z = std::abs(facing.z);
    const int k = x >= y && x >= z ? 0 : y >= z ? 1 : 2;
    incident_ = 2 * k + (coordinate(facing, k) < 0.0 ? 1 : 0);
    find_corners(incident_);
    clip();
}

// The shadow of the incident face is a parallelogram: its middle and two half edges are cast.
void BoxClip::find_corners(int incident_face) {
    const glm::dvec3& h = other_.shape.half_extents();
    const int k = incident_face / 2, u = k == 2 ? 0 : k + 1, v = k == 0 ? 2 : k - 1;
    const double steep = 1.0 / coordinate(direction_, k_), du = coordinate(direction_, u_) * steep,
                 dv = coordinate(direction_, v_) * steep;
    struct Shadow {
        double x, y, height;
    };
    const auto cast = [&](const glm::dvec3& q, double rise) {
        return Shadow{coordinate(q, u_) - rise * du, coordinate(q, v_) - rise * dv, rise * steep};
    };
    const double out = coordinate(h, k);
    const glm::dvec3 center = seen_.center + ((incident_face & 1) != 0 ? out : -out) * seen_.edge[k],
                     half_u = coordinate(h, u) * seen_.edge[u], half_v = coordinate(h, v) * seen_.edge[v];
    const Shadow middle = cast(center, coordinate(center, k_) - level()), along = cast(half_u, coordinate(half_u, k_)),
                 up = cast(half_v, coordinate(half_v, k_));
    // A face's first corner is the lowest along both its axes. Corners that are two apart lie opposite.
    const double turn = (kBoxFaces[incident_face][1] >> u & 1) != 0 ? 1.0 : -1.0;
    const Shadow sum{along.x + up.x, along.y + up.y, along.height + up.height};
    const Shadow difference{turn * (along.x - up.x), turn * (along.y - up.y), turn * (along.height - up.height)};
    const auto corner = [&](const Shadow& to, double sign, int number) {
        corner_[number] = {middle.x + sign * to.x, middle.y + sign * to.y, middle.height + sign * to.height,
                           lines((number + 3) & 3, number)};
    };
    corner(sum, -1.0, 0), corner(difference, 1.0, 1), corner(sum, 1.0, 2), corner(difference, -1.0, 3);
    count_ = 4;
}

// For boxes that are not rotated, along the axis of the faces: the incident face itself is the shadow.
void BoxClip::find_straight_corners() {
    const glm::dvec3 &h = other_.shape.half_extents(), &at = seen_.center;
    const double out = coordinate(h, k_), hu = coordinate(h, u_), hv = coordinate(h, v_), x = coordinate(at, u_),
                 y = coordinate(at, v_);
    const double rise = coordinate(at, k_) + ((incident_ & 1) != 0 ? out : -out) - level();
    const double height = (face_ & 1) != 0 ? rise : -rise;
    for (int i = 0; i < 4; ++i) {
        const int corner = kBoxFaces[incident_][i];
        corner_[i] = {(corner >> u_ & 1) != 0 ? x + hu : x - hu, (corner >> v_ & 1) != 0 ? y + hv : y - hv, height,
                      lines((i + 3) & 3, i)};
    }
    count_ = 4;
}

// Returns the number of corners in `to`, which has room for kMost + 1, or −1 with nothing written where none is
// outside.
int BoxClip::clip_side(const FlatCorner* from, int count, int side, double level, FlatCorner* to) const {
    const FaceSide& at = kSides[face_].side[side];
    const bool of_x = at.axis == 0;
    const double sign = at.sign;
    double height[kMost + 1];
    unsigned outside = 0, inside = 0;
    for (int i = 0; i < count; ++i) {
        height[i] = sign * (of_x ? from[i].x : from[i].y) - level;
        outside |= (height[i] > rounding_ ? 1U : 0U) << i;
        inside |= (height[i] < -rounding_ ? 1U : 0U) << i;
    }
    if (outside == 0) return -1;
    height[count] = height[0];
    const unsigned outside_next = (outside | (outside & 1U) << count) >> 1,
                   inside_next = (inside | (inside & 1U) << count) >> 1;
    // Two corners are a segment, which crosses the side once.
    const unsigned edges = count == 2 ? 1U : ~0U, leaves = inside & outside_next & edges,
                   enters = outside & inside_next & edges;
    // A corner on the side, after which the polygon is outside, has the side after it.
    const unsigned turns = ~(inside | outside) & outside_next;
    int kept = 0;
    for (int i = 0; i < count && kept < kMost; ++i) {
        const FlatCorner& p = from[i];
        to[kept] = p;
        kept += static_cast<int>(~outside >> i & 1U);
        if (((leaves | enters | turns) >> i & 1U) == 0) continue;
        if ((turns >> i & 1U) != 0) {
            const int after = after_of(p.lines);  // of a corner of the reference another side
            to[kept - 1].lines = lines(after < 0 ? after : before_of(p.lines), -1 - side);
            continue;
        }
        const FlatCorner& q = from[i + 1 == count ? 0 : i + 1];
        const double t = height[i] / (height[i] - height[i + 1]);
        const int along = after_of(p.lines);
        to[kept++] = {p.x + t * (q.x - p.x), p.y + t * (q.y - p.y), p.height + t * (q.height - p.height),
                      (leaves >> i & 1U) != 0 ? lines(along, -1 - side) : lines(-1 - side, along)};
    }
    return std::min(kept, kMost);
}

void BoxClip::clip() {
    FlatCorner other[kMost + 1];
    FlatCorner *now = corner_, *next = other;
    const glm::dvec3& h = reference_.shape.half_extents();
    const double level[2] = {coordinate(h, u_), coordinate(h, v_)};
    // Sides that all of the face is within cut nothing off.
    const auto [left, right] = std::minmax({corner_[0].x, corner_[1].x, corner_[2].x, corner_[3].x});
    const auto [lowest, highest] = std::minmax({corner_[0].y, corner_[1].y, corner_[2].y, corner_[3].y});
    const double reach[2][2] = {{-left, right}, {-lowest, highest}};
    for (int side = 0; side < 4 && count_ > 0; ++side) {
        const FaceSide& at = kSides[face_].side[side];
        if (reach[at.axis][at.sign > 0.0 ? 1 : 0] <= level[at.axis] + rounding_) continue;
        const int kept = clip_side(now, count_, side, level[at.axis], next);
        if (kept < 0) continue;
        count_ = kept;
        std::swap(now, next);
    }
    if (now != corner_) std::copy(now, now + count_, corner_);
}

double BoxClip::deepest() const {
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < count_; ++i) least = std::min(least, corner_[i].height);
    return -least;
}

glm::dvec3 BoxClip::deepest_place() const {
    const FlatCorner& c = *std::min_element(
        corner_, corner_ + count_, [](const FlatCorner& p, const FlatCorner& q) { return p.height < q.height; });
    const glm::dmat3& r = reference_.pose.rotation;
    return level() * r[k_] + (c.x * r[u_] + c.y * r[v_]);
}

double BoxClip::level() const {
    const double half = coordinate(reference_.shape.half_extents(), k_);
    return (face_ & 1) != 0 ? half : -half;
}

void BoxClip::gather(const Touch& touch, double margin, GatheredPoints& to) const {
    const double ra = reference_.shape.radius(), ri = other_.shape.radius(), most = touch.depth;
    const glm::dmat3& r = reference_.pose.rotation;
    // From the middle of the cores' points to that of the surfaces'.
    const glm::dvec3 out = reference_is_a_ ? touch.normal : -touch.normal, along_u = r[u_], along_v = r[v_];
    const glm::dvec3 base = reference_.pose.translation + level() * r[k_] + (0.5 * (ra - ri)) * out;
    const Feature *on_reference = kFeatures.reference[face_], *on_incident = kFeatures.incident[incident_];
    const Feature *on_a = reference_is_a_ ? on_reference : on_incident,
                  *on_b = reference_is_a_ ? on_incident : on_reference;
    int count = to.count;
    for (int i = 0; i < count_; ++i) {
        const FlatCorner& c = corner_[i];
        const double depth = std::min((ra + ri) - c.height, most);
        if (!(depth >= -margin)) continue;
        ContactPoint& point = to.point[count++];
        point.position = base + (c.x * along_u + c.y * along_v + (0.5 * c.height) * out);
        point.depth = depth;
        point.on_a = on_a[c.lines];
        point.on_b = on_b[c.lines];
        point.part_a = point.part_b = {};
    }
    to.count = count;
}

double BoxClip::corner_within(int corner) const {
    const glm::dvec3 &h = other_.shape.half_extents(), &half = reference_.shape.half_extents();
    glm::dvec3 q = seen_.center;
    for (int k = 0; k < 3; ++k) q += ((corner >> k & 1) != 0 ? h[k] : -h[k]) * seen_.edge[k];
    return std::min(coordinate(half, u_) - std::abs(coordinate(q, u_)),
                    coordinate(half, v_) - std::abs(coordinate(q, v_)));
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
    allowed *= 0.999;
    if (extent < 0.0) return extent - deepest() <= allowed;
    double x = 0.0, y = 0.0, depth = 0.0;
    for (int i = 0; i < count_; ++i) {
        x += corner_[i].x;
        y += corner_[i].y;
        depth -= corner_[i].height;
    }
    const double share = 1.0 / count_;
    x *= share, y *= share, depth *= share;
    const glm::dvec3 &half = reference_.shape.half_extents(), &h = other_.shape.half_extents();
    const double rim = 0.999 * std::min(coordinate(half, u_) - std::abs(x), coordinate(half, v_) - std::abs(y));
    if (!(depth > 0.0) || !(rim > depth) || !(extent - depth <= allowed)) return false;
    // A step through the other box, along the edge of its face that was clipped.
    const glm::dvec3& edge = seen_.edge[incident_ / 2];
    const double step = 2.0 * coordinate(h, incident_ / 2), thick = coordinate(half, k_),
                 along = step * std::abs(glm::dot(edge, direction_));
    const double behind = 0.999 * (2.0 * thick + along) - depth, aside2 = step * step * 1.001 - along * along;
    const double aside = std::sqrt(std::max(aside2, 0.0)) + 1e-5 * thick;
    return behind * (rim * rim - depth * depth) - aside * 2.0 * rim * depth >= depth * (rim * rim + depth * depth);
}

}  // namespace crofton::convex
