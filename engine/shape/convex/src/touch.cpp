// SPDX-License-Identifier: MIT
#include "touch.hpp"

#include <algorithm>
#include <cmath>
#include <glm/matrix.hpp>
#include <limits>

#include "core_query.hpp"
#include "deep_core.hpp"

namespace crofton::convex {
namespace {

void set_points(const Simplex& s, Touch& touch) {
    touch.on_a = touch.on_b = glm::dvec3(0.0);
    touch.vertex_count = 0;
    for (int i = 0; i < s.count; ++i) {
        touch.on_a += s.weight[i] * s.corner[i].on_a;
        touch.on_b += s.weight[i] * s.corner[i].on_b;
        if (s.weight[i] <= 1e-9) continue;
        touch.vertices_a[touch.vertex_count] = s.corner[i].a;
        touch.vertices_b[touch.vertex_count++] = s.corner[i].b;
    }
}

void set_depth(const Pair& pair, const Depth& depth, PairCache* cache, Touch& touch) {
    set_points(depth.face, touch);
    touch.depth = std::max(0.0, depth.upper - pair.error) + pair.rounding();
    touch.normal = depth.normal;
    if (cache != nullptr) cache->axis = touch.normal;
}

// A sphere within the core, around a point given from its origin.
struct InnerSphere {
    glm::dvec3 center;
    double radius;
};
InnerSphere inner_sphere(const ShapeAtPose& p) {
    if (p.shape.hull() != nullptr)
        return {p.pose.rotation * p.shape.hull()->mass().center, p.shape.hull()->inner_radius()};
    if (p.shape.kind() == Kind::triangle)
        return {p.pose.rotation * ((p.shape.vertex(0) + p.shape.vertex(1) + p.shape.vertex(2)) / 3.0), 0.0};
    const glm::dvec3& h = p.shape.half_extents();
    return {glm::dvec3(0.0), p.shape.kind() == Kind::box ? 0.999 * std::min(h.x, std::min(h.y, h.z)) : 0.0};
}

// How far `x` is within the sides of a prism: the least distance, negative outside.
double distance_within(const Prism& sides, const glm::dvec3& x) {
    double least = std::numeric_limits<double>::infinity();  // squared, with its sign
    for (int k = 0; k < sides.count; ++k) {
        const double along = sides.level[k] - glm::dot(sides.outward[k], x);
        least = std::min(least, along * std::abs(along) / glm::dot(sides.outward[k], sides.outward[k]));
    }
    return least < 0.0 ? -std::sqrt(-least) : std::sqrt(least);
}

// The same for the clipped polygon and the mean of its corners; 0 where it is a point.
double inner_distance(const Clipped& clipped, const glm::dvec3& direction) {
    glm::dvec3 mean(0.0);
    for (int i = 0; i < clipped.count; ++i) mean += clipped.point[i].on_incident / static_cast<double>(clipped.count);
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < clipped.count; ++i) {
        const glm::dvec3 &p = clipped.point[i].on_incident,
                         &q = clipped.point[i + 1 < clipped.count ? i + 1 : 0].on_incident;
        const glm::dvec3 outward = glm::cross(q - p, direction);
        const double length = glm::length(outward);
        if (length > 0.0) least = std::min(least, std::abs(glm::dot(outward, p - mean)) / length);
    }
    return least < std::numeric_limits<double>::infinity() ? least : 0.0;
}

// How far points of the difference body are beyond the origin along a unit vector.
struct Depths {
    double least, most;
};

// Whether no direction is less deep than `depths.least`. The difference body has, across the unit vector n at these
// depths, for each direction a point at least `inner` from the axis. At an angle t from n its extent is at least d ·
// cos t + inner · sin t, with d the least depth up to a right angle and the most beyond. That is no less than the least
// depth up to t = 2 atan(inner / most). Beyond, there is the sphere of radius R around c within the difference body.
// At the angle s = π − t from −n it has extent −c·n cos s − |c across n| sin s + R. That falls with s up to a right
// angle, so its value at the last s decides.
bool least_deep(const ShapeAtPose& a, const ShapeAtPose& b, const Pair& pair, const glm::dvec3& n, const Depths& depths,
                double inner) {
    // What rounding may have made of a touch counts as none.
    if (!(depths.least > 4.0 * pair.error) || !(inner > depths.most)) return false;
    const InnerSphere in_a = inner_sphere(a), in_b = inner_sphere(b);
    const glm::dvec3 c = in_a.center - in_b.center - pair.offset;
    const double along = -glm::dot(n, c), across = glm::length(c + along * n);
    const double t = depths.most / inner, cosine = (1.0 - t * t) / (1.0 + t * t), sine = 2.0 * t / (1.0 + t * t);
    const double from_sphere = along * cosine - across * sine + (in_a.radius + in_b.radius);
    return along >= 0.0 && from_sphere >= depths.least + pair.error;
}

// How far the points of a face are from one plane across a direction. Hulls have faces that are not quite flat; the
// rounded normal of a sliver is not across it.
double unevenness(const Patch& face, const glm::dvec3& direction) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (int i = 0; i < face.count; ++i) {
        const double along = glm::dot(direction, face.point[i]);
        low = std::min(low, along);
        high = std::max(high, along);
    }
    return high - low;
}

}  // namespace

