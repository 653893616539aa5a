// SPDX-License-Identifier: MIT
#include "parts.hpp"

#include <algorithm>
#include <cmath>
#include <crofton/convex/shape_maker.hpp>
#include <crofton/mesh/mesh_parts.hpp>
#include <crofton/mesh/near_triangles.hpp>
#include <crofton/mesh/swept_triangles.hpp>
#include <glm/matrix.hpp>
#include <limits>

#include "map_frame.hpp"

namespace crofton::convex {
namespace {

constexpr double kWider = 1.0001;  // of a distance: frames are rigid to 1e-6 alone

// A float box that holds the box and its radius, but for `error_bound`.
struct FloatBox {
    mesh::MeshBox box{};
    float error_bound = 0.0f;
};
FloatBox to_floats(const QueryBox& box) {
    FloatBox result;
    double size = 0.0;
    for (int k = 0; k < 3; ++k) {
        result.box.center[k] = static_cast<float>(box.center[k]);
        result.box.half[k] = static_cast<float>(box.half[k] + box.radius);
        for (int i = 0; i < 3; ++i) result.box.axes[k][i] = static_cast<float>(box.axes[k][i]);
        size += std::abs(box.center[k]) + 50.0 * (box.half[k] + box.radius);  // axes are orthonormal to 4e-6 alone
    }
    result.error_bound = static_cast<float>(0x1p-22 * size + kWider * box.rounding) + std::numeric_limits<float>::min();
    return result;
}

// The same without its radius, for a search with a margin.
mesh::RoundedBox rounded(const QueryBox& box, float extent, double margin) {
    QueryBox core = box;
    core.radius = 0.0;
    const FloatBox q = to_floats(core);
    double size = static_cast<double>(extent);
    for (int k = 0; k < 3; ++k) size += std::abs(box.center[k]) + box.half[k];
    return {q.box, static_cast<float>(box.radius * kSkewed),
            q.error_bound + static_cast<float>(margin + 0x1p-18 * size)};
}

// What a sum of these may be off by, turned or not.
double rounding_of(const glm::dvec3& a, const glm::dvec3& b) {
    const glm::dvec3 sum = glm::abs(a) + glm::abs(b);
    return 1e-14 * (sum.x + sum.y + sum.z);
}

}  // namespace

double skew(const glm::dmat3& m) {
    double most = 0.0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j <= i; ++j) most = std::max(most, std::abs(glm::dot(m[i], m[j]) - (i == j ? 1.0 : 0.0)));
    return most;
}

QueryBox core_box(const Shape& shape) {
    const Aabb& bounds = shape.bounds();
    QueryBox box;
    box.center = bounds.center();
    box.radius = shape.radius();
    box.half = (glm::max)(bounds.half_extents() - box.radius, glm::dvec3(0.0));
    for (int k = 0; k < 3; ++k) {  // bounds are rounded outward: without a core's own half extent that is left
        if (!(box.half[k] <= 0x1p-40 * box.radius)) continue;
        box.rounding += box.half[k];
        box.half[k] = 0.0;
    }
    return box;
}

QueryBox box_around(const ShapeAtPose& placed, const RigidTransform& pose) {
    const glm::dmat3 back = glm::inverse(pose.rotation);
    const glm::dvec3 offset = placed.pose.translation - pose.translation;
    QueryBox box = core_box(placed.shape);
    box.axes = back * placed.pose.rotation;
    box.rounding += rounding_of(box.center, offset);
    box.center = back * (placed.pose.rotation * box.center + offset);
    return box;
}

QueryBox seen_from(const QueryBox& box, const RigidTransform& pose) {
    const glm::dmat3 back = glm::inverse(pose.rotation);
    return {back * (box.center - pose.translation), box.half, box.radius, back * box.axes,
            box.rounding * kWider + rounding_of(box.center, pose.translation)};
}

Aabb bounds_of(const QueryBox& box) {
    glm::dvec3 half_size(0.0);
    for (int k = 0; k < 3; ++k) half_size += box.half[k] * glm::abs(box.axes[k]);
    half_size = half_size * (1.0 + 1e-12) + 1e-12 * glm::abs(box.center) + kWider * box.rounding + kSkewed * box.radius;
    return {box.center - half_size, box.center + half_size};
}

double distance_between(const Aabb& a, const Aabb& b) {
    const glm::dvec3 gap = (glm::max)(glm::dvec3(0.0), (glm::max)(a.min - b.max, b.min - a.max));
    if (gap == glm::dvec3(0.0)) return 0.0;
    return glm::length(gap) * (1.0 - 1e-4);
}

