// SPDX-License-Identifier: MIT
// Rays at shapes that stand in the world.
//
// A ray that begins far away is first followed to where it comes near the shape, in twice the digits of double. There
// it goes into the shape's frame. With u = 2^-53, and `size` for how far the shape and the ray's new origin are from
// the frame's origin: the origin is rounded by u · size, the inverse of a rotation and the product with it by 20u ·
// size; the direction by 20u, on a way of at most 8 sizes. Formulas and Newton's method add 30u · size. All of it is
// below 256u · size: kError.
#include <algorithm>
#include <cmath>
#include <crofton/geometry/expansion.hpp>
#include <crofton/geometry/finite.hpp>
#include <crofton/geometry/orthonormal_frame.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <glm/matrix.hpp>

#include "core_query.hpp"
#include "parts.hpp"
#include "ray.hpp"

namespace crofton::convex {
namespace {

constexpr double kError = 0x1p-45;

// A vector whose components are sums of two doubles.
struct WideVector {
    glm::dvec3 high{0.0}, low{0.0};

    void add(const glm::dvec3& v) {
        for (int k = 0; k < 3; ++k) {
            const detail::TwoTerms sum = detail::two_sum(high[k], v[k]);
            const detail::TwoTerms kept = detail::two_sum(sum.high, sum.low + low[k]);
            high[k] = kept.high;
            low[k] = kept.low;
        }
    }
    void add_product(double factor, const glm::dvec3& v) {
        glm::dvec3 product(0.0), rest(0.0);
        for (int k = 0; k < 3; ++k) {
            const detail::TwoTerms p = detail::two_product(factor, v[k]);
            product[k] = p.high;
            rest[k] = p.low;
        }
        add(product);
        add(rest);
    }
};

// The ray with its direction's largest component in [1, 2).
struct ScaledRay {
    Ray ray;
    int exponent;  // its direction is the caller's times 2^-exponent
};

bool is_valid(const Ray& ray) {
    return is_finite(ray.origin) && is_finite(ray.direction) && ray.direction != glm::dvec3(0.0) && ray.max_t >= 0.0;
}

ScaledRay scaled(const Ray& ray) {
    const glm::dvec3 m = glm::abs(ray.direction);
    const int exponent = std::ilogb(std::max(m.x, std::max(m.y, m.z)));
    ScaledRay result{ray, exponent};
    for (int k = 0; k < 3; ++k) result.ray.direction[k] = std::scalbn(ray.direction[k], -exponent);
    result.ray.max_t = std::scalbn(ray.max_t, exponent);
    return result;
}

// A ray brought near a shape.
struct Approach {
    NearRay near;         // in the shape's frame
    double skipped[2]{};  // the parameter of its origin, as a sum
    glm::dmat3 to_shape{1.0};

    [[nodiscard]] double parameter(double t) const { return skipped[0] + (skipped[1] + t); }
};

Approach approach(const ShapeAtPose& placed, const Ray& ray) {
    const bool bounded = placed.shape.is_bounded();
    const glm::dvec3 center = bounded ? placed.pose.rotation * placed.shape.bounds().center() : glm::dvec3(0.0);
    const double radius = bounded ? glm::length(placed.shape.bounds().half_extents()) * (1.0 + 1e-5) : HUGE_VAL;
    const double squared = glm::dot(ray.direction, ray.direction), length = std::sqrt(squared);
    Approach result;
    WideVector origin;
    origin.high = ray.origin;
    origin.add(-placed.pose.translation);
    // Each step leaves at most 2^-46 of the way before it, so 24 end near the shape from wherever doubles reach.
    for (int step = 0; step < 24; ++step) {
        const glm::dvec3 to_center = (center - origin.high) - origin.low;
        const double way = glm::dot(to_center, ray.direction) / squared * (1.0 - 0x1p-48);
        if (!(way * length > 4.0 * radius) || !(way < HUGE_VAL)) break;
        const double skip = way - 2.0 * radius / length;
        origin.add_product(skip, ray.direction);
        const detail::TwoTerms sum = detail::two_sum(result.skipped[0], skip);
        result.skipped[0] = sum.high;
        result.skipped[1] += sum.low;
        result.near.moved = true;
    }
    const glm::dvec3 from = origin.high + origin.low;
    result.to_shape = glm::inverse(placed.pose.rotation);
    result.near.origin = result.to_shape * from;
    result.near.direction = result.to_shape * ray.direction;
    result.near.max_t = (ray.max_t - result.skipped[0]) - result.skipped[1];
    const double reach = bounded ? placed.shape.core_radius() : 0.0;
    result.near.error = kError * (reach + placed.shape.radius() + std::min(glm::length(from), 16.0 * radius));
    return result;
}

// The nearest part of a shape, and of a shape's parts.
class RayCaster {
  public:
    explicit RayCaster(const Ray& ray) : ray_(ray) {}

