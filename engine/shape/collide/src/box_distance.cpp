// SPDX-License-Identifier: MIT
// The distance of two boxes, or of a box and a segment: GJK on their corners, with a proof of the answer. If rounding
// prevents the proof, tries the features near the answer one by one.
#include <algorithm>
#include <cmath>
#include <crofton/collide/bound_contacts.hpp>
#include <crofton/geometry/closest_points.hpp>
#include <glm/geometric.hpp>
#include <initializer_list>
#include <limits>
#include <utility>

#include "box_penetration.hpp"

namespace crofton::collide {
namespace {

// Boxes that do not meet are never nearer.
constexpr double kLeastDistance = 1e-150;
// The distance is accepted when it is above a proven lower bound by no more than this part of the pair's size.
constexpr double kAccepted = 1e-13;
// A way that is longer than this part of the size is no rounding error: what it parts does not meet.
constexpr double kMeetsWithin = 1e-12;

// A point of each box by its coordinates along the axes, and the way from the first to the second.
struct PointPair {
    double at[2][3] = {};
    glm::dvec3 way{0.0};
    // The same way, or one across all axes along which the points are inside their boxes: short ways have rounding
    // errors that are large for their length, but the axes have none.
    glm::dvec3 direction{0.0};  // of a FeatureSearch only
};

glm::dvec3 way_of(const BoxPairInDouble& pair, const double (&at)[2][3]) {
    glm::dvec3 way = pair.offset;
    for (int k = 0; k < 3; ++k) way += at[1][k] * pair.axes[1][k] - at[0][k] * pair.axes[0][k];
    return way;
}

// A corner of each box, and the way from the first to the second.
struct CornerPair {
    glm::dvec3 way{0.0};
    std::uint32_t signs = 0;  // bit 3 · side + k: a corner of a at −half along axis k, or one of b at +half
};

// The corners nearest to each other along `direction`.
CornerPair support(const BoxPairInDouble& pair, const glm::dvec3& direction) {
    CornerPair result{pair.offset, 0};
    for (int side = 0; side < 2; ++side)
        for (int k = 0; k < 3; ++k) {  // without branches, which nothing could predict
            const double along = glm::dot(pair.axes[side][k], direction);
            result.way -= std::copysign(pair.half[side][k], along) * pair.axes[side][k];
            result.signs |= (std::signbit(along) ? 1u : 0u) << (3 * side + k);
        }
    return result;
}

struct CornerSimplex {
    CornerPair point[4];
    int count = 0;
};

// The point of a simplex's hull that is nearest to the origin, as a blend of few of its points.
struct Blend {
    glm::dvec3 way{0.0};
    double squared = 0.0;
    double weight[4] = {};
    int index[4] = {};
    int count = 0;
};

Blend blend_of(const CornerSimplex& s, int i) {
    const glm::dvec3& way = s.point[i].way;
    return {way, glm::dot(way, way), {1.0}, {i}, 1};
}

Blend nearest_on_segment(const CornerSimplex& s, int i, int j) {
    const glm::dvec3 &p = s.point[i].way, u = s.point[j].way - p;
    const double along = -glm::dot(p, u), length2 = glm::dot(u, u);
    if (!(along > 0.0)) return blend_of(s, i);
    if (!(along < length2)) return blend_of(s, j);
    const double t = along / length2;
    const glm::dvec3 way = p + t * u;
    return {way, glm::dot(way, way), {1.0 - t, t}, {i, j}, 2};
}

const Blend& nearer_of(const Blend& a, const Blend& b) {
    return b.squared < a.squared ? b : a;
}

// By the regions around a triangle (Ericson, Real-Time Collision Detection, 5.1.5). k is the newest point: the edge
// without it did not improve when it was found.
Blend nearest_on_triangle(const CornerSimplex& s, int i, int j, int k) {
    const glm::dvec3 &a = s.point[i].way, &b = s.point[j].way, &c = s.point[k].way;
    const glm::dvec3 ab = b - a, ac = c - a;
    const double d1 = -glm::dot(ab, a), d2 = -glm::dot(ac, a), d3 = -glm::dot(ab, b), d4 = -glm::dot(ac, b),
                 d5 = -glm::dot(ab, c), d6 = -glm::dot(ac, c);
    const double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
    if (va > 0.0 && vb > 0.0 && vc > 0.0) {
        const double scale = 1.0 / (va + vb + vc), v = vb * scale, w = vc * scale;
        const glm::dvec3 way = a + v * ab + w * ac;
        return {way, glm::dot(way, way), {1.0 - v - w, v, w}, {i, j, k}, 3};
    }
    return nearer_of(nearest_on_segment(s, j, k), nearest_on_segment(s, i, k));
}

// Of the faces that have the last point: the other did not improve when that point was found.
Blend nearest_on_tetrahedron(const CornerSimplex& s) {
    const glm::dvec3 &a = s.point[0].way, &b = s.point[1].way, &c = s.point[2].way, &d = s.point[3].way;
    const double scale = 1.0 / glm::dot(glm::cross(b - a, c - a), d - a);
    const double w0 = glm::dot(glm::cross(b, c), d) * scale, w1 = -glm::dot(glm::cross(a, c), d) * scale,
                 w2 = glm::dot(glm::cross(a, b), d) * scale, w3 = 1.0 - w0 - w1 - w2;
    if (w0 > 0.0 && w1 > 0.0 && w2 > 0.0 && w3 > 0.0) {
        const glm::dvec3 way = w0 * a + w1 * b + w2 * c + w3 * d;
        return {way, glm::dot(way, way), {w0, w1, w2, w3}, {0, 1, 2, 3}, 4};
    }
    return nearer_of(nearer_of(nearest_on_triangle(s, 0, 1, 3), nearest_on_triangle(s, 1, 2, 3)),
                     nearest_on_triangle(s, 0, 2, 3));
}

Blend nearest_of(const CornerSimplex& s) {
    if (s.count == 2) return nearest_on_segment(s, 0, 1);
    return s.count == 3 ? nearest_on_triangle(s, 0, 1, 2) : nearest_on_tetrahedron(s);
}

PointPair blended(const BoxPairInDouble& pair, const CornerSimplex& s, const Blend& blend) {
    PointPair result;
    for (int n = 0; n < blend.count; ++n)
        for (int side = 0; side < 2; ++side)
            for (int k = 0; k < 3; ++k) {
                const bool other = (s.point[blend.index[n]].signs >> (3 * side + k) & 1u) != 0;
                const double end = other == (side == 0) ? -pair.half[side][k] : pair.half[side][k];
                result.at[side][k] += blend.weight[n] * end;
            }
    result.way = blend.way;
    return result;
}

// No two points of the boxes are nearer than the slab between the boxes is wide, whatever its direction.
double gap_along(const BoxPairInDouble& pair, const glm::dvec3& direction) {
    return glm::dot(direction, support(pair, direction).way) / glm::length(direction);
}

// `axis` separates the boxes, or nearly; `least` is a lower bound of the distance.
PointPair descend(const BoxPairInDouble& pair, const glm::dvec3& axis, double least, bool& proven) {
    const double accepted = kAccepted * pair.size;
    CornerSimplex simplex;
    simplex.point[simplex.count++] = support(pair, axis);
    Blend best = blend_of(simplex, 0);
    proven = false;
    for (int round = 0; round < 32 && best.squared > kLeastDistance * kLeastDistance; ++round) {
        const double length = std::sqrt(best.squared);
        proven = length - least <= accepted;
        if (proven || simplex.count == 4) break;
        const CornerPair next = support(pair, best.way);
        proven = best.squared - glm::dot(best.way, next.way) <= accepted * length;
        if (proven) break;
        simplex.point[simplex.count++] = next;
        const Blend nearer = nearest_of(simplex);
        if (!(nearer.squared < best.squared)) break;
        best = nearer;
        for (int n = 0; n < best.count; ++n) {  // indices ascend
            simplex.point[n] = simplex.point[best.index[n]];
            best.index[n] = n;
        }
        simplex.count = best.count;
    }
    return blended(pair, simplex, best);
}

// All pairs of features: corners, edges and faces that are free within `tolerance` of `direction`. A pair of points is
// given by the axes along which it is inside the box, at most two. Along the others it is at an end of the box.
class FeatureSearch {
  public:
    FeatureSearch(const BoxPairInDouble& pair, const glm::dvec3& direction, double tolerance) : pair_(pair) {
        for (int axis = 0; axis < 6; ++axis) {
            const double slope = glm::dot(pair.axes[axis / 3][axis % 3], direction) * (axis < 3 ? 1.0 : -1.0);
            is_free_[axis] = std::abs(slope) * half(axis) <= tolerance;
            end_[axis] = slope < 0.0 ? -half(axis) : half(axis);
        }
    }

