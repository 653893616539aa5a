// SPDX-License-Identifier: MIT
#include "query_shape.hpp"

#include <cmath>
#include <crofton/convex/distance_within.hpp>
#include <crofton/convex/shape_maker.hpp>
#include <crofton/geometry/orthonormal_frame.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>

#include "rigid.hpp"
#include "world_state.hpp"

namespace crofton {
namespace world {

QueryShape shape_of(const Obb& box) {
    RigidTransform pose{glm::dmat3(box.axes), box.center};
    glm::dmat3& axes = pose.rotation;
    if (glm::determinant(axes) < 0.0) axes[2] = -axes[2];  // the same box
    if (convex::validate_pose(pose)) return {convex::ShapeMaker::box(glm::dvec3(box.half_extents)), pose};
    axes[0] = glm::normalize(axes[0]);
    axes[1] = glm::normalize(axes[1] - glm::dot(axes[0], axes[1]) * axes[0]);
    axes[2] = glm::cross(axes[0], axes[1]);
    glm::dvec3 half(0.0);
    for (int k = 0; k < 3; ++k)
        for (int j = 0; j < 3; ++j)
            half[k] += static_cast<double>(box.half_extents[j]) * std::abs(glm::dot(axes[k], glm::dvec3(box.axes[j])));
    return {convex::ShapeMaker::box(half * (1.0 + 0x1p-22)), pose};
}

QueryShape shape_of(const Sphere& sphere) {
    return {convex::ShapeMaker::sphere(sphere.radius), RigidTransform{glm::dmat3(1.0), sphere.center}};
}

QueryShape shape_of(const collide::Capsule& capsule) {
    const glm::dvec3 way = capsule.end - capsule.begin;
    const double length = glm::length(way);
    if (!(length > 0.0)) return shape_of(Sphere{capsule.begin, capsule.radius});
    const glm::dvec3 y = way / length, x = unit_across(y);
    return {convex::ShapeMaker::capsule(0.5 * length, capsule.radius),
            RigidTransform{glm::dmat3(x, y, glm::cross(x, y)), capsule.begin + 0.5 * way}};
}

std::uint32_t triangle_of(const convex::Shape& shape, const convex::PartId& part) {
    const convex::Shape& of = shape.compound() != nullptr ? shape.compound()->part(part.child).shape : shape;
    return of.is_convex() ? kNoTriangle : part.triangle;
}

namespace {

// Returns an object's sphere or box.
QueryShape shape_of_bound(const Object& object, const Obb& box) {
    return object.kind == BoundKind::sphere ? shape_of(sphere_of(object, box)) : shape_of(box);
}

using PointVisitor = FunctionRef<bool(const glm::dvec3& point)>;

// Calls `visit` with a point of each connected part of a shape, until it returns true. Of a height field it takes one
// point: islands between holes are not told apart.
bool visit_parts(const convex::Shape& shape, const RigidTransform& pose, PointVisitor visit) {
    switch (shape.kind()) {
        case convex::Kind::half_space:
            return false;
        case convex::Kind::mesh:
            for (const mesh::MeshPiece& piece : shape.mesh()->pieces())
                if (visit(transform(pose, glm::dvec3(piece.vertex)))) return true;
            return false;
        case convex::Kind::height_field: {
            const convex::HeightField& field = *shape.height_field();
            std::uint32_t cell = 0;
            while (field.material(cell) == convex::kHole) ++cell;
            return visit(transform(pose, field.triangle(2 * cell)[0]));
        }
        case convex::Kind::compound:
            for (const convex::CompoundChild& child : shape.compound()->children())
                if (visit_parts(child.shape,
                                {pose.rotation * child.pose.rotation, transform(pose, child.pose.translation)}, visit))
                    return true;
            return false;
        default:
            return visit(shape.vertex_count() > 0 ? transform(pose, shape.vertex(0)) : pose.translation);
    }
}

}  // namespace
}  // namespace world

world::QueryShape World::State::query_shape_of(std::uint32_t id) const {
    const bool of_region = world::is_region_index(id);
    if (of_region && regions.has_shape(id)) return {regions.shape(id), regions.pose(id)};
    if (!of_region && object_shapes.has(id))
        return {object_shapes.shape(id), object_shapes.pose_of(id, table.objects[id], index.box(id), scene)};
    if (const world::PlacedMesh placed = mesh_of_object(id); placed.mesh != nullptr) {
        if (world::is_clearly_rotation(*placed.linear))
            return {placed.mesh->shape(nullptr), RigidTransform{*placed.linear, placed.translation}};
        return {placed.mesh->shape(placed.linear), RigidTransform{glm::dmat3(1.0), placed.translation}};
    }
    return of_region ? world::shape_of_bound(regions.object(id), regions.box(id))
                     : world::shape_of_bound(table.objects[id], index.box(id));
}

std::optional<glm::dvec3> World::State::point_inside(const convex::ShapeAtPose& probe, std::uint32_t id) const {
    if (!options.containment || has_own_shape(id)) return std::nullopt;
    const world::PlacedMesh placed = mesh_of_object(id);
    if (placed.mesh == nullptr || !world::is_invertible(*placed.linear)) return std::nullopt;
    const glm::dmat3 inverse = glm::inverse(*placed.linear);
    std::optional<glm::dvec3> inside;
    (void)world::visit_parts(probe.shape, probe.pose, [&](const glm::dvec3& at) {
        if (mesh::contains(placed.mesh->tree, inverse * (at - placed.translation))) inside = at;
        return inside.has_value();
    });
    return inside;
}

void World::State::touch_shape(const IdPair& pair, world::ShapeTouch& touch) const {
    touch.deepest = nullptr;
    touch.inside = mesh::Containment::none;
    const world::QueryShape a = query_shape_of(pair.first), b = query_shape_of(pair.second);
    if (!a.pose || !b.pose) return;
    convex::contact_manifolds(a.placed(), b.placed(), {}, touch.found);
    for (const convex::Manifold& manifold : touch.found.all())
        if (touch.deepest == nullptr || manifold.depth > touch.deepest->depth) touch.deepest = &manifold;
    if (touch.deepest != nullptr) return;
    const bool shape_first = has_own_shape(pair.first);
    if (point_inside(shape_first ? a.placed() : b.placed(), shape_first ? pair.second : pair.first))
        touch.inside = shape_first ? mesh::Containment::a_inside_b : mesh::Containment::b_inside_a;
}

bool World::State::overlaps(const convex::ShapeAtPose& probe, std::uint32_t id) const {
    const world::QueryShape object = query_shape_of(id);
    return object.pose && (convex::intersects(probe, object.placed()) || point_inside(probe, id));
}

world::Gap World::State::gap_to_shape(const convex::ShapeAtPose& probe, std::uint32_t id, double limit) const {
    const world::QueryShape object = query_shape_of(id);
    if (!object.pose) return {{std::numeric_limits<double>::infinity(), {}, {}}};
    if (const auto inside = point_inside(probe, id)) return {{0.0, *inside, *inside}};
    const convex::Distance gap = convex::distance_within(probe, object.placed(), limit);
    return {{gap.distance, gap.on_a, gap.on_b}, world::triangle_of(object.shape, gap.part_b), gap.part_b.child};
}

}  // namespace crofton