    void cast(const ShapeAtPose& placed, std::uint32_t child) {
        if (inside_ && best_ && best_->part.child <= child) return;
        const Shape& shape = placed.shape;
        if (shape.kind() == Kind::half_space) return cast_at_half_space(placed, child);
        if (shape.kind() == Kind::compound) return cast_at_compound(placed, child);
        const Approach way = approach(placed, ray_);
        if (!(way.near.max_t >= 0.0)) return;
        if (!way.near.moved && is_inside(placed, way.near)) return keep_inside(child);
        std::optional<NearHit> hit;
        if (shape.kind() == Kind::mesh)
            hit = meet_mesh(shape, way.near);
        else if (shape.kind() == Kind::height_field)
            hit = meet_field(*shape.height_field(), shape.sides(), way.near);
        else
            hit = meet_convex(shape, way.near);
        if (hit) keep(placed, way, *hit, {child, hit->triangle});
    }

    [[nodiscard]] const std::optional<RayHit>& best() const { return best_; }

  private:
    // Of a solid, where the ray's own origin is near it.
    [[nodiscard]] bool is_inside(const ShapeAtPose& placed, const NearRay& near) const {
        const Shape& shape = placed.shape;
        if (!shape.is_convex() || (shape.kind() == Kind::triangle && shape.radius() == 0.0)) return false;
        const Aabb& bounds = shape.bounds();
        for (int k = 0; k < 3; ++k)
            if (!(near.origin[k] >= bounds.min[k] - near.error && near.origin[k] <= bounds.max[k] + near.error))
                return false;
        if (shape.kind() == Kind::cylinder || shape.kind() == Kind::cone) return is_in_round(shape, near.origin);
        static const Shape kPoint = *Shape::sphere(0.0);
        const RigidTransform at{glm::dmat3(1.0), ray_.origin};
        return intersects({kPoint, at}, placed);
    }

    void keep_inside(std::uint32_t child) {
        RayHit hit;
        hit.point = ray_.origin;
        hit.started_inside = true;
        hit.part = {child, 0};
        inside_ = true;
        best_ = hit;
    }

    void keep(const ShapeAtPose& placed, const Approach& way, const NearHit& met, const PartId& part) {
        RayHit hit;
        hit.t = std::min(std::max(way.parameter(met.t), 0.0), ray_.max_t);
        hit.point = placed.pose.rotation * (way.near.origin + met.t * way.near.direction) + placed.pose.translation;
        const double size = std::max({std::abs(met.normal.x), std::abs(met.normal.y), std::abs(met.normal.z)});
        hit.normal = glm::normalize(glm::transpose(way.to_shape) * (met.normal / size));
        hit.part = part;
        keep(hit);
    }
    void keep(const RayHit& hit) {
        if (inside_ || (best_ && (hit.t > best_->t || (hit.t == best_->t && hit.part > best_->part)))) return;
        best_ = hit;
    }

