// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <crofton/convex/query.hpp>

#include "clip.hpp"
#include "core_query.hpp"
#include "part_manifold.hpp"
#include "touch.hpp"

namespace crofton::convex {
namespace {

struct GatheredPoints {
    int count = 0;
    RawPoint point[kMaxClipped + 1];
};

class Gatherer {
  public:
    Gatherer(const Placed& a, const Placed& b, const Touch& touch, double margin)
        : a_(a), b_(b), touch_(touch), margin_(margin) {}

    // GatheredPoints of the surfaces, from points of the cores.
    void add(const glm::dvec3& core_a, const glm::dvec3& core_b, const Feature& on_a, const Feature& on_b) {
        const glm::dvec3 p = core_a + a_.body.radius() * touch_.normal, q = core_b - b_.body.radius() * touch_.normal;
        // A face that is not quite flat would seem deeper than the bodies overlap.
        const double depth = std::min(glm::dot(p - q, touch_.normal), touch_.depth);
        if (!(depth >= -margin_)) return;
        points.point[points.count++] = {a_.pose.translation + 0.5 * (p + q), depth, on_a, on_b, {}, {}};
    }

    void add(const Clipped& clipped, bool reference_is_a) {
        for (int i = 0; i < clipped.count; ++i) {
            const ClippedPoint& c = clipped.point[i];
            if (reference_is_a)
                add(c.on_reference, c.on_incident, c.reference, c.incident);
            else
                add(c.on_incident, c.on_reference, c.incident, c.reference);
        }
    }

    // The deepest place, where the patches have left it out.
    void add_deepest(double slack, const Feature& fallback_a, const Feature& fallback_b) {
        double deepest = -HUGE_VAL;
        for (int i = 0; i < points.count; ++i) deepest = std::max(deepest, points.point[i].depth);
        if (points.count > 0 && deepest >= touch_.depth - slack) return;
        margin_ = HUGE_VAL;
        const auto feature = [&](const Body& body, const int* vertices, const Feature& fallback) {
            return body.has_polytope_core() && touch_.vertex_count > 0 ? feature_of(body, vertices, touch_.vertex_count)
                                                                       : fallback;
        };
        if (touch_.known)
            add(touch_.on_a, touch_.on_b, touch_.feature_a, touch_.feature_b);
        else
            add(touch_.on_a, touch_.on_b, feature(a_.body, touch_.vertices_a, fallback_a),
                feature(b_.body, touch_.vertices_b, fallback_b));
        if (points.count > 0) points.point[points.count - 1].depth = touch_.depth;
    }

    GatheredPoints points;

