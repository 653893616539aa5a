// SPDX-License-Identifier: MIT
#include "clip.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace crofton::convex {
namespace {

// A corner of the clipped polygon, with the lines that meet in it: edges of the incident polygon (numbers from 0) or
// sides of the reference (−1 − number).
struct ClipCorner {
    glm::dvec3 point;
    int before, after;
};

// Returns −1 − the number of corners in `to`, or `count` with nothing written where none is outside.
int clip_side(const ClipCorner* from, int count, const glm::dvec3& outward, double level, int side, ClipCorner* to) {
    double height[kMaxClipped + 1], most = 0.0;
    for (int i = 0; i < count; ++i) {
        height[i] = glm::dot(outward, from[i].point) - level;
        most = height[i] > most ? height[i] : most;
    }
    if (most == 0.0) return count;
    height[count] = height[0];
    int kept = 0;
    for (int i = 0; i < count; ++i) {
        const ClipCorner& a = from[i];
        const double ha = height[i], hb = height[i + 1];
        if (ha <= 0.0) {
            to[kept] = a;
            if (ha == 0.0 && hb > 0.0) to[kept].after = -1 - side;
            ++kept;
        }
        if ((ha < 0.0 && hb > 0.0) || (ha > 0.0 && hb < 0.0)) {
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

Feature reference_feature(const Patch& patch, const ClipCorner& corner) {
    if (corner.before >= 0 && corner.after >= 0) return patch.self;
    if (corner.before < 0 && corner.after < 0) {
        const int first = -1 - corner.before, second = -1 - corner.after;
        // The common corner of two sides is where the later begins; of sides apart, the face stands for it.
        if ((first + 1) % patch.count == second) return {FeatureKind::vertex, patch.vertex[second]};
        if ((second + 1) % patch.count == first) return {FeatureKind::vertex, patch.vertex[first]};
        return patch.self;
    }
    return {FeatureKind::edge, patch.edge[-1 - std::min(corner.before, corner.after)]};
}

}  // namespace

void find_sides(const Patch& polygon, const glm::dvec3& direction, Prism& sides) {
    sides.count = polygon.count;
    for (int k = 0; k < polygon.count; ++k) {
        const glm::dvec3 &p = polygon.point[k], &q = polygon.point[k + 1 < polygon.count ? k + 1 : 0];
        sides.outward[k] = glm::cross(q - p, direction);
        sides.level[k] = glm::dot(sides.outward[k], p);
    }
}

void clip(const Patch& reference, const Prism& sides, const Patch& incident, const glm::dvec3& direction,
          Clipped& clipped) {
    clipped.count = 0;
    const double steepness = glm::dot(reference.normal, direction);
    if (!(steepness > 0.05)) return;
    ClipCorner buffers[2][kMaxClipped];
    int count = incident.count, current = 0;
    for (int i = 0; i < count; ++i) buffers[0][i] = {incident.point[i], i == 0 ? count - 1 : i - 1, i};
    for (int side = 0; side < sides.count && count > 0; ++side) {
        // Room for two more each time: a convex polygon crosses a line twice.
        if (count + 2 > kMaxClipped) return;
        const int kept =
            clip_side(buffers[current], count, sides.outward[side], sides.level[side], side, buffers[1 - current]);
        if (kept >= 0) continue;
        count = -1 - kept;
        current = 1 - current;
    }
    for (int i = 0; i < count; ++i) {
        const ClipCorner& corner = buffers[current][i];
        const double height = glm::dot(reference.normal, corner.point - reference.point[0]) / steepness;
        clipped.point[clipped.count++] = {corner.point - height * direction, corner.point,
                                          reference_feature(reference, corner),
                                          incident_feature(incident, corner, incident.count)};
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
int deepest_corner(const RawPoint* points, int count) {
    glm::dvec3 middle(0.0);
    for (int i = 0; i < count; ++i) middle += points[i].position / static_cast<double>(count);
    const auto squared = [&](int i) {
        const glm::dvec3 way = points[i].position - middle;
        return glm::dot(way, way);
    };
    const double depth = points[greatest(count, [&](int i) { return points[i].depth; })].depth;
    const double reach = std::sqrt(squared(greatest(count, squared)));
    return greatest(count, [&](int i) { return points[i].depth >= depth - 1e-9 * reach ? squared(i) : -1.0; });
}

}  // namespace

void thin_out(Manifold& manifold, const RawPoint* points, int count, int most) {
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
        const auto keep_farthest = [&](const glm::dvec3& d) {
            if (chosen < most)
                keep(greatest(count, [&points, &from, d](int i) { return glm::dot(d, points[i].position - from); }));
        };
        keep_farthest(across);
        keep_farthest(-across);
        for (const double turn : {1.0, -1.0})
            for (const double side : {1.0, -1.0}) keep_farthest(turn * along + side * across);
    }
    std::sort(kept, kept + chosen);
    manifold.count = chosen;
    manifold.depth = points[kept[0]].depth;
    for (int i = 0; i < chosen; ++i) {
        const RawPoint& p = points[kept[i]];
        manifold.points[i] = {p.position, p.depth, p.on_a, p.on_b, p.part_a, p.part_b};
        manifold.depth = std::max(manifold.depth, points[kept[i]].depth);
    }
}

}  // namespace crofton::convex