    PointPair find() {
        choose(0, 0);
        return best_;
    }

  private:
    [[nodiscard]] double half(int axis) const { return pair_.half[axis / 3][axis % 3]; }
    [[nodiscard]] glm::dvec3 column(int axis) const {
        return axis < 3 ? -pair_.axes[0][axis] : pair_.axes[1][axis - 3];
    }
    double& at(int axis) { return at_[axis / 3][axis % 3]; }

    void choose(int axis, int inside) {
        if (axis == 6) return inside_are_nearest(inside);
        if (!is_free_[axis] || half(axis) == 0.0) {
            at(axis) = end_[axis];
            return choose(axis + 1, inside);
        }
        for (const double end : {-half(axis), half(axis)}) {
            at(axis) = end;
            choose(axis + 1, inside);
        }
        if (inside == 2) return;
        at(axis) = 0.0;
        inside_[inside] = axis;
        choose(axis + 1, inside + 1);
    }

    void inside_are_nearest(int inside) {
        double value[2] = {0.0, 0.0};
        glm::dvec3 across(0.0);
        const glm::dvec3 rest = way_of(pair_, at_);
        if (inside == 1) {
            const glm::dvec3 u = column(inside_[0]);
            value[0] = -glm::dot(rest, u) / glm::dot(u, u);
        } else if (inside == 2) {
            const glm::dvec3 u = column(inside_[0]), v = column(inside_[1]), n = glm::cross(u, v);
            const double squared = glm::dot(n, n);
            across = n;
            value[0] = -glm::dot(glm::cross(rest, v), n) / squared;
            value[1] = glm::dot(glm::cross(rest, u), n) / squared;
        }
        for (int i = 0; i < inside; ++i)
            if (!(std::abs(value[i]) <= half(inside_[i]))) return;
        PointPair candidate;
        std::copy(&at_[0][0], &at_[0][0] + 6, &candidate.at[0][0]);
        for (int i = 0; i < inside; ++i) candidate.at[inside_[i] / 3][inside_[i] % 3] = value[i];
        candidate.way = way_of(pair_, candidate.at);
        const double squared = glm::dot(candidate.way, candidate.way);
        if (!(squared < least_)) return;
        candidate.direction = candidate.way;
        if (inside == 2) {
            candidate.direction = glm::dot(across, candidate.way) < 0.0 ? -across : across;
        } else if (inside == 1) {
            const glm::dvec3 u = column(inside_[0]);
            for (int pass = 0; pass < 2; ++pass)
                candidate.direction -= glm::dot(candidate.direction, u) / glm::dot(u, u) * u;
        }
        least_ = squared;
        best_ = candidate;
    }

