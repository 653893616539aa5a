// SPDX-License-Identifier: MIT
#include "clip.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace crofton::convex {
namespace {

// The number of the line at the greatest height that matters, among the sides: none has as high a one.
constexpr int kTop = kMaxPatch;

// Corners nearer to a side than this share of the size lie on it, so that a polygon as narrow counts as an edge.
constexpr double kOnSide = 0x1p-44;

// Corners within `near` of the side are on it. Returns −1 − the number of corners in `to`, or `count` with nothing
// written where none is outside. Two corners are a segment, which crosses the side once.
template <class Height>
int clip_side(const ClipCorner* from, int count, Height height_of, int side, double near, ClipCorner* to) {
    double height[kMaxClipped + 1], most = 0.0;
    for (int i = 0; i < count; ++i) {
        height[i] = height_of(from[i].point);
        most = height[i] > most ? height[i] : most;
    }
    if (most <= near) return count;
    height[count] = height[0];
    int kept = 0;
    for (int i = 0; i < count; ++i) {
        const ClipCorner& a = from[i];
        const double ha = height[i], hb = height[i + 1];
        if (ha <= near) {
            to[kept] = a;
            if (ha >= -near && hb > near) {
                if (a.after < 0) to[kept].before = a.after;  // a corner of the reference
                to[kept].after = -1 - side;
            }
            ++kept;
        }
        if (((ha < -near && hb > near) || (ha > near && hb < -near)) && (count > 2 || i == 0)) {
            const glm::dvec3& b = from[i + 1 == count ? 0 : i + 1].point;
            to[kept].point = a.point + ha / (ha - hb) * (b - a.point);
            to[kept].before = ha < 0.0 ? a.after : -1 - side;
            to[kept].after = ha < 0.0 ? -1 - side : a.after;
            ++kept;
        }
    }
    return -1 - kept;
}

Feature incident_feature(const Patch& patch, const ClipCorner& corner, int count) {
    if (corner.before >= 0 && corner.after >= 0) {
        if (corner.before == corner.after) return {FeatureKind::edge, patch.edge[corner.after]};
        return {FeatureKind::vertex, patch.vertex[count == 2 ? corner.after % 2 : corner.after]};
    }
    const int edge = std::max(corner.before, corner.after);
    return edge >= 0 ? Feature{FeatureKind::edge, patch.edge[edge]} : patch.self;
}

// `vertex` and `edge` number the features around the face, `self`, of `count` sides.
Feature reference_feature(const Feature& self, const std::uint16_t* vertex, const std::uint16_t* edge, int count,
                          const ClipCorner& corner) {
    if (corner.before >= 0 && corner.after >= 0) return self;
    if (corner.before < 0 && corner.after < 0) {
        const int first = -1 - corner.before, second = -1 - corner.after;
        // The common corner of two sides is where the later begins; of sides apart, the face stands for it.
        if ((first + 1) % count == second) return {FeatureKind::vertex, vertex[second]};
        if ((second + 1) % count == first) return {FeatureKind::vertex, vertex[first]};
        return self;
    }
    return {FeatureKind::edge, edge[-1 - std::min(corner.before, corner.after)]};
}

}  // namespace

// Short edges are taken from the shape's own numbers. They may turn inward by the unevenness of a hull's face, so that
// they bound the polygon from farther out, where all of its corners are inside.
void find_sides(const Patch& polygon, const glm::dvec3& direction, double size, Prism& sides) {
    sides.count = polygon.count;
    double longest2 = 0.0, farthest2 = 0.0;
    for (int k = 0; k < polygon.count; ++k) {
        const glm::dvec3 way = polygon.point[k] - polygon.point[0];
        longest2 = std::max(longest2, glm::dot(way, way));
        farthest2 = std::max(farthest2, glm::dot(polygon.point[k], polygon.point[k]));
    }
    for (int k = 0; k < polygon.count; ++k) {
        const glm::dvec3 &p = polygon.point[k], &q = polygon.point[k + 1 < polygon.count ? k + 1 : 0];
        glm::dvec3 edge = q - p;
        const double length2 = glm::dot(edge, edge);
        const bool is_short = length2 <= 1e-4 * longest2;
        if (length2 <= 1e-12 * farthest2) edge = exact_edge(polygon, k);
        sides.outward[k] = glm::cross(edge, direction);
        sides.level[k] = glm::dot(sides.outward[k], p);
        sides.near[k] = kOnSide * size * glm::length(sides.outward[k]);
        for (int i = 0; is_short && i < polygon.count; ++i)
            sides.level[k] = std::max(sides.level[k], glm::dot(sides.outward[k], polygon.point[i]));
    }
}

