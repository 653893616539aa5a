// SPDX-License-Identifier: MIT
// Where a ray meets one convex shape, in the shape's frame. Spheres, capsules and boxes by formulas, hulls by their
// triangles, cylinders and cones by Newton's method on the distance. A rounded polytope is the union of its core, its
// faces moved outward, and capsules around its edges: each of these lies within the shape, and its surface is theirs.
#include <algorithm>
#include <cmath>
#include <crofton/geometry/expansion.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "ray.hpp"

namespace crofton::convex {
namespace {

// The nearest of several hits; of equal ones the first.
void keep_nearest(std::optional<NearHit>& best, const std::optional<NearHit>& hit) {
    if (hit && (!best || hit->t < best->t)) best = hit;
}

// a b − c d within 2 roundings of itself (Kahan).
double accurate_difference(double a, double b, double c, double d) {
    const detail::TwoTerms x = detail::two_product(a, b), y = detail::two_product(c, d);
    const detail::TwoTerms high = detail::two_sum(x.high, -y.high);
    return high.high + (high.low + (x.low - y.low));
}

glm::dvec3 accurate_cross(const glm::dvec3& u, const glm::dvec3& v) {
    return {accurate_difference(u.y, v.z, u.z, v.y), accurate_difference(u.z, v.x, u.x, v.z),
            accurate_difference(u.x, v.y, u.y, v.x)};
}

// Where the ray is in a shape from `enter` to `leave`: a hit where it enters, or at 0 where it begins within rounding
// of the surface.
std::optional<double> first_of(double enter, double leave, double max_t) {
    if (!(enter <= leave && leave >= 0.0 && enter <= max_t)) return std::nullopt;
    return std::max(enter, 0.0);
}

// The ray begins outside: where rounding puts its origin inside, it comes in if it goes against the normal, and has
// left else.
std::optional<NearHit> entering(const NearRay& ray, double t, const glm::dvec3& normal) {
    if (normal == glm::dvec3(0.0)) return NearHit{t, -ray.direction};
    if (t == 0.0 && !(glm::dot(normal, ray.direction) < 0.0)) return std::nullopt;
    return NearHit{t, normal};
}

std::optional<NearHit> meet_sphere(const NearRay& ray, const glm::dvec3& center, double radius) {
    const glm::dvec3 to = ray.origin - center;
    const double squared = glm::dot(ray.direction, ray.direction), nearest = -glm::dot(to, ray.direction) / squared;
    const glm::dvec3 off = to + nearest * ray.direction;
    const double half_chord = (radius - glm::length(off)) * (radius + glm::length(off));
    if (!(half_chord >= 0.0)) return std::nullopt;
    const double half = std::sqrt(half_chord / squared);
    const auto t = first_of(nearest - half, nearest + half, ray.max_t);
    if (!t) return std::nullopt;
    return entering(ray, *t, to + *t * ray.direction);
}

// All points within `radius` of the segment. The cylinder around its line comes first; what enters that beyond an end
// can enter the capsule through the end's sphere alone.
std::optional<NearHit> meet_capsule(const NearRay& ray, const glm::dvec3& a, const glm::dvec3& b, double radius) {
    const glm::dvec3 axis = b - a, to = ray.origin - a;
    const double squared = glm::dot(axis, axis);
    if (!(squared > 0.0)) return meet_sphere(ray, a, radius);
    const glm::dvec3 u = ray.direction - glm::dot(ray.direction, axis) / squared * axis,
                     w = to - glm::dot(to, axis) / squared * axis;
    const double across = glm::dot(u, u);
    double enter = -HUGE_VAL;
    if (across > 0.0) {
        const double nearest = -glm::dot(w, u) / across;
        const double off = glm::length(w + nearest * u);
        const double half_chord = (radius - off) * (radius + off);
        if (!(half_chord >= 0.0)) return std::nullopt;
        const double half = std::sqrt(half_chord / across);
        enter = nearest - half;
        const auto t = first_of(enter, nearest + half, HUGE_VAL);
        if (!t) return std::nullopt;
        const glm::dvec3 at = to + *t * ray.direction;
        const double along = glm::dot(at, axis) / squared;
        if (along >= 0.0 && along <= 1.0) {
            if (*t > ray.max_t) return std::nullopt;
            return entering(ray, *t, at - along * axis);
        }
        return meet_sphere(ray, along < 0.0 ? a : b, radius);
    }
    if (glm::dot(w, w) > radius * radius) return std::nullopt;
    return meet_sphere(ray, glm::dot(ray.direction, axis) > 0.0 ? a : b, radius);
}

std::optional<NearHit> meet_box(const NearRay& ray, const glm::dvec3& half) {
    double enter = -HUGE_VAL, leave = HUGE_VAL;
    glm::dvec3 normal(0.0);
    for (int k = 0; k < 3; ++k) {
        const double at = ray.origin[k], speed = ray.direction[k];
        if (speed == 0.0) {
            if (std::abs(at) > half[k]) return std::nullopt;
            continue;
        }
        const double near_side = speed > 0.0 ? -half[k] : half[k];
        const double t0 = (near_side - at) / speed, t1 = (-near_side - at) / speed;
        if (t0 > enter) {
            enter = t0;
            normal = glm::dvec3(0.0);
            normal[k] = speed > 0.0 ? -1.0 : 1.0;
        }
        leave = std::min(leave, t1);
    }
    const auto t = first_of(enter, leave, ray.max_t);
    // Farther inside than rounding puts it, the origin lies at the side where the ray leaves.
    if (!t || (enter < 0.0 && enter * glm::dot(normal, ray.direction) > ray.error)) return std::nullopt;
    return NearHit{*t, normal};
}

// The distance from a cylinder's or cone's core, negative within, and its gradient.
struct RoundGap {
    double gap;
    glm::dvec3 gradient;
};

// In the half plane of the distance from the axis and the height.
RoundGap round_gap(const Shape& shape, const glm::dvec3& p) {
    const double radius = shape.half_extents().x, height = shape.half_extents().y;
    const double from_axis = std::sqrt(p.x * p.x + p.z * p.z);
    const glm::dvec3 outward =
        from_axis > 0.0 ? glm::dvec3(p.x / from_axis, 0.0, p.z / from_axis) : glm::dvec3(1.0, 0.0, 0.0);
    const glm::dvec3 up(0.0, 1.0, 0.0);
    const auto from_point = [&](double across, double along) -> RoundGap {
        const double gap = std::sqrt(across * across + along * along);
        return {gap, gap > 0.0 ? (across / gap) * outward + (along / gap) * up : up};
    };
    if (shape.kind() == Kind::cylinder) {
        const double across = from_axis - radius, along = std::abs(p.y) - height;
        const glm::dvec3 end = p.y >= 0.0 ? up : -up;
        if (across > 0.0 && along > 0.0) return from_point(across, p.y >= 0.0 ? along : -along);
        return across > along ? RoundGap{across, outward} : RoundGap{along, end};
    }
    const double side = std::sqrt(radius * radius + 4.0 * height * height);
    if (!(side > 0.0)) return from_point(from_axis, p.y);
    const double across = from_axis - radius, along = p.y + height;
    const double from_side = (2.0 * height * across + radius * along) / side;
    const double on_side = (2.0 * height * along - radius * across) / side;
    const glm::dvec3 side_normal = (2.0 * height / side) * outward + (radius / side) * up;
    if (along < 0.0 || (from_side <= 0.0 && across <= 0.0)) {
        if (across > 0.0) return from_point(across, along);
        return -along > from_side ? RoundGap{-along, -up} : RoundGap{from_side, side_normal};
    }
    if (on_side < 0.0) return from_point(across, along);
    if (on_side > side) return from_point(from_axis, p.y - height);
    return {from_side, side_normal};
}

// Newton's method from outside: the gap is a convex function along the ray, so that each step ends before the surface
// and the first step that finds no way nearer proves a miss.
std::optional<NearHit> meet_round(const Shape& shape, const NearRay& ray) {
    double t = 0.0;
    if (!passes_box(ray, shape.bounds(), 0.0, t)) return std::nullopt;
    const double enough = 0x1p-51 * (shape.core_radius() + shape.radius());
    for (int i = 0; i < 300; ++i) {
        const RoundGap at = round_gap(shape, ray.origin + t * ray.direction);
        const double gap = at.gap - shape.radius(), speed = -glm::dot(at.gradient, ray.direction);
        if (!(speed > 0.0)) return std::nullopt;
        if (gap <= enough) return NearHit{t, at.gradient};
        const double next = t + gap / speed;
        if (!(next <= ray.max_t)) return std::nullopt;
        if (next == t) return NearHit{t, at.gradient};
        t = next;
    }
    return NearHit{t, round_gap(shape, ray.origin + t * ray.direction).gradient};
}

// The face of a rounded polytope above a triangle of its core.
std::optional<NearHit> meet_moved_face(const NearRay& ray, const Triangle& core, const glm::dvec3& normal,
                                       double radius) {
    const double length = glm::length(normal), speed = -glm::dot(normal, ray.direction);
    if (!(speed > 0.0)) return std::nullopt;
    const glm::dvec3 out = (radius / length) * normal;
    const double height = glm::dot(normal, ray.origin - core[0] - out), t = std::max(height / speed, 0.0);
    if (!(height >= -ray.error * length && t <= ray.max_t)) return std::nullopt;
    const glm::dvec3 p = ray.origin + t * ray.direction - out;
    for (std::size_t k = 0; k < 3; ++k) {
        const glm::dvec3 &from = core[k], &to = core[(k + 1) % 3];
        if (glm::dot(glm::cross(to - from, p - from), normal) < 0.0) return std::nullopt;
    }
    return NearHit{t, normal};
}

// Tells which triangles a ray may enter through, seen along it: in a plane across, where a triangle it enters through
// is clockwise around the origin.
class Silhouette {
  public:
    Silhouette(const Shape& shape, const NearRay& ray) {
        const glm::dvec3 d = glm::normalize(ray.direction), m = glm::abs(d);
        const glm::dvec3 least = m.x <= m.y && m.x <= m.z ? glm::dvec3(1, 0, 0)
                                 : m.y <= m.z             ? glm::dvec3(0, 1, 0)
                                                          : glm::dvec3(0, 0, 1);
        const glm::dvec3 right = glm::normalize(glm::cross(d, least)), up = glm::cross(d, right);
        double size = std::numeric_limits<double>::min();
        for (int i = 0; i < shape.vertex_count(); ++i) {
            const glm::dvec3 to = shape.vertex(i) - ray.origin;
            x_[i] = glm::dot(to, right);
            y_[i] = glm::dot(to, up);
            size = std::max(size, std::abs(to.x) + std::abs(to.y) + std::abs(to.z));
        }
        size_ = size;
        error_ = 0x1p-45 * size * size;
    }
    [[nodiscard]] bool may_enter(int a, int b, int c) const {
        return side(a, b) <= error_ && side(b, c) <= error_ && side(c, a) <= error_;
    }
    // Whether the ray's line may come within `radius` of the segment: not if both ends are farther away on one side.
    [[nodiscard]] bool may_pass(int a, int b, double radius) const {
        const double limit = radius * (1.0 + 0x1p-40) + error_ / size_;
        return !(std::min(x_[a], x_[b]) > limit || std::max(x_[a], x_[b]) < -limit || std::min(y_[a], y_[b]) > limit ||
                 std::max(y_[a], y_[b]) < -limit);
    }

