// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <crofton/convex/shape.hpp>
#include <crofton/convex/shape_maker.hpp>
#include <crofton/mesh/mesh_parts.hpp>
#include <glm/geometric.hpp>
#include <numbers>
#include <string>

#include "support.hpp"

namespace crofton::convex {
namespace {

constexpr double kUp = 1.0 + 0x1p-50;  // outweighs the roundings of a length

Result<void> check_length(double value, const char* name, std::uint64_t item = kNoItem) {
    if (!std::isfinite(value)) return fail(ErrorCode::non_finite, item, {"shape: ", name, " is NaN or infinite"});
    if (value < 0.0) return fail(ErrorCode::invalid_argument, item, {"shape: ", name, " is negative (inside out)"});
    if (value > static_cast<double>(kMaxExtent))
        return fail(ErrorCode::out_of_range, item, {"shape: ", name, " exceeds 1e15"});
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

void Shape::set_corners(std::span<const glm::dvec3> corners) {
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

void Shape::set_core_radius_of_bounds() {
    core_radius_ = glm::length((glm::max)(glm::abs(bounds_.min), glm::abs(bounds_.max))) * kUp;
}

Shape ShapeMaker::triangle(const Triangle& corners) {
    Shape shape;
    shape.kind_ = Kind::triangle;
    shape.set_corners(corners);
    return shape;
}

Shape ShapeMaker::sphere(double radius) {
    Shape shape;
    shape.kind_ = Kind::sphere;
    shape.radius_ = radius;
    const glm::dvec3 center(0.0);
    shape.set_corners({&center, 1});
    return shape;
}

Shape ShapeMaker::box(const glm::dvec3& half_extents) {
    Shape shape;
    shape.kind_ = Kind::box;
    shape.half_ = half_extents;
    glm::dvec3 corners[8];
    for (int i = 0; i < 8; ++i)
        for (int k = 0; k < 3; ++k) corners[i][k] = (i >> k & 1) != 0 ? shape.half_[k] : -shape.half_[k];
    shape.set_corners(corners);
    return shape;
}

Shape ShapeMaker::capsule(double half_height, double radius) {
    Shape shape;
    shape.kind_ = Kind::capsule;
    shape.radius_ = radius;
    const glm::dvec3 ends[2] = {{0.0, -half_height, 0.0}, {0.0, half_height, 0.0}};
    shape.set_corners(ends);
    return shape;
}

Shape ShapeMaker::mesh(const mesh::MeshTree& mesh, const Aabb& bounds, const glm::dmat3* map) {
    Shape shape;
    shape.kind_ = Kind::mesh;
    shape.mesh_ = &mesh;
    shape.map_ = map;
    shape.bounds_ = bounds;
    if (map != nullptr) {
        const glm::dvec3 center = bounds.center(), half = bounds.half_extents();
        glm::dvec3 size(0.0), all(0.0);
        for (int k = 0; k < 3; ++k) {
            size += half[k] * glm::abs((*map)[k]);
            all += (half[k] + std::abs(center[k])) * glm::abs((*map)[k]);
        }
        size += 1e-14 * all;
        shape.bounds_ = {*map * center - size, *map * center + size};
    }
    shape.set_core_radius_of_bounds();
    return shape;
}

Result<Shape> Shape::sphere(double radius) {
    if (Result<void> good = check_length(radius, "radius"); !good) return good.error();
    return ShapeMaker::sphere(radius);
}

Result<Shape> Shape::capsule(float half_height, float radius) {
    if (Result<void> good = check_lengths(half_height, radius); !good) return good.error();
    return ShapeMaker::capsule(static_cast<double>(half_height), static_cast<double>(radius));
}

Result<Shape> Shape::cylinder(float half_height, float radius) {
    if (Result<void> good = check_lengths(half_height, radius); !good) return good.error();
    Shape shape;
    shape.kind_ = Kind::cylinder;
    shape.half_ = {static_cast<double>(radius), static_cast<double>(half_height), static_cast<double>(radius)};
    shape.core_radius_ = std::sqrt(shape.half_.x * shape.half_.x + shape.half_.y * shape.half_.y) * kUp;
    shape.bounds_ = {-shape.half_, shape.half_};
    return shape;
}

Result<Shape> Shape::cone(float half_height, float radius) {
    Result<Shape> shape = cylinder(half_height, radius);
    if (shape) shape->kind_ = Kind::cone;
    return shape;
}

Result<Shape> Shape::box(const glm::vec3& half_extents) {
    for (int k = 0; k < 3; ++k)
        if (Result<void> good =
                check_length(static_cast<double>(half_extents[k]), "half extent", static_cast<std::uint64_t>(k));
            !good)
            return good.error();
    return ShapeMaker::box(glm::dvec3(half_extents));
}

Result<Shape> Shape::triangle(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    const glm::vec3 corners[3] = {a, b, c};
    glm::dvec3 wide[3];
    for (std::uint64_t i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k) {
            if (Result<void> good = check_length(static_cast<double>(std::abs(corners[i][k])), "triangle's corner", i);
                !good)
                return good.error();
            wide[i] = glm::dvec3(corners[i]);
        }
    return ShapeMaker::triangle({wide[0], wide[1], wide[2]});
}

Shape Shape::hull(const Hull& hull) {
    Shape shape;
    shape.kind_ = Kind::hull;
    shape.hull_ = &hull;
    shape.vertex_count_ = static_cast<int>(hull.vertices().size());
    shape.core_radius_ = hull.radius() * kUp;
    for (const glm::vec3& p : hull.vertices()) shape.bounds_.include(glm::dvec3(p));
    return shape;
}

Result<Shape> Shape::half_space(const Plane& plane) {
    for (int k = 0; k < 3; ++k)
        if (!std::isfinite(plane.normal[k]) || !std::isfinite(plane.offset))
            return fail(ErrorCode::non_finite, kNoItem, "shape: the half-space's plane is NaN or infinite");
    const glm::dvec3 m = glm::abs(plane.normal);
    const double most = std::max(m.x, std::max(m.y, m.z)), limit = static_cast<double>(kMaxExtent);
    if (most == 0.0) return fail(ErrorCode::degenerate, kNoItem, "shape: the half-space's normal is 0");
    if (!(most >= 1.0 / limit && most <= limit && std::abs(plane.offset) <= limit * most))
        return fail(ErrorCode::out_of_range, kNoItem, "shape: the half-space's plane is beyond 1e15");
    Shape shape;
    shape.kind_ = Kind::half_space;
    shape.plane_ = plane;
    shape.core_radius_ = HUGE_VAL;
    shape.bounds_ = {glm::dvec3(-HUGE_VAL), glm::dvec3(HUGE_VAL)};
    return shape;
}

Result<Shape> Shape::rounded(const Shape& core, double radius) {
    if (core.kind_ == Kind::half_space)
        return fail(ErrorCode::unsupported, kNoItem, "shape: a half-space is not rounded; move its plane");
    if (!core.is_convex())
        return fail(ErrorCode::unsupported, kNoItem, "shape: surfaces and compounds are not rounded; round the parts");
    if (Result<void> good = check_length(radius, "rounding"); !good) return good.error();
    Shape shape = core;
    shape.radius_ += radius;
    grow(shape.bounds_, radius);
    return shape;
}

Result<Shape> Shape::mesh(const mesh::MeshTree& mesh, Sides sides) {
    if (mesh.triangle_count() == 0) return fail(ErrorCode::empty, kNoItem, "shape: the mesh tree has no triangles");
    Shape shape = ShapeMaker::mesh(mesh, mesh.parts().bounds(), nullptr);
    shape.sides_ = sides;
    return shape;
}

Shape Shape::height_field(const HeightField& field, Sides sides) {
    Shape shape;
    shape.kind_ = Kind::height_field;
    shape.sides_ = sides;
    shape.field_ = &field;
    shape.bounds_ = field.bounds();
    shape.set_core_radius_of_bounds();
    return shape;
}

Shape Shape::compound(const Compound& compound) {
    Shape shape;
    shape.kind_ = Kind::compound;
    shape.compound_ = &compound;
    shape.bounds_ = compound.bounds();
    shape.set_core_radius_of_bounds();
    return shape;
}

glm::dvec3 support_point(const Shape& shape, const glm::dvec3& of_any_length) {
    const glm::dvec3 direction = without_extremes(of_any_length);
    const glm::dvec3 core = core_support(shape, direction).point;
    const double length = glm::length(direction);
    return shape.radius() > 0.0 && length > 0.0 ? core + shape.radius() / length * direction : core;
}

}  // namespace crofton::convex