    // The image of { n·x + offset ≥ 0 }: { n·inverse(R)(y − t) + offset ≥ 0 }.
    void cast_at_half_space(const ShapeAtPose& placed, std::uint32_t child) {
        static const Shape kPoint = *Shape::sphere(0.0);
        const RigidTransform at{glm::dmat3(1.0), ray_.origin};
        if (half_space_meets(placed, {kPoint, at})) return keep_inside(child);
        const Plane& plane = placed.shape.plane();
        const glm::dvec3 normal = glm::transpose(glm::inverse(placed.pose.rotation)) * plane.normal;
        const double speed = glm::dot(normal, ray_.direction);
        WideVector from;
        from.high = ray_.origin;
        from.add(-placed.pose.translation);
        detail::TwoTerms depth{plane.offset, 0.0};
        for (int k = 0; k < 3; ++k) {
            const detail::TwoTerms product = detail::two_product(normal[k], from.high[k]);
            const detail::TwoTerms sum = detail::two_sum(depth.high, product.high);
            depth.high = sum.high;
            depth.low += sum.low + product.low + normal[k] * from.low[k];
        }
        const double t = -(depth.high + depth.low) / speed;
        if (!(speed > 0.0) || !(std::max(t, 0.0) <= ray_.max_t)) return;
        RayHit hit;
        hit.t = std::max(t, 0.0);
        WideVector point;
        point.high = ray_.origin;
        point.add_product(hit.t, ray_.direction);
        hit.point = point.high + point.low;
        hit.normal = -glm::normalize(normal);
        hit.part = {child, 0};
        keep(hit);
    }

    void cast_at_compound(const ShapeAtPose& placed, std::uint32_t first) {
        const Approach way = approach(placed, ray_);
        if (!(way.near.max_t >= 0.0)) return;
        NearRay rest = way.near;
        visit_children_along(*placed.shape.compound(), rest, [&](const CompoundChild& child, std::uint32_t part) {
            const RigidTransform pose = within(placed.pose, child.pose);
            cast({child.shape, pose}, first + part);
            // What is met by then, and some roundings more, as children are asked in frames of their own.
            if (best_)
                rest.max_t = std::min(rest.max_t, (best_->t - way.skipped[0]) - way.skipped[1] + 4.0 * rest.error);
        });
    }

    const Ray& ray_;
    std::optional<RayHit> best_;
    bool inside_ = false;
};

}  // namespace

std::optional<NearHit> meet_mesh(const Shape& shape, const NearRay& ray) {
    const mesh::MeshTree& tree = *shape.mesh();
    const auto first = mesh::raycast(Ray{ray.origin, ray.direction, ray.max_t}, tree);
    if (!first) return std::nullopt;
    // Other triangles near the ray are asked where a one-sided one is met from behind, and for the vertices.
    std::optional<NearHit> best;
    const glm::dvec3 d = glm::normalize(ray.direction);
    const glm::dvec3 across = unit_across(d);
    const double length = glm::length(ray.direction);
    const auto search = [&](double from, double to, bool only_first) {
        QueryBox box;
        box.axes = glm::dmat3(d, across, glm::cross(d, across));
        box.center = ray.origin + 0.5 * (from + to) * ray.direction;
        box.half = {0.5 * (to - from) * length, 0.0, 0.0};
        box.rounding = ray.error;
        const auto triangles = [&](const PartSearch& of, const Triangle& corners, std::uint32_t triangle) {
            if (only_first && triangle != first->triangle) return false;
            auto hit = meet_triangle(corners, of.sides, ray);
            if (!hit) return false;
            hit->triangle = triangle;
            if (!best || hit->t < best->t || (hit->t == best->t && triangle < best->triangle)) best = hit;
            return false;
        };
        const RigidTransform here;
        (void)visit_parts(
            {shape, here}, box, ray.error, [](const Part&) { return false; }, triangles);
    };
    search(first->t, first->t, true);
    if (best) return best;
    double enter = 0.0;
    const Aabb& bounds = shape.bounds();
    if (!passes_box(ray, bounds, ray.error, enter)) return std::nullopt;
    const double size = glm::length(bounds.half_extents()) + glm::length(bounds.center() - ray.origin);
    search(first->t, std::min(ray.max_t, 2.0 * size / length), false);
    return best;
}

std::optional<RayHit> raycast(const ShapeAtPose& shape, const Ray& ray) {
    if (!is_valid(ray) || !validate_pose(shape.pose)) return std::nullopt;
    const ScaledRay along = scaled(ray);
    RayCaster caster(along.ray);
    caster.cast(shape, 0);
    std::optional<RayHit> hit = caster.best();
    if (hit) hit->t = std::min(std::scalbn(hit->t, -along.exponent), ray.max_t) + 0.0;  // never −0
    return hit;
}

}  // namespace crofton::convex
