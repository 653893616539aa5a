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

// The least distance of a point, given from the shape's origin, to the sides of the prism over a face of a hull or box;
// negative outside. It is measured in the shape's frame. As poses are rigid to 1e-6, the turned point and the lengths
// are off by 2e-6 of `size` each, and the prism is tilted by as much.
double least_distance_to_sides(const ShapeAtPose& placed, int face, const glm::dvec3& point, double size) {
    const Shape& shape = placed.shape;
    const glm::dvec3 q = Pair::local(placed.pose.rotation, point);
    const double off = 1e-5 * size;
    if (shape.kind() == Kind::box) {
        const glm::dvec3 within = shape.half_extents() - glm::abs(q);
        const int k = face / 2;
        return std::min(within[k == 2 ? 0 : k + 1], within[k == 0 ? 2 : k - 1]) - off;
    }
    const Hull& hull = *shape.hull();
    const glm::dvec3& normal = hull.face_normal(face);
    const auto loop = hull.face_vertices(face);
    glm::dvec3 from(hull.vertices()[loop.back()]);
    double least = std::numeric_limits<double>::infinity();  // squared, with its sign
    for (const std::uint16_t vertex : loop) {
        const glm::dvec3 to(hull.vertices()[vertex]), outward = glm::cross(to - from, normal);
        const double along = glm::dot(outward, to - q);
        least = std::min(least, along * std::abs(along) / glm::dot(outward, outward));
        from = to;
    }
    return (least < 0.0 ? -std::sqrt(-least) : std::sqrt(least)) - off;
}

// Whether the part of a hull that is within `reach` of its farthest vertex along `d`, a unit vector of its frame, stays
// less than `room` beside that vertex, and has no other vertex. All of the hull is in the cone of the edges at the
// vertex, and of an edge of length l that drops by h along d, the part within reach is l · reach / h long. `error` is
// what rounding adds to a drop; poses are rigid to 1e-6.
bool is_lone_vertex(const Hull& hull, int vertex, const glm::dvec3& d, double reach, double room, double error) {
    const double* const x = hull.column(0);
    const double* const y = hull.column(1);
    const double* const z = hull.column(2);
    const double along = (x[vertex] * d.x + y[vertex] * d.y) + z[vertex] * d.z - error;
    room *= 0.999;
    for (const Hull::Spoke& spoke : hull.spokes(vertex)) {
        const double drop = along - ((x[spoke.to] * d.x + y[spoke.to] * d.y) + z[spoke.to] * d.z);
        if (!(drop > reach) || !(reach * static_cast<double>(spoke.length) < drop * room)) return false;
    }
    return true;
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

// The shapes of a pair as a face of one of them sees them: unit `out` is its normal, and `deepest` the other shape's
// farthest vertex against it.
struct FaceView {
    const ShapeAtPose &reference, &incident;
    bool reference_is_a;
    glm::dvec3 out;
    glm::dvec3 inward{0.0};  // −out in the frame of the incident shape
    Support deepest{};
    double depth = 0.0;  // of the difference body along `out`
};

// That of a hull's face is as Pair::support() along its normal: the face's own farthest vertex is known. That the
// normal is rounded, and so is what told the vertex, makes `depth` off by 28 u of the size at most, below `error`.
void find_deepest(const Pair& pair, int face, FaceView& view) {
    const ShapeAtPose& reference = view.reference;
    view.inward = Pair::local(view.incident.pose.rotation, -view.out);
    view.deepest = core_support(view.incident.shape, view.inward);
    double level = 0.0;
    if (const Hull* hull = reference.shape.hull(); hull != nullptr)
        level = glm::dot(view.out, reference.pose.rotation * reference.shape.vertex(hull->face_support(face)));
    else
        level = core_support(reference.shape, Pair::local(reference.pose.rotation, view.out)).along;
    const double between = glm::dot(view.out, pair.offset);
    view.depth = level + (view.deepest.along + (view.reference_is_a ? -between : between));
}

bool is_face(const Shape& shape, int face) {
    if (shape.kind() == Kind::box) return face < 6;
    if (shape.kind() == Kind::hull) return face < shape.hull()->face_count() && !shape.hull()->is_narrow_face(face);
    return shape.kind() == Kind::triangle && face == 0;
}

// 0 of a triangle without area.
glm::dvec3 normal_of_face(const ShapeAtPose& placed, int face, const glm::dvec3& origin, Patch& patch) {
    if (placed.shape.kind() == Kind::hull)
        return turned_normal(placed.pose.rotation, placed.shape.hull()->face_normal(face));
    if (placed.shape.kind() == Kind::box) {
        glm::dvec3 outward(0.0);
        outward[face / 2] = (face & 1) != 0 ? 1.0 : -1.0;
        return turned_normal(placed.pose.rotation, outward);
    }
    patch_of_face(placed, face, origin, patch);
    return patch.normal;
}

// The touch at the deepest vertex and its shadow on the face.
void set_at_vertex(const FaceView& view, int face, const glm::dvec3& vertex, Touch& touch) {
    const Feature at_face{FeatureKind::face, static_cast<std::uint16_t>(face)},
        at_vertex{FeatureKind::vertex, static_cast<std::uint16_t>(view.deepest.vertex)};
    const glm::dvec3 shadow = vertex + view.depth * view.out;
    touch.known = true;
    touch.feature_a = view.reference_is_a ? at_face : at_vertex;
    touch.feature_b = view.reference_is_a ? at_vertex : at_face;
    touch.on_a = view.reference_is_a ? shadow : vertex;
    touch.on_b = view.reference_is_a ? vertex : shadow;
}

}  // namespace

