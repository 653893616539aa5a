// SPDX-License-Identifier: MIT
#include "surface_manifold.hpp"

#include <algorithm>
#include <cmath>
#include <crofton/convex/shape_maker.hpp>

#include "core_query.hpp"
#include "parallel_edges.hpp"
#include "part_cast.hpp"
#include "part_manifold.hpp"
#include "support.hpp"

namespace crofton::convex {
namespace {

void triangle_patch(const PlacedTriangle& t, const glm::dvec3& direction, Patch& patch) {
    const bool behind = glm::dot(t.normal, direction) < 0.0;
    patch.count = 3;
    patch.normal = behind ? -t.normal : t.normal;
    patch.self = {FeatureKind::face, 0};
    constexpr std::uint16_t kVertex[2][3] = {{0, 1, 2}, {0, 2, 1}}, kEdge[2][3] = {{0, 1, 2}, {2, 1, 0}};
    for (int k = 0; k < 3; ++k) {
        patch.vertex[k] = kVertex[behind ? 1 : 0][k];
        patch.edge[k] = kEdge[behind ? 1 : 0][k];
        patch.point[k] = t.corner[patch.vertex[k]];
    }
    if (is_narrow(patch.point, patch.count)) patch.normal = glm::dvec3(0.0);
}

double deepest(const GatheredPoints& points) {
    double depth = -HUGE_VAL;
    for (int i = 0; i < points.count; ++i) depth = std::max(depth, points.point[i].depth);
    return depth;
}

}  // namespace

SurfaceContacts::SurfaceContacts(const NearSurface& surface, const ShapeAtPose& shape, double margin)
    : surface_(surface), shape_(shape), gathering_{surface.pose.translation, 0.0, shape.shape.radius(), margin, 0.0} {
    const glm::dvec3& origin = surface.pose.translation;
    size_ = surface.shape->core_radius() + shape.shape.core_radius() + glm::length(shape.pose.translation - origin);
    gathering_.size = size_;
    middle_ = middle_of(shape, origin);
    if (shape.shape.kind() == Kind::box) box_.emplace(shape, origin, surface.shape->core_radius(), margin);
    const bool round = shape.shape.kind() == Kind::sphere || shape.shape.kind() == Kind::capsule;
    if (round) segment_.emplace(shape, origin, surface.shape->core_radius(), margin);
}

void SurfaceContacts::ask(const NearTriangle& near, std::uint32_t index, EdgeRule& rule, Push push,
                          Contact& contact) const {
    find_points(near, index, rule, push, contact);
    move_to_surface({*surface_.shape, surface_.pose}, shape_, contact.normal, contact.depth,
                    {contact.points.point, static_cast<std::size_t>(contact.points.count)});
}

void SurfaceContacts::find_points(const NearTriangle& near, std::uint32_t index, EdgeRule& rule, Push push,
                                  Contact& contact) const {
    contact.points.count = 0;
    contact.left_out = false;
    PlacedTriangle t = placed_corners(near.corners, surface_.pose, surface_.pose.translation);
    Touch touch;
    Warm warm = box_ ? box_->ask(t, touch) : Warm::unknown;
    if (warm == Warm::apart) return;
    t.normal = triangle_normal(surface_.pose.rotation, near.corners);
    if (segment_) warm = segment_->ask(t, touch);
    if (warm == Warm::apart) return;
    std::optional<Shape> triangle;
    Found found = Found::touch;
    if (warm == Warm::unknown) {
        triangle = ShapeMaker::triangle(near.corners);
        touch = {};
        found = is_half_space(shape_) ? find_on_half_space(*triangle, contact) : find(t, *triangle, touch, contact);
        if (found == Found::nothing) return;
    }
    const glm::dvec3 normal = found == Found::points ? contact.normal : touch.normal;
    const double along = glm::dot(normal, t.normal);
    // 1: pushes to the front alone, -1: to the back alone.
    const int only = surface_.shape->sides() == Sides::front ? 1 : push == Push::to_one_side ? rule.side(index) : 0;
    const bool in_front = is_in_front(t, shape_.shape, middle_);
    const bool allowed = only == 0 || only * along > 0.0;
    if (!allowed && in_front != (only > 0)) {
        contact.points.count = 0;
        return;
    }
    const bool across_face = std::abs(along) >= 1.0 - 0.5 * kFlatSine * kFlatSine;
    const bool has_face = t.normal != glm::dvec3(0.0);
    if (allowed && (across_face || (push == Push::always && (!has_face || is_half_space(shape_))) ||
                    !rule.points_into_neighbor(index, surface_, normal, touch.on_a))) {
        if (found == Found::touch) gather(t, triangle ? &*triangle : nullptr, touch, contact);
        return;
    }
    const bool meets = found == Found::points ? deepest(contact.points) >= 0.0 : touch.depth >= 0.0;
    contact.points.count = 0;
    // A sphere that touches an edge or a corner, along another direction than the face's, is not above the face.
    const bool is_beside = shape_.shape.kind() == Kind::sphere && warm == Warm::touching && !across_face &&
                           touch.feature_a.kind != FeatureKind::face;
    // A half-space pushes along its own normal alone: the triangles of the deepest corners have its points.
    if (has_face && !is_half_space(shape_) && !(is_beside && push != Push::always)) {
        const bool front = only == 0 ? in_front : only > 0;
        gather_along_face(t, front, contact);
        const bool none = contact.points.count == 0;
        if (none && meets && push == Push::always) add_deepest_above(near, t, front, contact);
    }
    contact.left_out = allowed && meets && contact.points.count == 0;
}

// The triangle's face is tried first: its points are clipped for that already.
SurfaceContacts::Found SurfaceContacts::find(const PlacedTriangle& t, const Shape& triangle, Touch& touch,
                                             Contact& contact) const {
    const ShapeAtPose placed{triangle, surface_.pose};
    const Pair pair(placed, shape_);
    PairCache face;
    face.reference = 1;
    Clipped clipped;
    const Warm warm = touch_at_face(placed, shape_, pair, gathering_.margin, face, kSameDepth, touch, clipped);
    if (warm == Warm::apart) return Found::nothing;
    if (warm == Warm::unknown) {
        touch = {};
        return find_touch(pair, gathering_.margin, nullptr, touch) ? Found::touch : Found::nothing;
    }
    Gatherer gatherer(gathering_, touch, contact.points);
    gatherer.add(clipped, true);
    if (gatherer.lacks_deepest(1e-9 * size_)) gatherer.add_deepest();
    contact.normal = touch.normal;
    contact.depth = touch.depth;
    return glm::dot(touch.normal, t.normal) > 0.0 ? Found::points : Found::touch;
}

SurfaceContacts::Found SurfaceContacts::find_on_half_space(const Shape& triangle, Contact& contact) const {
    const ManifoldOptions options{.margin = gathering_.margin, .max_points = 8};
    const Manifold m = contact_manifold({triangle, surface_.pose}, shape_, options, nullptr);
    contact.normal = m.normal;
    contact.depth = -HUGE_VAL;  // the points are on the surfaces
    contact.points.count = m.count;
    for (int i = 0; i < m.count; ++i) {
        const ContactPoint& p = m.points[i];
        contact.points.point[i] = {p.position, p.depth, p.on_a, p.on_b, {}, {}};
    }
    return m.count > 0 ? Found::points : Found::nothing;
}

void SurfaceContacts::gather_patches_along(const PlacedTriangle& t, Gatherer& gatherer, const glm::dvec3& normal,
                                           Patch& on_triangle, Patch& on_shape) const {
    triangle_patch(t, normal, on_triangle);
    on_shape.count = 0;
    on_shape.self = {FeatureKind::vertex, 0};
    if (shape_.shape.vertex_count() == 1) return;  // a sphere has no patch
    Clipped clipped;
    const bool round = shape_.shape.radius() > 0.0 || !shape_.shape.has_polytope_core();
    if (!box_ || round) patch_along(shape_, -normal, gathering_.origin, on_shape);
    const auto lies_along = [&](bool off_face) {
        return round && gather_parallel_edges({nullptr, on_triangle}, {&shape_, on_shape}, normal, gathering_.origin,
                                              size_, clipped, gatherer, off_face);
    };
    if (lies_along(false)) return;
    if (box_) {
        const int face = face_along(shape_.shape, Pair::local(shape_.pose.rotation, -normal));
        BoxFace(shape_, face, box_->to_local(), gathering_.origin, size_).clip(on_triangle, -normal, clipped);
        gatherer.add(clipped, false);
        on_shape.self = {FeatureKind::face, static_cast<std::uint16_t>(face)};
    } else {
        (void)gather_patches(on_triangle, on_shape, normal, clipped, gatherer);
        if (gatherer.points.count == 0) (void)lies_along(true);
    }
}

void SurfaceContacts::gather(const PlacedTriangle& t, const Shape* triangle, Touch& touch, Contact& contact) const {
    contact.normal = touch.normal;
    contact.depth = touch.depth;
    Gatherer gatherer(gathering_, touch, contact.points);
    Patch on_triangle, on_shape;
    gather_patches_along(t, gatherer, touch.normal, on_triangle, on_shape);
    if (!gatherer.lacks_deepest(1e-9 * size_)) return;
    if (!touch.known && triangle != nullptr) name_features(*triangle, shape_.shape, on_triangle, on_shape, touch);
    gatherer.add_deepest();
}

// What lies above the triangle, along its face's normal.
void SurfaceContacts::gather_along_face(const PlacedTriangle& t, bool front, Contact& contact) const {
    Touch touch;
    touch.normal = front ? t.normal : -t.normal;
    touch.depth = HUGE_VAL;
    contact.normal = touch.normal;
    contact.depth = touch.depth;
    Gatherer gatherer(gathering_, touch, contact.points);
    Patch on_triangle, on_shape;
    gather_patches_along(t, gatherer, touch.normal, on_triangle, on_shape);
    if (contact.points.count > 0) return;
    const Support lowest = core_support(shape_.shape, Pair::local(shape_.pose.rotation, -touch.normal));
    const glm::dvec3 point = shape_.pose.rotation * lowest.point + (shape_.pose.translation - gathering_.origin);
    add_support(on_triangle, touch.normal, point, lowest.vertex, true, gatherer);
}

// Of a shape that meets the triangle: where the shape leaves it last when it moves along the face's normal. It is found
// by the way back, from where the shape is certainly beyond the face.
void SurfaceContacts::add_deepest_above(const NearTriangle& near, const PlacedTriangle& t, bool front,
                                        Contact& contact) const {
    const glm::dvec3 normal = front ? t.normal : -t.normal;
    const double way = 2.5 * (shape_.shape.core_radius() + shape_.shape.radius());
    const Shape triangle = ShapeMaker::triangle(near.corners);
    const RigidTransform above{shape_.pose.rotation, shape_.pose.translation + way * normal};
    const Impact back = advance({triangle, surface_.pose}, {}, {shape_.shape, above}, {.velocity = -way * normal},
                                {.tolerance = 1e-9 * size_}, 0.0, nullptr);
    if (back.result == CastResult::miss) return;
    const double depth = way * (1.0 - back.time);
    Patch on_shape;
    patch_along(shape_, -normal, gathering_.origin, on_shape);
    contact.normal = normal;
    contact.depth = depth;
    contact.points.count = 1;
    contact.points.point[0] = {back.on_a - 0.5 * depth * normal, depth, {FeatureKind::face, 0}, on_shape.self, {}, {}};
}

}  // namespace crofton::convex