bool find_touch(const Pair& pair, double margin, PairCache* cache, Touch& touch) {
    if (!(pair.size < std::numeric_limits<double>::infinity())) return false;
    const double rounding = pair.rounding();
    Depth depth;
    if (deep_in_closed_form(pair, depth)) {
        set_depth(pair, depth, cache, touch);
        return true;
    }
    Nearest core = core_distance(pair, cache, 0.0, rounding + margin + 1.5 * pair.doubt());
    remember(core, cache);
    if (core.simplex.count == 0) return false;
    const bool meet = settle(pair, core);
    if (!meet && (margin == 0.0 || core.lower > rounding + margin)) return false;
    if (core.relation == Relation::apart) {
        if (rounding + margin > 0.0) align_points(pair, core.normal, core);
        set_points(core.simplex, touch);
        touch.depth = rounding - glm::length(touch.on_a - touch.on_b);
        touch.depth = meet ? std::max(0.0, touch.depth) : std::min(0.0, touch.depth);
        touch.normal = core.normal;
        return touch.depth >= -margin;
    }
    depth = core_depth(pair, core.simplex);
    set_depth(pair, depth, cache, touch);
    return true;
}

namespace {

// As Pair::support() along the normal of a hull's face: the face's own farthest vertex is known. That the normal is
// rounded, and so is what told the vertex, makes `along` off by 28 u of the size at most, below `error`.
Corner support_of_hull_face(const Pair& pair, bool on_a, int face, const glm::dvec3& d, double& along) {
    const Shape &shape = on_a ? pair.a : pair.b, &other = on_a ? pair.b : pair.a;
    const RigidTransform &pose = on_a ? pair.pose_a : pair.pose_b, &other_pose = on_a ? pair.pose_b : pair.pose_a;
    const int vertex = shape.hull()->face_support(face);
    const glm::dvec3 point = shape.vertex(vertex), out = on_a ? d : -d;
    const Support opposite = core_support(other, Pair::local(other_pose.rotation, -out));
    along = glm::dot(out, pose.rotation * point) + (opposite.along - glm::dot(d, pair.offset));
    return on_a ? pair.corner(point, opposite.point, vertex, opposite.vertex)
                : pair.corner(opposite.point, point, opposite.vertex, vertex);
}

}  // namespace