Warm touch_at_face(const ShapeAtPose& a, const ShapeAtPose& b, const Pair& pair, double margin, const PairCache& cache,
                   double kept_share, Touch& touch, Clipped& clipped) {
    const bool on_a = cache.reference == 1;
    FaceView view{on_a ? a : b, on_a ? b : a, on_a, {}};
    const ShapeAtPose &reference = view.reference, &incident = view.incident;
    const Shape& shape = reference.shape;
    if (!is_face(shape, cache.face)) return Warm::unknown;
    if (incident.shape.kind() != Kind::box && incident.shape.kind() != Kind::hull) return Warm::unknown;
    if (!(pair.size < std::numeric_limits<double>::infinity())) return Warm::unknown;
    Patch face, other;
    const glm::dvec3 out = view.out = normal_of_face(reference, cache.face, a.pose.translation, face);
    if (out == glm::dvec3(0.0)) return Warm::unknown;
    touch.normal = on_a ? out : -out;
    find_deepest(pair, cache.face, view);
    double depth = view.depth;
    const double rounding = pair.rounding(), kept = kept_share * pair.size;
    if (-depth - pair.error > rounding + margin + pair.doubt()) return Warm::apart;
    // Contacts nearer than rounding tells are decided exactly by the other way.
    if (std::abs(depth) <= 4.0 * pair.error) return Warm::unknown;
    const glm::dvec3 around = incident.pose.rotation * view.deepest.point,
                     x = on_a ? around + pair.offset : around;  // from a's origin
    set_at_vertex(view, cache.face, x, touch);
    clipped.count = 0;
    const Hull* const hull = shape.hull();
    const auto is_least = [&](double drop, double inner) {
        const double uneven = hull != nullptr             ? 1.00001 * hull->face_unevenness(cache.face) + pair.error
                              : shape.kind() == Kind::box ? 0.0
                                                          : unevenness(face, out);
        return !(depth > 0.0) || least_deep(a, b, pair, touch.normal, {depth - drop - uneven, depth}, inner);
    };
    const auto settled = [&] {
        touch.depth = depth + rounding;
        if (rounding > 0.0 && std::abs(touch.depth) <= pair.doubt() + pair.error) return Warm::unknown;
        // Other points than those of the face may be nearer to each other: no proof that the shapes are apart.
        return touch.depth >= -margin ? Warm::touching : Warm::unknown;
    };
    if (incident.shape.hull() != nullptr && shape.kind() != Kind::triangle) {
        const double reach = std::max(0.0, rounding + margin + depth + pair.error),
                     room = least_distance_to_sides(reference, cache.face, on_a ? x : x - pair.offset, pair.size);
        const bool at_vertex = room > 0.0 && is_least(0.0, room);
        const int vertex = view.deepest.vertex;
        if (at_vertex && is_lone_vertex(*incident.shape.hull(), vertex, view.inward, reach, room, pair.error))
            return settled();
        corners_of_face(incident, face_along(incident.shape, view.inward), a.pose.translation, other);
        if (at_vertex && hull != nullptr) {
            ClipPolygon part;
            find_low_part(other, out, glm::dot(out, x) + depth, rounding + margin + 2.0 * pair.error, part);
            Prism sides;
            if (is_around(part, x, out, room)) {
                face.self = {FeatureKind::face, cache.face};
                face.point[0] = reference.pose.rotation * shape.vertex(hull->face_vertices(cache.face)[0]) +
                                (reference.pose.translation - a.pose.translation);
            } else {
                corners_of_face(reference, cache.face, a.pose.translation, face);
                find_sides(face, out, pair.size, sides);
            }
            face.normal = out;
            clip(face, sides, other, part, out, clipped);
            return settled();
        }
    } else {
        corners_of_face(incident, face_along(incident.shape, view.inward), a.pose.translation, other);
    }
    // The deepest corner itself above the face, else the common part of the two faces.
    double inner = 0.0, drop = 0.0;
    if (shape.kind() == Kind::box) {
        const glm::dmat3 to_local = glm::inverse(reference.pose.rotation);
        const BoxFace box(reference, cache.face, to_local, a.pose.translation, pair.size);
        box.clip(other, out, clipped);
        inner = box.distance_within(x);
    } else {
        if (hull != nullptr) corners_of_face(reference, cache.face, a.pose.translation, face);
        face.normal = out;
        Prism sides;
        find_sides(face, out, pair.size, sides);
        clip(face, sides, other, out, clipped);
        inner = distance_within(sides, x);
    }
    if (inner < 0.0 || !is_least(0.0, inner)) {
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
        if (depth > 0.0 && (clipped.count < 3 || drop > kept || !is_least(drop, inner_distance(clipped, out))))
            return Warm::unknown;
        depth -= std::max(0.0, least);
    }
    return settled();
}

}  // namespace crofton::convex
