// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <crofton/convex/body.hpp>
#include <crofton/convex/body_maker.hpp>
#include <crofton/mesh/mesh_parts.hpp>
#include <glm/geometric.hpp>
#include <numbers>
#include <string>

#include "support.hpp"

namespace crofton::convex {
namespace {

constexpr double kUp = 1.0 + 0x1p-50;  // outweighs the roundings of a length

Result<void> check_length(double value, const char* name, std::uint64_t item = kNoItem) {
    if (!std::isfinite(value)) return fail(ErrorCode::non_finite, item, {"body: ", name, " is NaN or infinite"});
    if (value < 0.0) return fail(ErrorCode::invalid_argument, item, {"body: ", name, " is negative (inside out)"});
    if (value > static_cast<double>(kMaxExtent))
        return fail(ErrorCode::out_of_range, item, {"body: ", name, " exceeds 1e15"});
    return {};
}

Result<void> check_lengths(float half_height, float radius) {
    if (Result<void> good = check_length(static_cast<double>(half_height), "half height"); !good) return good;
    return check_length(static_cast<double>(radius), "radius");
}

// The direction times a power of two where squares of its components would leave the range of doubles; else as it is.
glm::dvec3 without_extremes(const glm::dvec3& direction) {
    const double largest = std::max({std::fabs(direction.x), std::fabs(direction.y), std::fabs(direction.z)});
    if (largest == 0.0 || (largest >= 0x1p-400 && largest <= 0x1p400)) return direction;
    const int down = -std::ilogb(largest);
    return {std::scalbn(direction.x, down), std::scalbn(direction.y, down), std::scalbn(direction.z, down)};
}

void grow(Aabb& box, double radius) {
    box.min -= radius * kUp;
    box.max += radius * kUp;
}

}  // namespace

void Body::set_corners(std::span<const glm::dvec3> corners) {
    vertex_count_ = static_cast<int>(corners.size());
    padded_ = vertex_count_ <= 4 ? 4 : 8;
    for (std::size_t i = 0; i < 8; ++i)
        for (int k = 0; k < 3; ++k) corners_[k][i] = corners[std::min(i, corners.size() - 1)][k];
    for (const glm::dvec3& p : corners) {
        core_radius_ = std::max(core_radius_, glm::length(p) * kUp);
        bounds_.include(p);
    }
    grow(bounds_, radius_);
}

void Body::set_core_radius_of_bounds() {
    core_radius_ = glm::length((glm::max)(glm::abs(bounds_.min), glm::abs(bounds_.max))) * kUp;
}

Body BodyMaker::triangle(const Triangle& corners) {
    Body body;
    body.kind_ = Kind::triangle;
    body.set_corners(corners);
    return body;
}

Body BodyMaker::sphere(double radius) {
    Body body;
    body.kind_ = Kind::sphere;
    body.radius_ = radius;
    const glm::dvec3 center(0.0);
    body.set_corners({&center, 1});
    return body;
}

Body BodyMaker::box(const glm::dvec3& half_extents) {
    Body body;
    body.kind_ = Kind::box;
    body.half_ = half_extents;
    glm::dvec3 corners[8];
    for (int i = 0; i < 8; ++i)
        for (int k = 0; k < 3; ++k) corners[i][k] = (i >> k & 1) != 0 ? body.half_[k] : -body.half_[k];
    body.set_corners(corners);
    return body;
}

Body BodyMaker::capsule(double half_height, double radius) {
    Body body;
    body.kind_ = Kind::capsule;
    body.radius_ = radius;
    const glm::dvec3 ends[2] = {{0.0, -half_height, 0.0}, {0.0, half_height, 0.0}};
    body.set_corners(ends);
    return body;
}

Body BodyMaker::mesh(const mesh::MeshTree& mesh, const Aabb& bounds, const glm::dmat3* map) {
    Body body;
    body.kind_ = Kind::mesh;
    body.mesh_ = &mesh;
    body.map_ = map;
    body.bounds_ = bounds;
    if (map != nullptr) {
        const glm::dvec3 center = bounds.center(), half = bounds.half_extents();
        glm::dvec3 size(0.0), all(0.0);
        for (int k = 0; k < 3; ++k) {
            size += half[k] * glm::abs((*map)[k]);
            all += (half[k] + std::abs(center[k])) * glm::abs((*map)[k]);
        }
        size += 1e-14 * all;
        body.bounds_ = {*map * center - size, *map * center + size};
    }
    body.set_core_radius_of_bounds();
    return body;
}

Result<Body> Body::sphere(double radius) {
    if (Result<void> good = check_length(radius, "radius"); !good) return tl::unexpected(good.error());
    return BodyMaker::sphere(radius);
}

Result<Body> Body::capsule(float half_height, float radius) {
    if (Result<void> good = check_lengths(half_height, radius); !good) return tl::unexpected(good.error());
    return BodyMaker::capsule(static_cast<double>(half_height), static_cast<double>(radius));
}

Result<Body> Body::cylinder(float half_height, float radius) {
    if (Result<void> good = check_lengths(half_height, radius); !good) return tl::unexpected(good.error());
    Body body;
    body.kind_ = Kind::cylinder;
    body.half_ = {static_cast<double>(radius), static_cast<double>(half_height), static_cast<double>(radius)};
    body.core_radius_ = std::sqrt(body.half_.x * body.half_.x + body.half_.y * body.half_.y) * kUp;
    body.bounds_ = {-body.half_, body.half_};
    return body;
}

Result<Body> Body::cone(float half_height, float radius) {
    Result<Body> body = cylinder(half_height, radius);
    if (body) body->kind_ = Kind::cone;
    return body;
}

Result<Body> Body::box(const glm::vec3& half_extents) {
    for (int k = 0; k < 3; ++k)
        if (Result<void> good =
                check_length(static_cast<double>(half_extents[k]), "half extent", static_cast<std::uint64_t>(k));
            !good)
            return tl::unexpected(good.error());
    return BodyMaker::box(glm::dvec3(half_extents));
}

Result<Body> Body::triangle(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    const glm::vec3 corners[3] = {a, b, c};
    glm::dvec3 wide[3];
    for (std::uint64_t i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k) {
            if (Result<void> good = check_length(static_cast<double>(std::abs(corners[i][k])), "triangle's corner", i);
                !good)
                return tl::unexpected(good.error());
            wide[i] = glm::dvec3(corners[i]);
        }
    return BodyMaker::triangle({wide[0], wide[1], wide[2]});
}

Body Body::hull(const Hull& hull) {
    Body body;
    body.kind_ = Kind::hull;
    body.hull_ = &hull;
    body.vertex_count_ = static_cast<int>(hull.vertices().size());
    body.core_radius_ = hull.radius() * kUp;
    for (const glm::vec3& p : hull.vertices()) body.bounds_.include(glm::dvec3(p));
    return body;
}

Result<Body> Body::half_space(const Plane& plane) {
    for (int k = 0; k < 3; ++k)
        if (!std::isfinite(plane.normal[k]) || !std::isfinite(plane.offset))
            return fail(ErrorCode::non_finite, kNoItem, "body: the half-space's plane is NaN or infinite");
    const glm::dvec3 m = glm::abs(plane.normal);
    const double most = std::max(m.x, std::max(m.y, m.z)), limit = static_cast<double>(kMaxExtent);
    if (most == 0.0) return fail(ErrorCode::degenerate, kNoItem, "body: the half-space's normal is 0");
    if (!(most >= 1.0 / limit && most <= limit && std::abs(plane.offset) <= limit * most))
        return fail(ErrorCode::out_of_range, kNoItem, "body: the half-space's plane is beyond 1e15");
    Body body;
    body.kind_ = Kind::half_space;
    body.plane_ = plane;
    body.core_radius_ = HUGE_VAL;
    body.bounds_ = {glm::dvec3(-HUGE_VAL), glm::dvec3(HUGE_VAL)};
    return body;
}

Result<Body> Body::rounded(const Body& core, double radius) {
    if (core.kind_ == Kind::half_space)
        return fail(ErrorCode::unsupported, kNoItem, "body: a half-space is not rounded; move its plane");
    if (!core.is_convex())
        return fail(ErrorCode::unsupported, kNoItem, "body: surfaces and compounds are not rounded; round the parts");
    if (Result<void> good = check_length(radius, "rounding"); !good) return tl::unexpected(good.error());
    Body body = core;
    body.radius_ += radius;
    grow(body.bounds_, radius);
    return body;
}

Result<Body> Body::mesh(const mesh::MeshTree& mesh, Sides sides) {
    if (mesh.triangle_count() == 0) return fail(ErrorCode::empty, kNoItem, "body: the mesh tree has no triangles");
    Body body = BodyMaker::mesh(mesh, mesh.parts().bounds(), nullptr);
    body.sides_ = sides;
    return body;
}

Body Body::height_field(const HeightField& field, Sides sides) {
    Body body;
    body.kind_ = Kind::height_field;
    body.sides_ = sides;
    body.field_ = &field;
    body.bounds_ = field.bounds();
    body.set_core_radius_of_bounds();
    return body;
}

Body Body::compound(const Compound& compound) {
    Body body;
    body.kind_ = Kind::compound;
    body.compound_ = &compound;
    body.bounds_ = compound.bounds();
    body.set_core_radius_of_bounds();
    return body;
}

glm::dvec3 support_point(const Body& body, const glm::dvec3& of_any_length) {
    const glm::dvec3 direction = without_extremes(of_any_length);
    const glm::dvec3 core = core_support(body, direction).point;
    const double length = glm::length(direction);
    return body.radius() > 0.0 && length > 0.0 ? core + body.radius() / length * direction : core;
}

}  // namespace crofton::convex
