// SPDX-License-Identifier: MIT
#include <cmath>
#include <crofton/convex/distance_within.hpp>
#include <crofton/convex/query.hpp>
#include <crofton/geometry/finite.hpp>
#include <glm/matrix.hpp>
#include <limits>

#include "box_pair.hpp"
#include "core_query.hpp"
#include "deep_core.hpp"
#include "exact_gjk.hpp"
#include "part_query.hpp"

namespace crofton::convex {
namespace {

bool finite_pair(const Pair& pair) {
    return pair.size < kInfinity && std::isfinite(pair.pose_a.rotation[0].x + pair.pose_a.rotation[1].y) &&
           std::isfinite(pair.pose_b.rotation[0].x + pair.pose_b.rotation[1].y);
}

Distance half_space_distance(const ShapeAtPose& a, const ShapeAtPose& b) {
    Distance d;
    if (is_half_space(b)) {
        d.distance = d.lower = d.upper = gap_of_half_spaces(a, b, d.normal);
        return d;
    }
    const HalfSpaceGap gap = half_space_gap(a, b);
    const double apart = gap.gap - b.shape.radius();
    d.on_b = d.on_a = gap.deepest - b.shape.radius() * gap.outward;
    if (half_space_meets(a, b)) return d;
    d.distance = std::max(apart, std::numeric_limits<double>::min());
    d.lower = std::max(0.0, apart - gap.error);
    d.upper = std::max(0.0, apart + gap.error);
    d.normal = gap.outward;
    d.on_a = d.on_b - d.distance * d.normal;
    return d;
}

Penetration half_space_penetration(const ShapeAtPose& a, const ShapeAtPose& b) {
    Penetration p;
    if (is_half_space(b)) {
        p.overlapping = intersects(a, b);
        if (p.overlapping) p.depth = p.lower = p.upper = kInfinity;
        return p;
    }
    p.overlapping = half_space_meets(a, b);
    if (!p.overlapping) return p;
    const HalfSpaceGap gap = half_space_gap(a, b);
    const double depth = b.shape.radius() - gap.gap;
    p.depth = std::max(0.0, depth);
    p.lower = std::max(0.0, depth - gap.error);
    p.upper = std::max(0.0, depth + gap.error);
    p.normal = gap.outward;
    p.on_b = gap.deepest - b.shape.radius() * gap.outward;
    p.on_a = p.on_b + p.depth * p.normal;
    return p;
}

struct CorePoints {
    glm::dvec3 on_a{0.0}, on_b{0.0};  // around a's origin
};
CorePoints core_points(const Simplex& s) {
    CorePoints points;
    for (int i = 0; i < s.count; ++i) {
        points.on_a += s.weight[i] * s.corner[i].on_a;
        points.on_b += s.weight[i] * s.corner[i].on_b;
    }
    return points;
}

}  // namespace

Result<void> validate_pose(const RigidTransform& pose, std::uint64_t item) {
    if (Result<void> good = validate(pose, item); !good) return good;
    if (!(glm::determinant(pose.rotation) > 0.0))
        return fail(ErrorCode::invalid_argument, item, "pose: the matrix mirrors, which turns shapes inside out");
    return {};
}

bool intersects(const ShapeAtPose& a, const ShapeAtPose& b, PairCache* cache) {
    if (!a.shape.is_convex()) return parts_meet(a, b);
    if (!b.shape.is_convex()) return parts_meet(b, a);
    if (is_half_space(a) || is_half_space(b)) {
        if (!is_half_space(b)) return half_space_meets(a, b);
        if (!is_half_space(a)) return half_space_meets(b, a);
        glm::dvec3 normal(0.0);
        return !(gap_of_half_spaces(a, b, normal) > 0.0);
    }
    const Pair pair(a, b);
    if (!finite_pair(pair)) return false;
    if (is_solid_box(a.shape) && is_solid_box(b.shape))
        if (const std::optional<bool> meet = boxes_meet(pair)) return *meet;
    const double near = std::max(0.0, pair.rounding() - 1.5 * pair.doubt()), far = pair.rounding() + 1.5 * pair.doubt();
    if (cache != nullptr && cache->count < 4 && cache->axis != glm::dvec3(0.0)) {
        // A plane that parted them before; its normal's length is 1 within 4u.
        if (pair.extent(cache->axis) < -far * (1.0 + 0x1p-50) - pair.error) return false;
    }
    Nearest core = core_distance(pair, cache, near, far);
    remember(core, cache);
    return settle(pair, core);
}

Distance distance(const ShapeAtPose& a, const ShapeAtPose& b, PairCache* cache) {
    if (!a.shape.is_convex()) return distance_of_parts(a, b, kInfinity);
    if (!b.shape.is_convex()) return flipped(distance_of_parts(b, a, kInfinity));
    if (is_half_space(a)) return half_space_distance(a, b);
    if (is_half_space(b)) return flipped(half_space_distance(b, a));
    const Pair pair(a, b);
    if (!finite_pair(pair)) return {};
    const Nearest core = core_distance(pair, cache, 0.0, kInfinity);
    remember(core, cache);
    return distance_of(pair, core);
}

Distance distance_of(const Pair& pair, Nearest core) {
    if (core.simplex.count == 0) return {};  // a pose with NaN
    const bool meet = settle(pair, core);
    const CorePoints points = core_points(core.simplex);
    const double ra = pair.a.radius(), rb = pair.b.radius(), rounding = ra + rb;
    const double between = glm::length(points.on_a - points.on_b);
    Distance d;
    d.on_a = pair.pose_a.translation + points.on_a;
    d.on_b = pair.pose_a.translation + points.on_b;
    if (meet) {
        if (core.relation == Relation::apart && rounding > 0.0) d.on_a += ra / rounding * (d.on_b - d.on_a);
        d.on_b = d.on_a;
        return d;
    }
    d.normal = core.normal;
    d.on_a += ra * d.normal;
    d.on_b -= rb * d.normal;
    d.distance = std::max(between - rounding, std::numeric_limits<double>::min());
    d.lower = std::max(0.0, core.lower - rounding - 0x1p-52 * rounding);
    d.upper = core.upper - rounding + 0x1p-52 * rounding;
    return d;
}

Distance near_distance(const ShapeAtPose& a, const ShapeAtPose& b, double far) {
    if (is_half_space(a) || is_half_space(b)) return distance(a, b);
    const Pair pair(a, b);
    if (!finite_pair(pair)) return {};
    return distance_of(pair, core_distance(pair, nullptr, 0.0, far + pair.rounding() + 1.5 * pair.doubt()));
}

// Parts are sought below a limit, so one that is as far as the limit needs a little more.
Distance distance_within(const ShapeAtPose& a, const ShapeAtPose& b, double limit) {
    if (a.shape.is_convex() && b.shape.is_convex()) return near_distance(a, b, limit);
    const double above = limit * (1.0 + 1e-9) + std::numeric_limits<double>::min();
    return a.shape.is_convex() ? flipped(distance_of_parts(b, a, above)) : distance_of_parts(a, b, above);
}

Penetration penetration(const ShapeAtPose& a, const ShapeAtPose& b, PairCache* cache) {
    if (!a.shape.is_convex()) return penetration_of_parts(a, b);
    if (!b.shape.is_convex()) return flipped(penetration_of_parts(b, a));
    if (is_half_space(a)) return half_space_penetration(a, b);
    if (is_half_space(b)) return flipped(half_space_penetration(b, a));
    const Pair pair(a, b);
    Penetration p;
    if (!finite_pair(pair)) return p;
    const double ra = a.shape.radius(), rb = b.shape.radius(), rounding = ra + rb;
    Depth depth;
    Nearest core;
    bool deep = false;
    if (is_solid_box(a.shape) && is_solid_box(b.shape)) {
        const Warm found = depth_of_boxes(pair, depth);
        if (found == Warm::apart) return p;
        deep = found == Warm::touching;
    } else {
        deep = deep_in_closed_form(pair, depth);
    }
    if (!deep) {
        core = core_distance(pair, cache, 0.0, rounding + 1.5 * pair.doubt());
        remember(core, cache);
        if (core.simplex.count == 0 || !settle(pair, core)) return p;
    }
    CorePoints points;
    const double error_bound = 0x1p-52 * rounding;
    if (!deep && core.relation == Relation::apart) {
        if (rounding > 0.0) align_points(pair, core.normal, core);
        points = core_points(core.simplex);
        const double between = glm::length(points.on_a - points.on_b);
        p.depth = std::max(0.0, rounding - between);
        p.lower = std::max(0.0, rounding - core.upper - error_bound);
        p.upper = std::max(p.depth, rounding - core.lower + error_bound);
        p.normal = core.normal;
    } else {
        if (!deep) depth = core_depth(pair, core.simplex);
        points = core_points(depth.face);
        p.depth = std::max(0.0, depth.upper - pair.error) + rounding;
        p.lower = depth.lower + rounding - error_bound;
        p.upper = std::max(p.depth, depth.upper + rounding + error_bound);  // of round shapes `meeting` may be rounding
        p.normal = depth.normal;
        if (cache != nullptr) cache->axis = p.normal;
    }
    p.overlapping = true;
    p.on_a = pair.pose_a.translation + points.on_a + ra * p.normal;
    p.on_b = p.on_a - p.depth * p.normal;
    return p;
}

Distance closest_point(const ShapeAtPose& shape, const glm::dvec3& point) {
    const RigidTransform at{glm::dmat3(1.0), point};
    static const Shape kPoint = *Shape::sphere(0.0f);
    return distance({kPoint, at}, shape);
}

}  // namespace crofton::convex
