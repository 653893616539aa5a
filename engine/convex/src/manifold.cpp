// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <crofton/convex/query.hpp>

#include "box_pair.hpp"
#include "core_query.hpp"
#include "gather.hpp"
#include "part_manifold.hpp"

namespace crofton::convex {
namespace {

// Without clearing the points, as Manifold{} would.
Manifold nothing() {
    Manifold manifold;
    return manifold;
}

Gathering gathering_of(const Placed& a, const Placed& b, double margin) {
    return {a.pose.translation, a.body.radius(), b.body.radius(), margin};
}

Manifold finish(const GatheredPoints& points, const Touch& touch, int most) {
    Manifold manifold;
    manifold.normal = touch.normal;
    if (points.count > 0) thin_out(manifold, points.point, points.count, std::clamp(most, 1, 8));
    return manifold;
}

// What the touch's patches have in common, clipped against the face of a (1) or of b (2).
Manifold gather_clipped(const Placed& a, const Placed& b, const Pair& pair, const Touch& touch, const Clipped& clipped,
                        int reference, const ManifoldOptions& options) {
    GatheredPoints points;
    Gatherer gatherer(gathering_of(a, b, options.margin), touch, points);
    gatherer.add(clipped, reference == 1);
    if (gatherer.lacks_deepest(1e-9 * pair.size)) gatherer.add_deepest();
    return finish(points, touch, options.max_points);
}

// a is the half-space.
Manifold on_half_space(const Placed& a, const Placed& b, const ManifoldOptions& options) {
    const HalfSpaceGap gap = half_space_gap(a, b);
    const double apart = gap.gap - b.body.radius();
    const bool meet = apart <= gap.error && half_space_meets(a, b);
    Touch touch;
    touch.normal = gap.outward;
    touch.depth = meet ? std::max(-apart, 0.0) : -apart;
    if (!(meet || apart <= options.margin)) return nothing();
    Patch patch;
    patch_along(b, -gap.outward, a.pose.translation, patch);
    GatheredPoints points;
    Gatherer gatherer(gathering_of(a, b, options.margin), touch, points);
    const glm::dvec3 deepest = gap.deepest - a.pose.translation;
    const auto shadow = [&](const glm::dvec3& p) {
        return p - (glm::dot(p - deepest, gap.outward) + gap.gap) * gap.outward;
    };
    const FeatureKind kind = FeatureKind::vertex;
    for (int i = 0; i < patch.count; ++i)
        gatherer.add(shadow(patch.point[i]), patch.point[i], {FeatureKind::face, 0}, {kind, patch.vertex[i]});
    touch.on_a = shadow(deepest);
    touch.on_b = deepest;
    if (gatherer.lacks_deepest(gap.error + 1e-9 * b.body.reach())) {
        touch.feature_a = {FeatureKind::face, 0};
        touch.feature_b = patch.self;
        gatherer.add_deepest();
    }
    return finish(points, touch, options.max_points);
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

Manifold contact_manifold(const Placed& a, const Placed& b, const ManifoldOptions& options, PairCache* cache) {
    if (!a.body.is_convex() || !b.body.is_convex()) return deepest_manifold(a, b, options);
    if (is_half_space(a)) return is_half_space(b) ? nothing() : on_half_space(a, b, options);
    if (is_half_space(b)) return flipped(on_half_space(b, a, options));
    const Pair pair(a, b);
    if (a.body.kind() == Kind::box && b.body.kind() == Kind::box) {
        Touch touch;
        GatheredPoints points;
        const Warm answer = touch_of_boxes(a, b, pair, options.margin, cache, touch, points);
        if (answer == Warm::apart) return nothing();
        if (answer == Warm::touching) return finish(points, touch, options.max_points);
    }
    Touch touch;
    Clipped clipped;
    if (cache != nullptr && cache->reference != 0) {
        const Warm warm = touch_at_face(a, b, pair, options.margin, *cache, kKeptDepth, touch, clipped);
        if (warm == Warm::apart) return nothing();
        if (warm == Warm::touching) return gather_clipped(a, b, pair, touch, clipped, cache->reference, options);
        touch = {};
    }
    if (!find_touch(pair, options.margin, cache, touch)) return nothing();
    Patch patch_a, patch_b;
    patch_along(a, touch.normal, a.pose.translation, patch_a);
    patch_along(b, -touch.normal, a.pose.translation, patch_b);
    GatheredPoints points;
    Gatherer gatherer(gathering_of(a, b, options.margin), touch, points);
    const int reference = gather_patches(patch_a, patch_b, touch.normal, clipped, gatherer);
    if (cache != nullptr) {
        const Patch& patch = reference == 2 ? patch_b : patch_a;
        const bool across = std::abs(glm::dot(patch.normal, touch.normal)) > 1.0 - 1e-8;
        cache->reference = static_cast<std::uint16_t>(across ? reference : 0);
        cache->face = patch.self.index;
    }
    if (gatherer.lacks_deepest(1e-9 * pair.size)) {
        name_features(a.body, b.body, patch_a, patch_b, touch);
        gatherer.add_deepest();
    }
    return finish(points, touch, options.max_points);
}

}  // namespace crofton::convex
