// SPDX-License-Identifier: MIT
// contact_manifold: the contact points of two shapes, at most ManifoldOptions::max_points. Clips the touching faces
// against each other.
#include <algorithm>
#include <cmath>
#include <crofton/convex/query.hpp>
#include <limits>

#include "box_pair.hpp"
#include "core_query.hpp"
#include "gather.hpp"
#include "parallel_edges.hpp"
#include "part_manifold.hpp"

namespace crofton::convex {
namespace {

// Without clearing the points, as Manifold{} would.
Manifold nothing() {
    Manifold manifold;
    return manifold;
}

Gathering gathering_of(const ShapeAtPose& a, const ShapeAtPose& b, double size, double margin) {
    return {a.pose.translation, a.shape.radius(), b.shape.radius(), margin, size};
}

// A point's id in one number that is not 0. Features of convex shapes have indices below 1024.
std::uint32_t number_of(const ContactPoint& p) {
    const auto feature = [](const Feature& f) { return static_cast<std::uint32_t>(f.kind) << 10 | f.index; };
    return 1U << 31 | feature(p.on_a) << 12 | feature(p.on_b);
}

// Returns the area of points that are sorted around a circle.
double area_of(const Manifold& m) {
    glm::dvec3 sum(0.0);
    for (int i = 1; i + 1 < m.count; ++i)
        sum += glm::cross(m.points[i].position - m.points[0].position, m.points[i + 1].position - m.points[0].position);
    return glm::length(sum);
}

// Puts the points of the frame before into the place of those chosen afresh, if they serve as well. A shape that sways
// would else lose all of its ids whenever another corner becomes the deepest.
void keep_choice(Manifold& manifold, const GatheredPoints& points, double kept, PairCache& cache) {
    const auto end = cache.chosen + 4;
    std::uint32_t numbers[4] = {};
    for (int i = 0; i < manifold.count; ++i) numbers[i] = number_of(manifold.points[i]);
    if (std::equal(numbers, numbers + 4, cache.chosen)) return;
    Manifold before;
    double deepest = -std::numeric_limits<double>::infinity();
    for (int i = 0; i < points.count && before.count < 4; ++i) {
        const ContactPoint& p = points.point[i];
        if (std::find(cache.chosen, end, number_of(p)) == end) continue;
        before.points[before.count++] = p;
        deepest = std::max(deepest, p.depth);
    }
    if (before.count == manifold.count && deepest >= manifold.depth - kept &&
        area_of(before) >= 0.9 * area_of(manifold)) {
        std::copy_n(before.points, before.count, manifold.points);
        return;
    }
    std::copy_n(numbers, 4, cache.chosen);
}

Manifold finish(const ShapeAtPose& a, const ShapeAtPose& b, GatheredPoints& points, const Touch& touch,
                const ManifoldOptions& options, double size, PairCache* cache) {
    Manifold manifold;
    manifold.normal = touch.normal;
    if (points.count == 0) return manifold;
    move_to_surface(a, b, touch.normal, touch.depth, {points.point, static_cast<std::size_t>(points.count)});
    const int most = std::clamp(options.max_points, 1, 8);
    thin_out(manifold, points.point, points.count, most);
    if (cache != nullptr && points.count > most && most <= 4) keep_choice(manifold, points, kKeptDepth * size, *cache);
    return manifold;
}

// The touch's deepest points alone.
Manifold at_deepest(const ShapeAtPose& a, const ShapeAtPose& b, const Touch& touch) {
    Manifold manifold;
    manifold.normal = touch.normal;
    manifold.depth = touch.depth;
    manifold.count = 1;
    manifold.points[0] = deepest_point(gathering_of(a, b, 0.0, 0.0), touch);
    return manifold;
}

// Where one shape's core is a point.
Manifold at_point(const ShapeAtPose& a, const ShapeAtPose& b, Touch& touch, PairCache* cache) {
    if (cache != nullptr) cache->reference = 0;
    Patch patch_a, patch_b;
    if (!(touch.known || (touch.vertex_count > 0 && a.shape.has_polytope_core() && b.shape.has_polytope_core()))) {
        patch_along(a, touch.normal, a.pose.translation, patch_a);
        patch_along(b, -touch.normal, a.pose.translation, patch_b);
    }
    name_features(a.shape, b.shape, patch_a, patch_b, touch);
    return at_deepest(a, b, touch);
}

// What the touch's patches have in common, clipped against the face of a (1) or of b (2).
Manifold gather_clipped(const ShapeAtPose& a, const ShapeAtPose& b, const Pair& pair, const Touch& touch,
                        const Clipped& clipped, const ManifoldOptions& options, PairCache& cache) {
    if (clipped.count == 0) return at_deepest(a, b, touch);
    GatheredPoints points;
    Gatherer gatherer(gathering_of(a, b, pair.size, options.margin), touch, points);
    gatherer.add(clipped, cache.reference == 1);
    if (gatherer.lacks_deepest(1e-9 * pair.size)) gatherer.add_deepest();
    return finish(a, b, points, touch, options, pair.size, &cache);
}

// a is the half-space.
Manifold on_half_space(const ShapeAtPose& a, const ShapeAtPose& b, const ManifoldOptions& options, PairCache* cache) {
    const HalfSpaceGap gap = half_space_gap(a, b);
    const double apart = gap.gap - b.shape.radius();
    const bool meet = apart <= gap.error && half_space_meets(a, b);
    Touch touch;
    touch.normal = gap.outward;
    touch.depth = meet ? std::max(-apart, 0.0) : -apart;
    // Told apart exactly, by less than rounding shows, counts as apart.
    if (!(meet || (options.margin > 0.0 && apart <= options.margin))) return nothing();
    Patch patch;
    patch_along(b, -gap.outward, a.pose.translation, patch);
    GatheredPoints points;
    Gatherer gatherer(gathering_of(a, b, b.shape.core_radius(), options.margin), touch, points);
    const glm::dvec3 deepest = gap.deepest - a.pose.translation;
    const auto shadow = [&](const glm::dvec3& p) {
        return p - (glm::dot(p - deepest, gap.outward) + gap.gap) * gap.outward;
    };
    const FeatureKind kind = FeatureKind::vertex;
    for (int i = 0; i < patch.count; ++i)
        gatherer.add(shadow(patch.point[i]), patch.point[i], {FeatureKind::face, 0}, {kind, patch.vertex[i]});
    touch.on_a = shadow(deepest);
    touch.on_b = deepest;
    if (gatherer.lacks_deepest(gap.error + 1e-9 * b.shape.core_radius())) {
        touch.feature_a = {FeatureKind::face, 0};
        touch.feature_b = patch.self;
        gatherer.add_deepest();
    }
    return finish(a, b, points, touch, options, b.shape.core_radius(), cache);
}

}  // namespace

Manifold flipped(Manifold m) {
    m.normal = -m.normal;
    for (int i = 0; i < m.count; ++i) {
        std::swap(m.points[i].on_a, m.points[i].on_b);
        std::swap(m.points[i].part_a, m.points[i].part_b);
    }
    return m;
}

Manifold contact_manifold(const ShapeAtPose& a, const ShapeAtPose& b, const ManifoldOptions& options,
                          PairCache* cache) {
    if (!a.shape.is_convex() || !b.shape.is_convex()) return deepest_manifold(a, b, options);
    if (is_half_space(a)) return is_half_space(b) ? nothing() : on_half_space(a, b, options, cache);
    if (is_half_space(b)) return flipped(on_half_space(b, a, options, cache));
    const Pair pair(a, b);
    if (is_solid_box(a.shape) && is_solid_box(b.shape)) {
        Touch touch;
        GatheredPoints points;
        const Warm answer = touch_of_boxes(a, b, pair, options.margin, cache, touch, points);
        if (answer == Warm::apart) return nothing();
        if (answer == Warm::touching) return finish(a, b, points, touch, options, pair.size, cache);
    }
    Touch touch;
    Clipped clipped;
    if (cache != nullptr && cache->reference != 0) {
        const Warm warm = touch_at_face(a, b, pair, options.margin, *cache, kKeptDepth, touch, clipped);
        if (warm == Warm::apart) return nothing();
        if (warm == Warm::touching) return gather_clipped(a, b, pair, touch, clipped, options, *cache);
        touch = {};
    }
    if (!find_touch(pair, options.margin, cache, touch)) return nothing();
    if (a.shape.vertex_count() == 1 || b.shape.vertex_count() == 1) return at_point(a, b, touch, cache);
    Patch patch_a, patch_b;
    patch_along(a, touch.normal, a.pose.translation, patch_a);
    patch_along(b, -touch.normal, a.pose.translation, patch_b);
    GatheredPoints points;
    Gatherer gatherer(gathering_of(a, b, pair.size, options.margin), touch, points);
    const bool round = pair.rounding() > 0.0 || !pair.has_polytope_cores();
    const auto lies_along = [&](bool off_face) {
        return round && gather_parallel_edges({&a, patch_a}, {&b, patch_b}, touch.normal, a.pose.translation, pair.size,
                                              clipped, gatherer, off_face);
    };
    int reference = lies_along(false) ? 0 : gather_patches(patch_a, patch_b, touch.normal, clipped, gatherer);
    if (reference != 0 && points.count == 0 && lies_along(true)) reference = 0;
    if (cache != nullptr) {
        const Patch& patch = reference == 2 ? patch_b : patch_a;
        const bool across = std::abs(glm::dot(patch.normal, touch.normal)) > 1.0 - 1e-8;
        cache->reference = static_cast<std::uint16_t>(across ? reference : 0);
        cache->face = patch.self.index;
    }
    if (gatherer.lacks_deepest(1e-9 * pair.size)) {
        name_features(a.shape, b.shape, patch_a, patch_b, touch);
        gatherer.add_deepest();
    }
    return finish(a, b, points, touch, options, pair.size, cache);
}

}  // namespace crofton::convex