Warm touch_at_face(const ShapeAtPose& a, const ShapeAtPose& b, const Pair& pair, double margin, const PairCache& cache,
                   double kept_share, Touch& touch, Clipped& clipped) {
    const bool on_a = cache.reference == 1;
    const ShapeAtPose &reference = on_a ? a : b, &incident = on_a ? b : a;
    const Shape& shape = reference.shape;
    const bool valid = shape.kind() == Kind::box
                           ? cache.face < 6
                           : (shape.kind() == Kind::hull && cache.face < shape.hull()->face_count()) ||
                                 (shape.kind() == Kind::triangle && cache.face == 0);
    if (!valid || (incident.shape.kind() != Kind::box && incident.shape.kind() != Kind::hull)) return Warm::unknown;
    if (!(pair.size < std::numeric_limits<double>::infinity())) return Warm::unknown;
    Patch face, other;
    const bool on_box = shape.kind() == Kind::box;
    if (on_box) {
        glm::dvec3 outward(0.0);
        outward[cache.face / 2] = (cache.face & 1) != 0 ? 1.0 : -1.0;
        face.normal = turned_normal(reference.pose.rotation, outward);
        face.self = {FeatureKind::face, cache.face};
    } else {
        patch_of_face(reference, cache.face, a.pose.translation, face);
    }
    if (face.normal == glm::dvec3(0.0)) return Warm::unknown;  // a triangle without area
    const glm::dvec3 out = face.normal;
    touch.normal = on_a ? out : -out;
    double depth = 0.0;
    const Corner deepest = shape.hull() != nullptr ? support_of_hull_face(pair, on_a, cache.face, touch.normal, depth)
                                                   : pair.support(touch.normal, depth);
    const double rounding = pair.rounding(), kept = kept_share * pair.size;
    if (-depth - pair.error > rounding + margin + pair.doubt()) return Warm::apart;
    // Contacts nearer than rounding tells are decided exactly by the other way.
    if (std::abs(depth) <= 4.0 * pair.error) return Warm::unknown;
    const int facing = face_along(incident.shape, Pair::local(incident.pose.rotation, -out));
    corners_of_face(incident, facing, a.pose.translation, other);
    // The deepest corner itself above the face, else the common part of the two faces.
    const glm::dvec3 x = on_a ? deepest.on_b : deepest.on_a;
    double inner = 0.0, drop = 0.0, uneven = 0.0;
    if (on_box) {
        const glm::dmat3 to_local = glm::inverse(reference.pose.rotation);
        const BoxFace box(reference, cache.face, to_local, a.pose.translation, pair.size);
        box.clip(other, out, clipped);
        inner = box.distance_within(x);
    } else {
        Prism sides;
        find_sides(face, out, pair.size, sides);
        clip(face, sides, other, out, clipped);
        inner = distance_within(sides, x);
        uneven = unevenness(face, out);
    }
    touch.known = true;
    touch.feature_a = on_a ? face.self : Feature{FeatureKind::vertex, static_cast<std::uint16_t>(deepest.a)};
    touch.feature_b = on_a ? Feature{FeatureKind::vertex, static_cast<std::uint16_t>(deepest.b)} : face.self;
    touch.on_a = on_a ? x + depth * touch.normal : x;
    touch.on_b = on_a ? x : x - depth * touch.normal;
    if (inner < 0.0 || (depth > 0.0 && !least_deep(a, b, pair, touch.normal, {depth - uneven, depth}, inner))) {
        double least = std::numeric_limits<double>::infinity();
        for (int i = 0; i < clipped.count; ++i) {
            const ClippedPoint& p = clipped.point[i];
            const double below = depth - glm::dot(p.on_reference - p.on_incident, out);
            drop = std::max(drop, below);
            if (below < least)
                least = below, touch.on_a = on_a ? p.on_reference : p.on_incident,
                touch.on_b = on_a ? p.on_incident : p.on_reference;
        }
        if (!(least <= kept)) return Warm::unknown;
        if (depth > 0.0) {
            if (clipped.count < 3 || drop > kept) return Warm::unknown;
            const Depths depths{depth - drop - uneven, depth};
            if (!least_deep(a, b, pair, touch.normal, depths, inner_distance(clipped, out))) return Warm::unknown;
        }
        depth -= std::max(0.0, least);
    }
    touch.depth = depth + rounding;
    if (rounding > 0.0 && std::abs(touch.depth) <= pair.doubt() + pair.error) return Warm::unknown;
    // Other points than those of the face may be nearer to each other: no proof that the shapes are apart.
    return touch.depth >= -margin ? Warm::touching : Warm::unknown;
}

}  // namespace crofton::convex
