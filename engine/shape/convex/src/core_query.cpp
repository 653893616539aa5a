// SPDX-License-Identifier: MIT
#include "core_query.hpp"

#include <algorithm>
#include <limits>

#include "exact_gjk.hpp"

namespace crofton::convex {

namespace {

// Of round cores, whose search no exact one follows. Rounding may stop it early: beside a needle, or where the corners
// of the simplex are nearly on a line, at about one in 10,000 pairs that nearly touch. From elsewhere it may go on.
void search_anew(const Pair& pair, double near, double far, Nearest& found) {
    const auto is_done = [&] {
        return found.relation == Relation::overlapping || found.simplex.inside || found.simplex.count == 0 ||
               found.upper <= near || found.lower > far || found.upper - found.lower <= 1e-11 * pair.size;
    };
    for (int from = 0; from < 3 && !is_done(); ++from) {
        PairCache start;
        if (from == 1) start.axis = found.normal;
        if (from == 2) start.axis = -witness(found.simplex);
        const Nearest other = nearest_points(pair, &start, near, far);
        if (other.simplex.inside) {
            if (found.lower <= 0.0) found = other;
            return;
        }
        if (other.lower > found.lower) found.lower = other.lower, found.normal = other.normal;
        if (other.upper < found.upper) found.upper = other.upper, found.simplex = other.simplex;
        if (found.lower > 0.0) found.relation = Relation::apart;
    }
}

}  // namespace

Nearest core_distance(const Pair& pair, const PairCache* cache, double near, double far, double accuracy) {
    Nearest found = nearest_points(pair, cache, near, far);
    if (!pair.has_polytope_cores()) search_anew(pair, near, far, found);
    if (!pair.has_polytope_cores() || found.relation == Relation::overlapping) return found;
    const bool surely_near = near > 0.0 && found.upper <= near;
    if (surely_near || (found.relation == Relation::apart && (found.lower > far || found.upper <= near))) return found;
    const bool close_enough = found.upper - found.lower <= accuracy * pair.size;
    if (found.relation == Relation::apart && close_enough) return found;
    // The corners seem to contain the origin: a distance of 0, which is none if they turn out to be apart.
    const bool seems_inside = found.simplex.inside;
    const ExactNearest exact =
        exact_nearest(pair, found.simplex, !close_enough || found.upper > far || (seems_inside && far > 0.0));
    found.relation = exact.meet ? Relation::overlapping : Relation::apart;
    if (exact.meet) {
        found.simplex = exact.simplex;
        found.lower = found.upper = 0.0;
        return found;
    }
    const double lower = std::max(0.0, -pair.extent(exact.normal) - pair.error);
    if (lower >= found.lower || found.normal == glm::dvec3(0.0)) found.lower = lower, found.normal = exact.normal;
    const double upper = glm::length(witness(exact.simplex)) + pair.error;
    if (upper <= found.upper || seems_inside) found.upper = upper, found.simplex = exact.simplex;
    return found;
}

// A distance is right to the square of what its points are off.
void align_points(const Pair& pair, const glm::dvec3& normal, Nearest& found) {
    const glm::dvec3 way = witness(found.simplex);
    const double off = glm::length(way - glm::dot(way, normal) * normal);
    if (!pair.has_polytope_cores() || !(off > 1e-10 * pair.size)) return;
    const ExactNearest exact = exact_nearest(pair, found.simplex, true);
    if (exact.meet) return;
    found.simplex = exact.simplex;
    found.normal = exact.normal;
}

namespace {

// An order of placed shapes that is the same whichever comes first in a query.
bool comes_first(const Shape& a, const RigidTransform& pose_a, const Shape& b, const RigidTransform& pose_b) {
    if (a.kind() != b.kind()) return a.kind() < b.kind();
    if (a.radius() != b.radius()) return a.radius() < b.radius();
    if (a.core_radius() != b.core_radius()) return a.core_radius() < b.core_radius();
    for (int k = 0; k < 3; ++k)
        if (pose_a.translation[k] != pose_b.translation[k]) return pose_a.translation[k] < pose_b.translation[k];
    for (int k = 0; k < 3; ++k)
        for (int i = 0; i < 3; ++i)
            if (pose_a.rotation[k][i] != pose_b.rotation[k][i]) return pose_a.rotation[k][i] < pose_b.rotation[k][i];
    return true;
}

// Turns the answer for the pair in the other order into one for this order.
Nearest seen_from_other(Nearest nearest, const glm::dvec3& offset) {
    for (int i = 0; i < nearest.simplex.count; ++i) {
        Corner& corner = nearest.simplex.corner[i];
        corner = {corner.on_b + offset, corner.on_a + offset, -corner.w, corner.b, corner.a};
    }
    nearest.simplex.nearest = -nearest.simplex.nearest;
    nearest.normal = -nearest.normal;
    return nearest;
}

Nearest deciding_search(const Pair& pair) {
    constexpr double kAccuracy = 0.25 * kRoundedDoubt, kFar = std::numeric_limits<double>::infinity();
    if (comes_first(pair.a, pair.pose_a, pair.b, pair.pose_b))
        return core_distance(pair, nullptr, 0.0, kFar, kAccuracy);
    const Pair other({pair.b, pair.pose_b}, {pair.a, pair.pose_a});
    return seen_from_other(core_distance(other, nullptr, 0.0, kFar, kAccuracy), pair.offset);
}

}  // namespace

bool settle(const Pair& pair, Nearest& core) {
    const double rounding = pair.rounding(), doubt = pair.doubt();
    if (core.relation == Relation::overlapping) return true;
    if (doubt == 0.0) return core.relation != Relation::apart;
    if (core.lower > rounding + doubt) return false;
    if (core.upper < rounding - doubt) return true;
    core = deciding_search(pair);
    // Without a plane that parts them the cores count as meeting.
    return core.relation != Relation::apart || glm::length(witness(core.simplex)) <= rounding;
}

namespace {

// The deepest points: with b moved out of a along the normal and a little farther they are the nearest ones. If those
// lie along another direction, that one may be less deep.
void find_face(const Pair& pair, Depth& depth) {
    const double beyond = 1e-3 * pair.size;
    for (int round = 0; round < 4; ++round) {
        const glm::dvec3 shift = (depth.upper + beyond) * depth.normal;
        RigidTransform moved = pair.pose_b;
        moved.translation += shift;
        const Pair moved_pair({pair.a, pair.pose_a}, {pair.b, moved});
        Nearest apart = core_distance(moved_pair, nullptr, 0.0, std::numeric_limits<double>::max());
        if (apart.relation == Relation::apart) align_points(moved_pair, depth.normal, apart);
        depth.face = apart.simplex;
        for (int i = 0; i < depth.face.count; ++i) {
            depth.face.corner[i].on_b -= shift;
            depth.face.corner[i].w += shift;
        }
        const glm::dvec3 way = witness(depth.face);
        const double length = glm::length(way);
        if (!(length > 0.0)) break;
        const double upper = pair.extent(way / length) + pair.error;
        if (!(upper < depth.upper - 4.0 * pair.error)) break;
        depth.upper = upper;
        depth.normal = way / length;
    }
    depth.has_face = true;
}

}  // namespace

Depth core_depth(const Pair& pair, const Simplex& start) {
    Depth depth = expand(pair, start);
    if (pair.has_polytope_cores() && depth.upper - depth.lower > 0.5e-9 * pair.size) {
        depth = depth_by_axes(pair, depth);
        depth.has_face = false;
    }
    if (!depth.has_face) find_face(pair, depth);
    return depth;
}

// The image of { n·x + offset ≥ 0 } under y = R x + t is { (cof(R) n)·(y − t) + det(R) offset ≥ 0 }.
HalfSpaceGap half_space_gap(const ShapeAtPose& half_space, const ShapeAtPose& shape) {
    const glm::dmat3& r = half_space.pose.rotation;
    const glm::dmat3 cofactor(glm::cross(r[1], r[2]), glm::cross(r[2], r[0]), glm::cross(r[0], r[1]));
    const Plane& plane = half_space.shape.plane();
    const glm::dvec3 normal = cofactor * plane.normal;
    const double length = glm::length(normal);
    HalfSpaceGap result;
    result.outward = -normal / length;
    const double level = glm::dot(r[0], cofactor[0]) * plane.offset / length;
    const glm::dvec3 offset = shape.pose.translation - half_space.pose.translation;
    const Support deepest = core_support(shape.shape, Pair::local(shape.pose.rotation, -result.outward));
    result.gap = -((deepest.along + glm::dot(-result.outward, offset)) + level);
    result.error = 0x1p-47 * (shape.shape.core_radius() + glm::length(offset) + std::abs(level));
    result.deepest = shape.pose.rotation * deepest.point + shape.pose.translation;
    return result;
}

bool half_space_meets(const ShapeAtPose& half_space, const ShapeAtPose& shape) {
    const HalfSpaceGap gap = half_space_gap(half_space, shape);
    const double apart = gap.gap - shape.shape.radius();
    if (apart > gap.error) return false;
    if (apart < -gap.error) return true;
    if (!std::isfinite(apart)) return false;
    return shape.shape.is_polytope() ? meets_half_space(shape, half_space) : apart <= 0.0;
}

double gap_of_half_spaces(const ShapeAtPose& a, const ShapeAtPose& b, glm::dvec3& normal) {
    // b's part that lies deepest along a's normal: a plane of points, or all directions.
    const glm::dmat3 &ra = a.pose.rotation, &rb = b.pose.rotation;
    const glm::dvec3 na = glm::normalize(ra * a.shape.plane().normal), nb = glm::normalize(rb * b.shape.plane().normal);
    if (glm::cross(na, nb) != glm::dvec3(0.0) || glm::dot(na, nb) > 0.0) return 0.0;
    const glm::dvec3 offset = b.pose.translation - a.pose.translation;
    const double apart = -(a.shape.plane().offset / glm::length(a.shape.plane().normal) +
                           b.shape.plane().offset / glm::length(b.shape.plane().normal) + glm::dot(na, offset));
    normal = -na;
    return std::max(0.0, apart);
}

}  // namespace crofton::convex
