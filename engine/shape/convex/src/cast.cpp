// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <crofton/convex/query.hpp>
#include <crofton/geometry/trigonometry.hpp>

#include "core_query.hpp"
#include "part_cast.hpp"

namespace crofton::convex {
namespace {

constexpr double kMaxTurn = 1e5;

bool finite(const glm::dvec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

Result<void> check(const Motion& motion, const CastOptions& options, std::uint64_t item) {
    if (!finite(motion.velocity) || !finite(motion.spin) || !finite(motion.pivot))
        return fail(ErrorCode::non_finite, item, "cast: a motion is NaN or infinite");
    if (!(glm::length(motion.spin) * options.duration <= kMaxTurn))
        return fail(ErrorCode::out_of_range, item, "cast: a body turns by more than 1e5 radians; shorten the duration");
    return {};
}

Result<void> check(const CastOptions& options) {
    if (!(options.duration >= 0.0 && options.duration < HUGE_VAL))
        return fail(ErrorCode::invalid_argument, kNoItem, "cast: the duration must be finite and not negative");
    if (!(options.tolerance > 0.0 && options.tolerance < HUGE_VAL))
        return fail(ErrorCode::invalid_argument, kNoItem, "cast: the tolerance must be above 0");
    if (options.max_steps < 1) return fail(ErrorCode::invalid_argument, kNoItem, "cast: max_steps must be at least 1");
    return {};
}

// How far the body can come towards a plane within time s: along d (unit, in the world), from where it stands now.
// Vertex v at r from the pivot: dot(d, position) grows by at most s · dot(d, velocity + spin × r) + s²/2 · |spin|² |r|.
// Of a round core every point is bounded by its reach alone.
class Advance {
  public:
    Advance(const Placed& now, const Motion& motion, const glm::dvec3& d) : body_(now.body) {
        const glm::dvec3 local = Pair::local(now.pose.rotation, d);
        const double spin = glm::length(motion.spin), arm = body_.reach() + glm::length(motion.pivot);
        now_ = core_support(body_, local).along;
        drift_ = glm::dot(d, motion.velocity);
        if (spin == 0.0) return;
        bend_ = 0.5 * spin * spin * arm * 1.00001;  // matrices are rotations up to 1e-6
        // dot(d, spin × r) = dot(d × spin, r)
        turned_ = Pair::local(now.pose.rotation, glm::cross(d, motion.spin));
        drift_ -= glm::dot(turned_, motion.pivot);
        local_ = local;
        spins_ = true;
        if (!body_.has_polytope_core()) drift_ = glm::dot(d, motion.velocity) + glm::length(turned_) * arm;
    }

    [[nodiscard]] double operator()(double s) const {
        if (!spins_) return s * drift_;
        if (!body_.has_polytope_core()) return s * drift_ + s * s * bend_;
        return core_support(body_, local_ + s * turned_).along - now_ + s * drift_ + s * s * bend_;
    }

  private:
    const Body& body_;
    glm::dvec3 local_{0.0}, turned_{0.0};
    double now_ = 0.0, drift_ = 0.0, bend_ = 0.0;
    bool spins_ = false;
};

// The greatest step for which the bodies together advance by less than `gap`, within 1 % below; at most `limit`.
// `advance` is convex and 0 at 0.
template <class Together>
double safe_step(const Together& advance, double gap, double limit) {
    if (advance(limit) < gap) return limit;
    double low = 0.0, high = limit;
    for (int i = 0; i < 200 && high - low > 0.01 * low; ++i) {
        // A chord of a convex function lies above it: where it reaches the gap is safe.
        const double at_low = advance(low), at_high = advance(high);
        const double chord = low + (gap - at_low) / (at_high - at_low) * (high - low);
        const double next = i % 2 == 0 && chord > low && chord < high ? chord : 0.5 * (low + high);
        if (next <= low || next >= high) break;
        (advance(next) < gap ? low : high) = next;
    }
    return low;
}

// How far a vertex may be from where the real path has it at time t: at_start + t · growth. By rounding of the rotation
// and of the way, here and in Advance.
struct PathError {
    double at_start = 0.0, growth = 0.0;
};
PathError path_error(const Placed& body, const Motion& motion) {
    const double speed = glm::length(motion.velocity);
    if (is_half_space(body)) return {0.0, 0x1p-47 * speed};
    const double arm = body.body.reach() + glm::length(motion.pivot);
    return {0x1p-47 * arm, 0x1p-47 * (arm * glm::length(motion.spin) + speed)};
}

// `growth` is that of both paths' errors, which come between the bodies as time goes on.
double step_of(const Placed& a, const Motion& motion_a, const Placed& b, const Motion& motion_b,
               const glm::dvec3& normal, double growth, double gap, double limit) {
    if (is_half_space(a)) return step_of(b, motion_b, a, motion_a, -normal, growth, gap, limit);
    const Advance advance_a(a, motion_a, normal);
    if (is_half_space(b)) {
        const double closing = glm::dot(-normal, motion_b.velocity) + growth;
        return safe_step([&](double s) { return advance_a(s) + s * closing; }, gap, limit);
    }
    const Advance advance_b(b, motion_b, -normal);
    return safe_step([&](double s) { return advance_a(s) + advance_b(s) + s * growth; }, gap, limit);
}

// As `distance`, where the bounds need not be close: a tenth of the distance, or the tolerance for a hit.
Distance rough_distance(const Placed& a, const Placed& b, double tolerance, PairCache& cache) {
    if (is_half_space(a) || is_half_space(b)) return distance(a, b);
    const Pair pair(a, b);
    const double rounding = a.body.radius() + b.body.radius();
    Nearest core = nearest_points(pair, &cache, rounding + 0.5 * tolerance, HUGE_VAL);
    const bool hit = core.upper <= rounding + 0.5 * tolerance;
    if (!hit && !(core.upper - core.lower <= 0.1 * (core.lower - rounding)))
        core = core_distance(pair, &cache, 0.0, HUGE_VAL);
    remember(core, &cache);
    return distance_of(pair, core);
}

}  // namespace

RigidTransform moved(const RigidTransform& pose, const Motion& motion, double time) {
    const double rate = glm::length(motion.spin);
    RigidTransform result = pose;
    const glm::dvec3 shift = time * motion.velocity;
    if (rate > 0.0) {
        const glm::dvec3 u = motion.spin / rate;
        const glm::dvec2 turn = cosine_sine(rate * time);
        const auto rotate = [&](const glm::dvec3& v) {
            return turn.x * v + turn.y * glm::cross(u, v) + ((1.0 - turn.x) * glm::dot(u, v)) * u;
        };
        for (int k = 0; k < 3; ++k) result.rotation[k] = rotate(pose.rotation[k]);
        result.translation += pose.rotation * motion.pivot - result.rotation * motion.pivot;
    }
    result.translation += shift;
    return result;
}

Result<Impact> cast(const Placed& a, const Motion& motion_a, const Placed& b, const Motion& motion_b,
                    const CastOptions& options, PairCache* cache) {
    if (Result<void> good = check(options); !good) return tl::unexpected(good.error());
    if (Result<void> good = check(motion_a, options, 0); !good) return tl::unexpected(good.error());
    if (Result<void> good = check(motion_b, options, 1); !good) return tl::unexpected(good.error());
    const bool a_turns = is_unbounded(a) && motion_a.spin != glm::dvec3(0.0);
    if (a_turns || (is_unbounded(b) && motion_b.spin != glm::dvec3(0.0)))
        return fail(ErrorCode::unsupported, a_turns ? 0 : 1, "cast: a half-space cannot turn; turn the other");
    if (is_unbounded(a) && is_unbounded(b))
        return fail(ErrorCode::unsupported, 1, "cast: two half-spaces; ask `distance` at the two times");
    if (!a.body.is_convex()) return cast_parts(a, motion_a, b, motion_b, options, 0.0);
    if (!b.body.is_convex()) {
        Impact impact = cast_parts(b, motion_b, a, motion_a, options, 0.0);
        impact.normal = -impact.normal;
        std::swap(impact.on_a, impact.on_b);
        std::swap(impact.part_a, impact.part_b);
        return impact;
    }
    return advance(a, motion_a, b, motion_b, options, 0.0, cache);
}

// All is asked in a frame that flies with a, from where a's origin stands at time 0. Far from the world's origin, or
// where both fly fast, places in the world lack the digits that decide.
Impact advance(const Placed& a, const Motion& motion_a, const Placed& b, const Motion& motion_b,
               const CastOptions& options, double start, PairCache* cache) {
    PairCache own;
    if (cache == nullptr) cache = &own;
    const RigidTransform start_a{a.pose.rotation, glm::dvec3(0.0)},
        start_b{b.pose.rotation, b.pose.translation - a.pose.translation};
    const Motion turn_a{glm::dvec3(0.0), motion_a.spin, motion_a.pivot},
        way_b{motion_b.velocity - motion_a.velocity, motion_b.spin, motion_b.pivot};
    const PathError error_a = path_error(a, turn_a), error_b = path_error(b, way_b);
    const double growth = error_a.growth + error_b.growth;
    Impact impact;
    impact.time = start;
    for (impact.steps = 1;; ++impact.steps) {
        const RigidTransform pose_a = moved(start_a, turn_a, impact.time), pose_b = moved(start_b, way_b, impact.time);
        const Placed now_a{a.body, pose_a}, now_b{b.body, pose_b};
        const Distance d = rough_distance(now_a, now_b, options.tolerance, *cache);
        impact.distance = d.distance;
        // A step may end where they just touch: the direction is then the one that parted them.
        if (d.normal != glm::dvec3(0.0) || impact.time == 0.0)
            impact.normal = d.normal;
        else if (impact.steps == 1)
            impact.normal = penetration(now_a, now_b).normal;
        const glm::dvec3 way_a = impact.time * motion_a.velocity;
        impact.on_a = a.pose.translation + (d.on_a + way_a);
        impact.on_b = a.pose.translation + (d.on_b + way_a);
        const double error = error_a.at_start + error_b.at_start + growth * impact.time;
        const double gap = (d.lower - error) * (1.0 - 0x1p-40);
        if (d.distance < options.tolerance || !(gap > 0.0)) {
            impact.result = CastResult::hit;
            return impact;
        }
        if (impact.steps > options.max_steps) {
            impact.result = CastResult::unresolved;
            return impact;
        }
        const double left = options.duration - impact.time;
        const double step = step_of(now_a, turn_a, now_b, way_b, d.normal, growth, gap, left);
        if (step >= left) break;                  // the whole rest is safe
        if (impact.time + step == impact.time) {  // the gap closes within a rounding of the time
            impact.result = CastResult::hit;
            return impact;
        }
        impact.time += step;
    }
    impact.time = options.duration;
    impact.result = CastResult::miss;
    return impact;
}

}  // namespace crofton::convex