namespace {

void set_whole(const Patch& patch, ClipPolygon& polygon) {
    polygon.count = patch.count;
    for (int i = 0; i < patch.count; ++i) polygon.corner[i] = {patch.point[i], i == 0 ? patch.count - 1 : i - 1, i};
}

}  // namespace

void find_low_part(const Patch& incident, const glm::dvec3& out, double level, double most, ClipPolygon& part) {
    ClipPolygon whole;
    set_whole(incident, whole);
    const auto height = [&](const glm::dvec3& p) { return glm::dot(out, p) - (level + most); };
    const int kept = clip_side(whole.corner, whole.count, height, kTop, 0.0, part.corner);
    part.count = kept < 0 ? -1 - kept : kept;
    if (kept >= 0) std::copy_n(whole.corner, kept, part.corner);
}

bool is_around(const ClipPolygon& part, const glm::dvec3& point, const glm::dvec3& out, double room) {
    for (int i = 0; i < part.count; ++i) {
        const glm::dvec3 way = part.corner[i].point - point;
        const double along = glm::dot(way, out);
        if (!(glm::dot(way, way) - along * along < room * room)) return false;
    }
    return true;
}

void clip(const Patch& reference, const Prism& sides, const Patch& incident, ClipPolygon& part,
          const glm::dvec3& direction, Clipped& clipped) {
    clipped.count = 0;
    const double steepness = glm::dot(reference.normal, direction);
    if (!(steepness > 0.05)) return;
    ClipPolygon other;
    ClipCorner *now = part.corner, *next = other.corner;
    int count = part.count;
    for (int side = 0; side < sides.count && count > 0; ++side) {
        // Room for two more each time: a convex polygon crosses a line twice.
        if (count + 2 > kMaxClipped) return;
        const auto height = [&sides, side](const glm::dvec3& p) {
            return glm::dot(sides.outward[side], p) - sides.level[side];
        };
        const int kept = clip_side(now, count, height, side, sides.near[side], next);
        if (kept >= 0) continue;
        count = -1 - kept;
        std::swap(now, next);
    }
    if (incident.count == 2 && count == 1) return;  // it touches the rim alone: the deepest point names that better
    for (int i = 0; i < count; ++i) {
        const ClipCorner& corner = now[i];
        if (std::min(corner.before, corner.after) == -1 - kTop) continue;
        const double height = glm::dot(reference.normal, corner.point - reference.point[0]) / steepness;
        clipped.point[clipped.count++] = {
            corner.point - height * direction, corner.point,
            reference_feature(reference.self, reference.vertex, reference.edge, reference.count, corner),
            incident_feature(incident, corner, incident.count)};
    }
}

void clip(const Patch& reference, const Prism& sides, const Patch& incident, const glm::dvec3& direction,
          Clipped& clipped) {
    ClipPolygon whole;
    set_whole(incident, whole);
    clip(reference, sides, incident, whole, direction, clipped);
}

BoxFace::BoxFace(const ShapeAtPose& box, int face, const glm::dmat3& to_local, const glm::dvec3& origin, double size)
    : box_(box),
      to_local_(to_local),
      offset_(box.pose.translation - origin),
      face_(face),
      k_(face / 2),
      near_(kOnSide * size) {
    u_ = k_ == 2 ? 0 : k_ + 1;
    v_ = k_ == 0 ? 2 : k_ - 1;
    level_ = (face & 1) != 0 ? box.shape.half_extents()[k_] : -box.shape.half_extents()[k_];
    for (int i = 0; i < 4; ++i) {
        const int from = kBoxFaces[face][i], common = 7 & ~(from ^ kBoxFaces[face][(i + 1) % 4]) & ~(1 << k_);
        sides_[i] = {common == 1 << u_ ? 0 : 1, (from & common) != 0 ? 1.0 : -1.0};
    }
}