namespace {

// Whether the triangle is surely farther than `margin` from the box: by the spheres around them, or along one of the
// box's axes.
bool is_apart(const QueryBox& box, const Triangle& corners, double margin) {
    const glm::dvec3 offset[3] = {corners[0] - box.center, corners[1] - box.center, corners[2] - box.center};
    const double more = kWider * (margin + box.rounding) + kSkewed * box.radius;
    const glm::dvec3 middle = (offset[0] + offset[1] + offset[2]) / 3.0;
    double around = 0.0;
    for (const glm::dvec3& corner : offset) around = (std::max)(around, glm::distance(corner, middle));
    if (glm::length(middle) > (more + around + glm::length(box.half)) * kWider) return true;
    for (const glm::dvec3 axis : {box.axes[0], box.axes[1], box.axes[2]}) {
        double reach = more;
        for (int k = 0; k < 3; ++k) reach += box.half[k] * std::abs(glm::dot(axis, box.axes[k]));
        const double at[3] = {glm::dot(axis, offset[0]), glm::dot(axis, offset[1]), glm::dot(axis, offset[2])};
        const double low = (std::min)({at[0], at[1], at[2]}), high = (std::max)({at[0], at[1], at[2]});
        reach = reach * kWider + 1e-12 * (std::abs(low) + std::abs(high));
        if (low > reach || high < -reach) return true;
    }
    return false;
}

}  // namespace

bool PartSearch::offer(const Triangle& corners, std::uint32_t triangle) const {
    if (on_triangle == nullptr) return visit({ShapeMaker::triangle(corners), pose, {child, triangle}, sides});
    return (*on_triangle)(*this, corners, triangle);
}

bool search_mesh(const Shape& shape, const QueryBox& outer, const PartSearch& search) {
    const mesh::MeshTree& mesh = *shape.mesh();
    const mesh::MeshParts& parts = mesh.parts();
    const MapFrame frame(ShapeMaker::map_of(shape));
    const QueryBox box = frame.map != nullptr ? frame.box(outer) : outer;
    const double wider = kWider * frame.stretch * (1.0 + 2.0 * frame.error);
    bool ended = false;
    const FloatBox q = to_floats(box);
    double squared = wider * wider * search.limit * search.limit;
    const auto offer = [&](const mesh::MeshLeaf& leaf, std::uint32_t lane) {
        Triangle corners;
        for (int v = 0; v < 3; ++v)
            corners[static_cast<std::size_t>(v)] =
                glm::dvec3(glm::vec3(leaf.vertex[v][0][lane], leaf.vertex[v][1][lane], leaf.vertex[v][2][lane]));
        if (frame.map != nullptr) {
            corners = frame.image(corners);
            if (is_apart(outer, corners, search.limit)) return false;
        }
        ended = search.offer(corners, leaf.triangle[lane]);
        squared = wider * wider * search.limit * search.limit;
        return ended;
    };
    if (!frame.is_usable()) {
        for (const mesh::MeshLeaf& leaf : parts.leaves)
            for (std::uint32_t lane = 0; lane < leaf.count; ++lane)
                if (offer(leaf, lane)) return true;
        return false;
    }
    if (search.nearest_first) {
        mesh::visit_nearest_triangles(parts.nodes.data(), parts.leaves.data(), q.box, q.error_bound, squared, offer);
        return ended;
    }
    const double margin = (std::min)(search.limit * wider, 1e18);
    if (box.radius > 0.0 && margin < 1e18) {
        mesh::visit_triangles_near(parts.nodes.data(), parts.leaves.data(), rounded(box, mesh.extent(), margin), offer);
        return ended;
    }
    mesh::visit_triangles_near(parts.nodes.data(), parts.leaves.data(), q.box,
                               q.error_bound + static_cast<float>(margin), offer);
    return ended;
}

bool search_parts(const ShapeAtPose& placed, const QueryBox& box, const PartSearch& search) {
    const Shape& shape = placed.shape;
    if (shape.is_convex()) return search.visit({shape, placed.pose, {search.child, 0}, Sides::both});
    if (shape.kind() == Kind::mesh) return search_mesh(shape, box, search);
    if (shape.kind() == Kind::height_field) return search_field(*shape.height_field(), bounds_of(box), search);
    return search_compound(*shape.compound(), box, search);
}

bool visit_parts(const ShapeAtPose& placed, const QueryBox& box, double margin, PartVisitor visit) {
    return search_parts(placed, box, {placed.pose, placed.shape.sides(), 0, false, margin, visit, &placed.shape});
}

bool visit_parts(const ShapeAtPose& placed, const QueryBox& box, double margin, PartVisitor visit,
                 TriangleVisitor triangles) {
    const Shape& shape = placed.shape;
    return search_parts(placed, box, {placed.pose, shape.sides(), 0, false, margin, visit, &shape, &triangles});
}

bool visit_nearest_parts(const ShapeAtPose& placed, const QueryBox& box, const double& limit, PartVisitor visit) {
    return search_parts(placed, box, {placed.pose, placed.shape.sides(), 0, true, limit, visit, &placed.shape});
}

}  // namespace crofton::convex