    const BoxPairInDouble& pair_;
    bool is_free_[6];
    double end_[6];
    double at_[2][3] = {};
    int inside_[2] = {0, 0};
    PointPair best_;
    double least_ = std::numeric_limits<double>::infinity();
};

// Tries ever more features until the answer is proven, in the end all of them.
PointPair search_features(const BoxPairInDouble& pair, PointPair best) {
    for (const double tolerance : {1e-9, 1e-5, 1e300}) {
        const double squared = glm::dot(best.way, best.way);
        if (!(squared > kLeastDistance * kLeastDistance)) break;
        const PointPair found = FeatureSearch(pair, best.way / std::sqrt(squared), tolerance * pair.size).find();
        if (glm::dot(found.way, found.way) < squared) best = found;
        if (glm::length(best.way) - gap_along(pair, best.direction) <= kAccepted * pair.size) break;
    }
    return best;
}

// Where the skins of shapes overlap, both points are the middle of the overlap. `core` is that of what they are around.
void grow_by_radii(double radius_a, double radius_b, const glm::dvec3& way, Distance& core) {
    const double apart = core.distance;
    core.distance = std::max(0.0, apart - radius_a - radius_b);
    if (!(apart > 0.0)) return;
    const double length = glm::length(way);
    const glm::dvec3 direction = length > 0.0 ? way / length : glm::dvec3(0.0);
    const double from_a = core.distance > 0.0 ? radius_a : std::clamp(0.5 * (apart + radius_a - radius_b), 0.0, apart);
    const double from_b = core.distance > 0.0 ? radius_b : apart - from_a;
    core.on_a += from_a * direction;
    core.on_b -= from_b * direction;
}

}  // namespace

Distance distance(const Obb& box, const Capsule& capsule) {
    const glm::dvec3 begin = capsule.begin - box.center, end = capsule.end - box.center;
    const BoxPairInDouble pair(box, 0.5 * (begin + end), 0.5 * (end - begin));
    bool proven = false;
    PointPair nearest = descend(pair, pair.offset, 0.0, proven);
    const double least = glm::length(nearest.way);
    // A segment is a triangle without area.
    const bool meet = (!proven || least <= kMeetsWithin * pair.size) &&
                      intersects(box, Triangle{capsule.begin, capsule.end, capsule.end});
    if (!proven && !meet) nearest = search_features(pair, nearest);
    Distance result;
    result.distance = meet ? 0.0 : std::max(kLeastDistance, glm::length(nearest.way));
    result.on_a = box.center;
    for (int k = 0; k < 3; ++k) result.on_a += nearest.at[0][k] * pair.axes[0][k];
    result.on_b = box.center + (pair.offset + nearest.at[1][0] * pair.axes[1][0]);
    if (meet) result.on_a = result.on_b = 0.5 * (result.on_a + result.on_b);
    grow_by_radii(0.0, capsule.radius, nearest.way, result);
    return result;
}

Distance distance(const Capsule& capsule, const Sphere& sphere) {
    Distance result;
    result.on_a = closest_on_segment(sphere.center, capsule.begin, capsule.end);
    result.on_b = sphere.center;
    const glm::dvec3 way = result.on_b - result.on_a;
    result.distance = glm::length(way);
    grow_by_radii(capsule.radius, sphere.radius, way, result);
    return result;
}

Distance distance(const Obb& a, const Obb& b) {
    const BoxPairInDouble pair(a, b);
    const AxisMeasures measures = measures_of(a, b);
    const bool meet = measures.surely_meet || (!measures.surely_apart && intersects(a, b));
    const int least = least_axis(measures);
    glm::dvec3 axis = pair.axis(least);
    if (glm::dot(axis, pair.offset) < 0.0) axis = -axis;
    bool proven = false;
    PointPair nearest = descend(pair, axis, -depth_along(measures, least), proven);
    if (!proven && !meet) nearest = search_features(pair, nearest);
    Distance result;
    result.distance = meet ? 0.0 : std::max(kLeastDistance, glm::length(nearest.way));
    result.on_a = a.center;
    result.on_b = b.center;
    for (int k = 0; k < 3; ++k) {
        result.on_a += nearest.at[0][k] * pair.axes[0][k];
        result.on_b += nearest.at[1][k] * pair.axes[1][k];
    }
    if (meet) result.on_a = result.on_b = 0.5 * (result.on_a + result.on_b);
    return result;
}

}  // namespace crofton::collide