  private:
    const Placed &a_, &b_;
    const Touch& touch_;
    double margin_;
};

bool nearly_parallel(const Patch& a, const Patch& b) {
    const glm::dvec3 u = a.point[1] - a.point[0], v = b.point[1] - b.point[0], n = glm::cross(u, v);
    return glm::dot(n, n) <= 1e-3 * glm::dot(u, u) * glm::dot(v, v);
}

// The reference is the face that looks along the normal more; of faces alike a's, so that it stays. Returns whose it
// is: 1 a's, 2 b's, 0 where no face is clipped.
int gather_patches(const Patch& a, const Patch& b, const glm::dvec3& normal, Clipped& clipped, Gatherer& gatherer) {
    if (a.count < 2 || b.count < 2) return 0;
    if (a.count == 2 && b.count == 2) {
        if (nearly_parallel(a, b)) clip_segments(a, b, clipped), gatherer.add(clipped, true);
        return 0;
    }
    const double along_a = a.count > 2 ? glm::dot(a.normal, normal) : -1.0;
    const double along_b = b.count > 2 ? -glm::dot(b.normal, normal) : -1.0;
    const bool reference_is_a = along_a >= along_b - 1e-3 && a.count > 2;
    const glm::dvec3 out = reference_is_a ? normal : -normal;
    Prism sides;
    find_sides(reference_is_a ? a : b, out, sides);
    clip(reference_is_a ? a : b, sides, reference_is_a ? b : a, out, clipped);
    gatherer.add(clipped, reference_is_a);
    return reference_is_a ? 1 : 2;
}

Manifold finish(Gatherer& gatherer, const Touch& touch, int most) {
    Manifold manifold;
    manifold.normal = touch.normal;
    if (gatherer.points.count > 0)
        thin_out(manifold, gatherer.points.point, gatherer.points.count, std::clamp(most, 1, 8));
    return manifold;
}

// a is the half-space.
Manifold on_half_space(const Placed& a, const Placed& b, const ManifoldOptions& options) {
    const HalfSpaceGap gap = half_space_gap(a, b);
    const double apart = gap.gap - b.body.radius();
    const bool meet = apart <= gap.error && half_space_meets(a, b);
    Touch touch;
    touch.normal = gap.outward;
    touch.depth = meet ? std::max(-apart, 0.0) : -apart;
    if (!(meet || apart <= options.margin)) return {};
    Patch patch;
    patch_along(b, -gap.outward, a.pose.translation, patch);
    Gatherer gatherer(a, b, touch, options.margin);
    const glm::dvec3 deepest = gap.deepest - a.pose.translation;
    const auto shadow = [&](const glm::dvec3& p) {
        return p - (glm::dot(p - deepest, gap.outward) + gap.gap) * gap.outward;
    };
    const FeatureKind kind = FeatureKind::vertex;
    for (int i = 0; i < patch.count; ++i)
        gatherer.add(shadow(patch.point[i]), patch.point[i], {FeatureKind::face, 0}, {kind, patch.vertex[i]});
    touch.on_a = shadow(deepest);
    touch.on_b = deepest;
    gatherer.add_deepest(gap.error + 1e-9 * b.body.reach(), {FeatureKind::face, 0}, patch.self);
    return finish(gatherer, touch, options.max_points);
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

Manifold manifold_along(const Placed& a, const Placed& b, const glm::dvec3& normal, const ManifoldOptions& options) {
    Touch touch;
    touch.normal = normal;
    touch.depth = HUGE_VAL;
    Patch patch_a, patch_b;
    patch_along(a, normal, a.pose.translation, patch_a);
    patch_along(b, -normal, a.pose.translation, patch_b);
    Gatherer gatherer(a, b, touch, options.margin);
    Clipped clipped;
    (void)gather_patches(patch_a, patch_b, normal, clipped, gatherer);
    return finish(gatherer, touch, options.max_points);
}

Manifold contact_manifold(const Placed& a, const Placed& b, const ManifoldOptions& options, PairCache* cache) {
    if (!a.body.is_convex() || !b.body.is_convex()) return deepest_manifold(a, b, options);
    return convex_manifold(a, b, options, cache, kKeptDepth);
}

Manifold triangle_manifold(const Placed& a, const Placed& b, const ManifoldOptions& options) {
    PairCache guess;
    guess.reference = 1;
    return convex_manifold(a, b, options, &guess, kSameDepth);
}

Manifold convex_manifold(const Placed& a, const Placed& b, const ManifoldOptions& options, PairCache* cache,
                         double kept) {
    if (is_half_space(a)) return is_half_space(b) ? Manifold{} : on_half_space(a, b, options);
    if (is_half_space(b)) return flipped(on_half_space(b, a, options));
    const Pair pair(a, b);
    Touch touch;
    Clipped clipped;
    if (cache != nullptr && cache->reference != 0) {
        const Warm warm = touch_at_face(a, b, pair, options.margin, *cache, kept, touch, clipped);
        if (warm == Warm::apart) return {};
        if (warm == Warm::touching) {
            Gatherer gatherer(a, b, touch, options.margin);
            gatherer.add(clipped, cache->reference == 1);
            gatherer.add_deepest(1e-9 * pair.size, touch.feature_a, touch.feature_b);
            return finish(gatherer, touch, options.max_points);
        }
        touch = {};
    }
    if (!find_touch(pair, options.margin, cache, touch)) return {};
    Patch patch_a, patch_b;
    patch_along(a, touch.normal, a.pose.translation, patch_a);
    patch_along(b, -touch.normal, a.pose.translation, patch_b);
    Gatherer gatherer(a, b, touch, options.margin);
    const int reference = gather_patches(patch_a, patch_b, touch.normal, clipped, gatherer);
    if (cache != nullptr) {
        const Patch& patch = reference == 2 ? patch_b : patch_a;
        const bool across = std::abs(glm::dot(patch.normal, touch.normal)) > 1.0 - 1e-8;
        cache->reference = static_cast<std::uint16_t>(across ? reference : 0);
        cache->face = patch.self.index;
    }
    gatherer.add_deepest(1e-9 * pair.size, patch_a.self, patch_b.self);
    return finish(gatherer, touch, options.max_points);
}

}  // namespace crofton::convex
