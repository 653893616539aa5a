// SPDX-License-Identifier: MIT
#include "parallel_edges.hpp"

#include <algorithm>
#include <cmath>

#include "pair.hpp"

namespace crofton::convex {
namespace {

constexpr double kSine = 0.034899496702500971;  // of 2 degrees

struct Edge {
    glm::dvec3 from{0.0}, to{0.0};
    std::uint16_t vertices[2] = {0, 0};
    Feature self{FeatureKind::edge, 0};
};

// The sine up to which a face counts as across the normal. Normals of cylinders and cones are off by 1e-5 and more, a
// hull's faces are flat to 1e-5.
double flat_sine(const PatchOf& a, const PatchOf& b) {
    const auto of = [](const PatchOf& side) {
        if (side.shape == nullptr) return 1e-6;
        if (!side.shape->shape.has_polytope_core()) return 1e-3;
        return side.shape->shape.kind() == Kind::hull ? 1e-4 : 1e-6;
    };
    return std::max(of(a), of(b));
}

// Whether it touches with what is no edge: a face across the normal up to a sine, if that is not negative; a rim, a
// point.
bool has_no_edge(const PatchOf& side, const glm::dvec3& normal, double flat) {
    if (side.patch.count < 3) return side.patch.count < 2;
    if (side.shape != nullptr && !side.shape->shape.has_polytope_core()) return true;
    const glm::dvec3 across = glm::cross(side.patch.normal, normal);
    return side.patch.normal != glm::dvec3(0.0) && flat >= 0.0 && glm::dot(across, across) <= flat * flat;
}

// The edges that have an end farthest along `outward`, but for `tolerance`.
template <class Visit>
void for_each_edge(const PatchOf& side, const glm::dvec3& outward, const glm::dvec3& origin, double tolerance,
                   Visit visit) {
    const Patch& patch = side.patch;
    if (patch.count == 2)
        return visit({patch.point[0], patch.point[1], {patch.vertex[0], patch.vertex[1]}, patch.self});
    const auto index = [](int i) { return static_cast<std::uint16_t>(i); };
    if (side.shape == nullptr || side.shape->shape.kind() == Kind::triangle) {
        double top = -HUGE_VAL;
        for (int k = 0; k < 3; ++k) top = std::max(top, glm::dot(outward, patch.point[k]));
        for (int k = 0; k < 3; ++k) {
            const int next = (k + 1) % 3;
            const glm::dvec3 &p = patch.point[k], &q = patch.point[next];
            if (std::max(glm::dot(outward, p), glm::dot(outward, q)) < top - tolerance) continue;
            visit({p, q, {patch.vertex[k], patch.vertex[next]}, {FeatureKind::edge, patch.edge[k]}});
        }
        return;
    }
    const Shape& shape = side.shape->shape;
    const RigidTransform& pose = side.shape->pose;
    const glm::dvec3 local = Pair::local(pose.rotation, outward), offset = pose.translation - origin;
    const double least = core_support(shape, local).along - tolerance;
    const auto offer = [&](int i, int j, std::uint16_t edge) {
        const glm::dvec3 p = shape.vertex(i), q = shape.vertex(j);
        if (std::max(glm::dot(local, p), glm::dot(local, q)) < least) return;
        visit(
            {pose.rotation * p + offset, pose.rotation * q + offset, {index(i), index(j)}, {FeatureKind::edge, edge}});
    };
    if (shape.kind() == Kind::box) {
        for (int i = 0; i < 8; ++i)
            for (int k = 1; k < 8; k *= 2)
                if ((i & k) == 0) offer(i, i | k, box_edge(i, i | k));
    } else if (shape.kind() == Kind::hull) {
        const auto edges = shape.hull()->edges();
        for (std::size_t e = 0; e < edges.size(); ++e)
            offer(edges[e].vertices[0], edges[e].vertices[1], static_cast<std::uint16_t>(e));
    }
}

bool is_round(const PatchOf& side) {
    return side.shape != nullptr && (side.shape->shape.radius() > 0.0 || !side.shape->shape.has_polytope_core());
}

double squared(const glm::dvec3& v) {
    return glm::dot(v, v);
}
double squared(double v) {
    return v * v;
}

void set_patch(const Edge& edge, Patch& patch) {
    patch.count = 2;
    patch.self = edge.self;
    patch.point[0] = edge.from;
    patch.point[1] = edge.to;
    patch.vertex[0] = edge.vertices[0];
    patch.vertex[1] = edge.vertices[1];
}

}  // namespace

bool gather_parallel_edges(const PatchOf& a, const PatchOf& b, const glm::dvec3& normal, const glm::dvec3& origin,
                           double size, Clipped& clipped, Gatherer& gatherer, bool off_face) {
    const double flat = flat_sine(a, b), tolerance = 1e-9 * size, face = off_face ? -1.0 : flat;
    if (has_no_edge(a, normal, face) || has_no_edge(b, normal, face)) return false;
    // Chooses the pair that is most nearly parallel and across the normal.
    Edge of_a, of_b;
    double least = HUGE_VAL;
    for_each_edge(a, normal, origin, tolerance, [&](const Edge& e) {
        const glm::dvec3 u = e.to - e.from;
        for_each_edge(b, -normal, origin, tolerance, [&](const Edge& f) {
            const glm::dvec3 v = f.to - f.from;
            // All parallel edges of the face are as far along the normal: one of them is beside the side.
            if (off_face &&
                squared(glm::dot(f.from - e.from, glm::cross(u, normal))) > 1e-8 * squared(u) * squared(size))
                return;
            const double sine2 = squared(glm::cross(u, v)) / (squared(u) * squared(v));
            const double slopes = squared(glm::dot(u, normal)) / squared(u) + squared(glm::dot(v, normal)) / squared(v);
            if (!(sine2 <= kSine * kSine && slopes <= 2.0 * kSine * kSine && sine2 + slopes < least)) return;
            least = sine2 + slopes;
            of_a = e;
            of_b = f;
        });
    });
    if (!(least < HUGE_VAL)) return false;
    Patch on_a, on_b;
    set_patch(of_a, on_a);
    set_patch(of_b, on_b);
    clip_segments(on_a, on_b, clipped);
    // Round ones may pass beside each other by the angle between them, over the stretch; others lie elsewhere on the
    // shapes. Points of sharp edges are on both.
    const double stretch =
        clipped.count < 2 ? 0.0 : glm::distance(clipped.point[0].on_reference, clipped.point[1].on_reference);
    const double beside = is_round(a) && is_round(b) ? 1.1 * kSine * stretch + 1e-6 * size
                          : flat < 1e-3              ? 1e-7 * size
                                                     : 1e-4 * size;  // as normals of cylinders and cones may be off
    for (int i = 0; i < clipped.count; ++i) {
        const glm::dvec3 way = clipped.point[i].on_reference - clipped.point[i].on_incident;
        if (squared(way - glm::dot(way, normal) * normal) > beside * beside) return false;
    }
    gatherer.add(clipped, true);
    return clipped.count > 0;
}

}  // namespace crofton::convex