double BoxFace::distance_within(const glm::dvec3& point) const {
    const glm::dvec3 q = to_local_ * (point - offset_), &h = box_.shape.half_extents();
    return std::min(h[u_] - std::abs(q[u_]), h[v_] - std::abs(q[v_]));
}

// Corners are (x, y, height) while they are clipped: their shadow on the face, and how far they are above it along the
// direction.
void BoxFace::clip(const Patch& incident, const glm::dvec3& direction, Clipped& clipped) const {
    clipped.count = 0;
    const glm::dvec3 d = to_local_ * direction, &h = box_.shape.half_extents();
    if (!(std::abs(d[k_]) > 0.05) || incident.count + 8 > kMaxClipped) return;
    ClipCorner buffers[2][kMaxClipped];
    int count = incident.count, current = 0;
    bool outside = false;
    const Feature self{FeatureKind::face, static_cast<std::uint16_t>(face_)};
    for (int i = 0; i < count; ++i) {
        const glm::dvec3 q = to_local_ * (incident.point[i] - offset_);
        const double height = (q[k_] - level_) / d[k_];
        buffers[0][i] = {{q[u_] - height * d[u_], q[v_] - height * d[v_], height}, i == 0 ? count - 1 : i - 1, i};
        const glm::dvec3& shadow = buffers[0][i].point;
        outside = outside || !(std::abs(shadow.x) <= h[u_] && std::abs(shadow.y) <= h[v_]);
    }
    if (!outside && count > 2) {  // a small polygon above a large face
        for (int i = 0; i < count; ++i)
            clipped.point[clipped.count++] = {incident.point[i] - buffers[0][i].point.z * direction,
                                              incident.point[i],
                                              self,
                                              {FeatureKind::vertex, incident.vertex[i]}};
        return;
    }
    for (int side = 0; side < 4 && count > 0; ++side) {
        const int axis = sides_[side].axis;
        const double sign = sides_[side].sign, level = h[axis == 0 ? u_ : v_];
        const auto height = [axis, sign, level](const glm::dvec3& p) { return sign * p[axis] - level; };
        const int kept = clip_side(buffers[current], count, height, side, near_, buffers[1 - current]);
        if (kept >= 0) continue;
        count = -1 - kept;
        current = 1 - current;
    }
    std::uint16_t vertex[4], edge[4];
    for (int i = 0; i < 4; ++i) {
        vertex[i] = static_cast<std::uint16_t>(kBoxFaces[face_][i]);
        edge[i] = box_edge(vertex[i], kBoxFaces[face_][(i + 1) % 4]);
    }
    for (int i = 0; i < count; ++i) {
        const ClipCorner& corner = buffers[current][i];
        ClippedPoint& to = clipped.point[clipped.count++];
        if (corner.before >= 0 && corner.after >= 0) {  // a corner of the incident patch
            to.on_incident = incident.point[corner.after];
            to.on_reference = to.on_incident - corner.point.z * direction;
        } else {
            glm::dvec3 foot;
            foot[k_] = level_;
            foot[u_] = corner.point.x;
            foot[v_] = corner.point.y;
            to.on_reference = box_.pose.rotation * foot + offset_;
            to.on_incident = to.on_reference + corner.point.z * direction;
        }
        to.reference = reference_feature(self, vertex, edge, 4, corner);
        to.incident = incident_feature(incident, corner, incident.count);
    }
}