  private:
    [[nodiscard]] double side(int a, int b) const { return x_[a] * y_[b] - y_[a] * x_[b]; }

    double x_[kMaxHullVertices], y_[kMaxHullVertices];
    double error_ = 0.0, size_ = 0.0;
};

// The ray begins a rounding earlier: where its origin has been rounded into the hull it would meet no way in.
std::optional<NearHit> meet_hull(const Shape& shape, const NearRay& ray) {
    const Hull& hull = *shape.hull();
    const Silhouette silhouette(shape, ray);
    const double back = ray.error / glm::length(ray.direction);
    NearRay earlier = ray;
    earlier.origin -= back * ray.direction;
    earlier.max_t = ray.max_t + back;
    std::optional<NearHit> best;
    const std::span<const std::uint16_t> indices = hull.triangles();
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
        const int a = indices[i], b = indices[i + 1], c = indices[i + 2];
        if (!silhouette.may_enter(a, b, c)) continue;
        keep_nearest(best, meet_triangle({shape.vertex(a), shape.vertex(b), shape.vertex(c)}, Sides::front, earlier));
    }
    if (!best) return best;
    best->t = std::min(std::max(best->t - back, 0.0), ray.max_t);
    return best;
}

std::optional<NearHit> meet_rounded_hull(const Shape& shape, const NearRay& ray) {
    std::optional<NearHit> best;
    const Silhouette silhouette(shape, ray);
    const std::span<const std::uint16_t> indices = shape.hull()->triangles();
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
        const Triangle corners{shape.vertex(indices[i]), shape.vertex(indices[i + 1]), shape.vertex(indices[i + 2])};
        keep_nearest(best, meet_moved_face(ray, corners, normal_of(corners), shape.radius()));
        for (std::size_t k = 0; k < 3; ++k)  // each edge has two triangles, which name it in both directions
            if (indices[i + k] < indices[i + (k + 1) % 3] &&
                silhouette.may_pass(indices[i + k], indices[i + (k + 1) % 3], shape.radius()))
                keep_nearest(best, meet_capsule(ray, corners[k], corners[(k + 1) % 3], shape.radius()));
    }
    return best;
}

