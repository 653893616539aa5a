// SPDX-License-Identifier: MIT
#include "gjk.hpp"

#include <algorithm>
#include <limits>

namespace crofton::convex {
namespace {

constexpr int kMaxRounds = 100;

bool has(const Simplex& s, const Corner& c, bool polytopes) {
    for (int i = 0; i < s.count; ++i)
        if (polytopes ? s.corner[i].a == c.a && s.corner[i].b == c.b : s.corner[i].w == c.w) return true;
    return false;
}

Simplex first_simplex(const Pair& pair, const PairCache* cache) {
    Simplex s;
    if (cache != nullptr && cache->count > 0 && cache->count <= 4 && pair.has_polytope_cores()) {
        for (int i = 0; i < cache->count; ++i)
            if (cache->on_a[i] < pair.a.vertex_count() && cache->on_b[i] < pair.b.vertex_count())
                s.add(pair.corner(cache->on_a[i], cache->on_b[i]));
        if (s.count > 0) return s;
    }
    glm::dvec3 towards = cache != nullptr && cache->axis != glm::dvec3(0.0) ? cache->axis : pair.offset;
    if (towards == glm::dvec3(0.0)) towards.x = 1.0;
    double along = 0.0;
    s.add(pair.support(towards, along));
    return s;
}

}  // namespace

Nearest nearest_points(const Pair& pair, const PairCache* cache, double near, double far, double share) {
    Nearest result;
    Simplex s = first_simplex(pair, cache);
    const bool polytopes = pair.has_polytope_cores();
    const double tiny = 0x1p-40 * pair.size;
    double last = std::numeric_limits<double>::infinity();
    result.upper = last;
    reduce(s, true);
    if (s.count == 0) {  // a pose with NaN: it is near to nothing
        result.relation = Relation::apart;
        result.lower = last;
        return result;
    }
    for (int round = 0; round < kMaxRounds; ++round) {
        if (s.inside) {
            result.simplex = s;
            result.upper = 0.0;
            if (certainly_inside(s, pair.size)) result.relation = Relation::overlapping;
            return result;
        }
        const double length = glm::length(s.nearest);
        // Rounding has stopped the descent. The direction may still get better: an error of it changes the length by
        // its square alone. Round cores need that where the bounds are wide, as no exact search follows.
        if (!(length < last)) {
            const bool close_enough = result.upper - result.lower <= 1e-9 * pair.size;
            if (polytopes || close_enough || !(length <= last * (1.0 + 0x1p-30))) break;
        } else {
            last = length;
            result.simplex = s;
            result.upper = glm::length(witness(s)) + pair.error;
        }
        if (result.upper <= near || length <= tiny) break;
        double along = 0.0;
        const Corner next = pair.support(-s.nearest, along);
        const double lower = -along / length - pair.error;
        if (lower > result.lower) {
            result.lower = lower;
            result.normal = -s.nearest / length;
        }
        if (result.lower > far || result.upper - result.lower <= 4.0 * pair.error) break;
        if (result.upper - result.lower <= share * (result.lower - near)) break;
        if (has(s, next, polytopes)) break;
        s.add(next);
        reduce(s, false);
    }
    if (result.lower > 0.0) result.relation = Relation::apart;
    return result;
}

void remember(const Nearest& nearest, PairCache* cache) {
    if (cache == nullptr) return;
    cache->count = static_cast<std::uint16_t>(nearest.simplex.count);
    for (int i = 0; i < nearest.simplex.count; ++i) {
        cache->on_a[i] = static_cast<std::uint16_t>(nearest.simplex.corner[i].a);
        cache->on_b[i] = static_cast<std::uint16_t>(nearest.simplex.corner[i].b);
    }
    if (nearest.relation == Relation::apart) cache->axis = nearest.normal;
}

}  // namespace crofton::convex