void clip_segments(const Patch& reference, const Patch& incident, Clipped& clipped) {
    clipped.count = 0;
    const glm::dvec3 along = reference.point[1] - reference.point[0];
    const double length2 = glm::dot(along, along);
    if (!(length2 > 0.0)) return;
    double t[2];
    for (int k = 0; k < 2; ++k) t[k] = glm::dot(incident.point[k] - reference.point[0], along) / length2;
    const double span = t[1] - t[0];
    if (span == 0.0) return;
    const int low = span > 0.0 ? 0 : 1, high = 1 - low;
    const double from = std::max(t[low], 0.0), to = std::min(t[high], 1.0);
    if (from > to) return;
    for (const double s : {from, to}) {
        const bool begins = s == 0.0, ends = s == 1.0, first = s == t[low], last = s == t[high];
        const double on_other = (s - t[0]) / span;
        clipped.point[clipped.count++] = {
            reference.point[0] + s * along, incident.point[0] + on_other * (incident.point[1] - incident.point[0]),
            begins || ends ? Feature{FeatureKind::vertex, reference.vertex[ends ? 1 : 0]} : reference.self,
            first || last ? Feature{FeatureKind::vertex, incident.vertex[first ? low : high]} : incident.self};
        if (from == to) return;
    }
}

namespace {

// The index of the first greatest value.
template <class Value>
int greatest(int count, Value value) {
    int best = 0;
    double most = value(0);
    for (int i = 1; i < count; ++i)
        if (const double v = value(i); v > most) {
            most = v;
            best = i;
        }
    return best;
}

// Of points as deep but for rounding that which is farthest from their middle: on a flat floor a corner, not whichever
// inner point rounding made the deepest.
int deepest_corner(const ContactPoint* points, int count) {
    const glm::dvec3& first = points[0].position;
    glm::dvec3 middle(0.0);
    double depth = points[0].depth;
    for (int i = 1; i < count; ++i) {
        middle += points[i].position - first;
        depth = std::max(depth, points[i].depth);
    }
    middle *= 1.0 / static_cast<double>(count);
    const auto squared = [&](int i) {
        const glm::dvec3 way = (points[i].position - first) - middle;
        return glm::dot(way, way);
    };
    const double radius = std::sqrt(squared(greatest(count, squared)));
    return greatest(count, [&](int i) { return points[i].depth >= depth - 1e-9 * radius ? squared(i) : -1.0; });
}

// The first points that are farthest along d and against it.
struct Ends {
    int high = 0, low = 0;
};
Ends ends_along(const ContactPoint* points, int count, const glm::dvec3& from, const glm::dvec3& d) {
    Ends ends;
    double most = glm::dot(d, points[0].position - from), least = most;
    for (int i = 1; i < count; ++i) {
        const double along = glm::dot(d, points[i].position - from);
        if (along > most) most = along, ends.high = i;
        if (along < least) least = along, ends.low = i;
    }
    return ends;
}

}  // namespace

void thin_out(Manifold& manifold, const ContactPoint* points, int count, int most) {
    int kept[16], chosen = 0;
    const auto keep = [&](int i) {
        if (chosen < most && std::find(kept, kept + chosen, i) == kept + chosen) kept[chosen++] = i;
        return i;
    };
    if (count <= most) {
        for (; chosen < count; ++chosen) kept[chosen] = chosen;
    } else {
        const glm::dvec3 from = points[keep(deepest_corner(points, count))].position;
        const auto squared = [&](int i) {
            const glm::dvec3 way = points[i].position - from;
            return glm::dot(way, way);
        };
        const glm::dvec3 along = points[keep(greatest(count, squared))].position - from;
        const glm::dvec3 across = glm::cross(manifold.normal, along);
        const auto ends = [&](const glm::dvec3& d) { return ends_along(points, count, from, d); };
        const Ends sides = ends(across);
        keep(sides.high), keep(sides.low);
        if (chosen < most) {
            const Ends left = ends(along + across), right = ends(along - across);
            keep(left.high), keep(right.high), keep(right.low), keep(left.low);
        }
        std::sort(kept, kept + chosen);
    }
    manifold.count = chosen;
    manifold.depth = points[kept[0]].depth;
    for (int i = 0; i < chosen; ++i) {
        manifold.points[i] = points[kept[i]];
        manifold.depth = std::max(manifold.depth, points[kept[i]].depth);
    }
}

}  // namespace crofton::convex