std::optional<NearHit> meet_rounded_triangle(const Shape& shape, const NearRay& ray) {
    const Triangle corners{shape.vertex(0), shape.vertex(1), shape.vertex(2)};
    const glm::dvec3 normal = normal_of(corners);
    std::optional<NearHit> best = meet_moved_face(ray, corners, normal, shape.radius());
    const Triangle other{corners[0], corners[2], corners[1]};
    keep_nearest(best, meet_moved_face(ray, other, -normal, shape.radius()));
    for (std::size_t k = 0; k < 3; ++k)
        keep_nearest(best, meet_capsule(ray, corners[k], corners[(k + 1) % 3], shape.radius()));
    return best;
}

std::optional<NearHit> meet_rounded_box(const Shape& shape, const NearRay& ray) {
    const glm::dvec3& half = shape.half_extents();
    std::optional<NearHit> best;
    for (int k = 0; k < 3; ++k) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        glm::dvec3 grown = half;
        grown[k] += shape.radius();
        const auto hit = meet_box(ray, grown);
        if (hit && hit->normal[k] != 0.0) keep_nearest(best, hit);
        for (int corner = 0; corner < 4; ++corner) {
            glm::dvec3 from = -half;
            if ((corner & 1) != 0) from[i] = half[i];
            if ((corner & 2) != 0) from[j] = half[j];
            glm::dvec3 to = from;
            to[k] = half[k];
            keep_nearest(best, meet_capsule(ray, from, to, shape.radius()));
        }
    }
    return best;
}

}  // namespace

