// SPDX-License-Identifier: MIT
#include "gather.hpp"

#include <algorithm>
#include <cmath>

namespace crofton::convex {
void Gatherer::add(const glm::dvec3& core_a, const glm::dvec3& core_b, const Feature& on_a, const Feature& on_b) {
    const glm::dvec3 p = core_a + of_.radius_a * touch_.normal, q = core_b - of_.radius_b * touch_.normal;
    // A face that is not quite flat would seem deeper than the bodies overlap.
    const double depth = std::min(glm::dot(p - q, touch_.normal), touch_.depth);
    if (!(depth >= -of_.margin)) return;
    points.point[points.count++] = {of_.origin + 0.5 * (p + q), depth, on_a, on_b, {}, {}};
}

void Gatherer::add(const Clipped& clipped, bool reference_is_a) {
    for (int i = 0; i < clipped.count; ++i) {
        const ClippedPoint& c = clipped.point[i];
        if (reference_is_a)
            add(c.on_reference, c.on_incident, c.reference, c.incident);
        else
            add(c.on_incident, c.on_reference, c.incident, c.reference);
    }
}

bool Gatherer::lacks_deepest(double tolerance) const {
    for (int i = 0; i < points.count; ++i)
        if (points.point[i].depth >= touch_.depth - tolerance) return false;
    return true;
}

void Gatherer::add_deepest() {
    of_.margin = HUGE_VAL;
    const int before = points.count;
    add(touch_.on_a, touch_.on_b, touch_.feature_a, touch_.feature_b);
    if (points.count == before) return;
    ContactPoint deepest = points.point[--points.count];
    deepest.depth = touch_.depth;
    int place = 0;
    while (place < points.count && !has_same_id(points.point[place], deepest)) ++place;
    points.point[place] = deepest;
    points.count = std::max(points.count, place + 1);
}

int gather_patches(const Patch& a, const Patch& b, const glm::dvec3& normal, Clipped& clipped, Gatherer& gatherer) {
    if (a.count < 2 || b.count < 2 || (a.count == 2 && b.count == 2)) return 0;
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

void name_features(const Body& a, const Body& b, const Patch& patch_a, const Patch& patch_b, Touch& touch) {
    if (touch.known) return;
    const auto feature = [&](const Body& body, const int* vertices, const Feature& fallback) {
        return body.has_polytope_core() && touch.vertex_count > 0 ? feature_of(body, vertices, touch.vertex_count)
                                                                  : fallback;
    };
    touch.feature_a = feature(a, touch.vertices_a, patch_a.self);
    touch.feature_b = feature(b, touch.vertices_b, patch_b.self);
    touch.known = true;
}

}  // namespace crofton::convex