glm::dvec3 normal_of(const Triangle& t) {
    return accurate_cross(t[1] - t[0], t[2] - t[0]);
}

bool passes_box(const NearRay& ray, const Aabb& box, double margin, double& from) {
    double enter = 0.0, leave = ray.max_t;
    for (int k = 0; k < 3; ++k) {
        const double low = box.min[k] - margin - ray.origin[k], high = box.max[k] + margin - ray.origin[k];
        const double speed = ray.direction[k];
        if (speed == 0.0) {
            if (low > 0.0 || high < 0.0) return false;
            continue;
        }
        enter = std::max(enter, (speed > 0.0 ? low : high) / speed);
        leave = std::min(leave, (speed > 0.0 ? high : low) / speed);
    }
    from = enter;
    return enter <= leave;
}

std::optional<NearHit> meet_triangle(const Triangle& corners, Sides sides, const NearRay& ray) {
    const glm::dvec3 normal = normal_of(corners);
    const double speed = glm::dot(normal, ray.direction);
    if (sides == Sides::front && !(speed < 0.0)) return std::nullopt;
    const auto t = mesh::raycast(Ray{ray.origin, ray.direction, ray.max_t}, corners);
    if (!t) return std::nullopt;
    NearHit hit{*t, speed > 0.0 ? -normal : normal};
    // Thin triangles have their normals by cancellation: this one has kept its digits.
    if (std::abs(speed) > 1e-9 * glm::length(normal))
        hit.t = std::min(std::max(glm::dot(normal, corners[0] - ray.origin) / speed, 0.0), ray.max_t);
    if (normal == glm::dvec3(0.0)) hit.normal = -ray.direction;
    return hit;
}

bool is_in_round(const Shape& shape, const glm::dvec3& point) {
    return round_gap(shape, point).gap <= shape.radius();
}

std::optional<NearHit> meet_convex(const Shape& shape, const NearRay& ray) {
    double from = 0.0;
    if (!passes_box(ray, shape.bounds(), ray.error, from)) return std::nullopt;
    switch (shape.kind()) {
        case Kind::sphere:
            return meet_sphere(ray, glm::dvec3(0.0), shape.radius());
        case Kind::capsule:
            return meet_capsule(ray, shape.vertex(0), shape.vertex(1), shape.radius());
        case Kind::cylinder:
        case Kind::cone:
            return meet_round(shape, ray);
        case Kind::box:
            return shape.radius() > 0.0 ? meet_rounded_box(shape, ray) : meet_box(ray, shape.half_extents());
        case Kind::hull:
            return shape.radius() > 0.0 ? meet_rounded_hull(shape, ray) : meet_hull(shape, ray);
        case Kind::triangle:
            if (shape.radius() > 0.0) return meet_rounded_triangle(shape, ray);
            return meet_triangle({shape.vertex(0), shape.vertex(1), shape.vertex(2)}, Sides::both, ray);
        default:
            return std::nullopt;
    }
}

}  // namespace crofton::convex
