// SPDX-License-Identifier: MIT
// cast: the first time at which two moving shapes touch. Checks the input and chooses between the ways to advance.
#include <algorithm>
#include <cmath>
#include <crofton/convex/query.hpp>
#include <crofton/convex/slides.hpp>
#include <crofton/geometry/trigonometry.hpp>

#include "contacts_at.hpp"
#include "core_query.hpp"
#include "part_cast.hpp"
#include "union_normals.hpp"

namespace crofton::convex {
namespace {

constexpr double kMaxTurn = 1e5;
constexpr double kSameSurface = 0.996, kAnyNormal = -2.0;  // cosines: of 5 degrees, less than any

bool finite(const glm::dvec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

Result<void> check(const Motion& motion, const CastOptions& options, std::uint64_t item) {
    if (!finite(motion.velocity) || !finite(motion.spin) || !finite(motion.pivot))
        return fail(ErrorCode::non_finite, item, "cast: a motion is NaN or infinite");
    if (!(glm::length(motion.spin) * options.duration <= kMaxTurn))
        return fail(ErrorCode::out_of_range, item,
                    "cast: a shape turns by more than 1e5 radians; shorten the duration");
    return {};
}

Result<void> check(const CastOptions& options) {
    if (!(options.duration >= 0.0 && options.duration < HUGE_VAL))
        return fail(ErrorCode::invalid_argument, kNoItem, "cast: the duration must be finite and not negative");
    if (!(options.tolerance > 0.0 && options.tolerance < HUGE_VAL))
        return fail(ErrorCode::invalid_argument, kNoItem, "cast: the tolerance must be above 0");
    if (!(options.early_out >= 0.0))
        return fail(ErrorCode::invalid_argument, kNoItem, "cast: early_out must be a time that is not negative");
    if (options.max_steps < 1) return fail(ErrorCode::invalid_argument, kNoItem, "cast: max_steps must be at least 1");
    return {};
}

Impact miss(const CastOptions& options) {
    Impact impact;
    impact.time = std::min(options.early_out, options.duration) + 0.0;  // never −0
    return impact;
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

namespace {

Impact cast_once(const ShapeAtPose& a, const Motion& motion_a, const ShapeAtPose& b, const Motion& motion_b,
                 const CastOptions& options, PairCache* cache, const ContactsAt* slide) {
    if (!a.shape.is_convex()) return cast_parts(a, motion_a, b, motion_b, options, 0.0, slide, false);
    if (!b.shape.is_convex()) {
        Impact impact = cast_parts(b, motion_b, a, motion_a, options, 0.0, slide, true);
        impact.normal = -impact.normal;
        std::swap(impact.on_a, impact.on_b);
        std::swap(impact.part_a, impact.part_b);
        return impact;
    }
    if (slide != nullptr && slide->passes(a, motion_a, b, motion_b, false)) return miss(options);
    return advance(a, motion_a, b, motion_b, options, 0.0, cache);
}

bool rests(const Motion& a, const Motion& b) {
    return a.velocity == b.velocity && a.spin == glm::dvec3(0.0) && b.spin == glm::dvec3(0.0);
}

}  // namespace

Result<Impact> cast(const ShapeAtPose& a, const Motion& motion_a, const ShapeAtPose& b, const Motion& motion_b,
                    const CastOptions& options, PairCache* cache) {
    return cast(a, motion_a, b, motion_b, options, Beside{}, cache);
}

Result<Impact> cast(const ShapeAtPose& a, const Motion& motion_a, const ShapeAtPose& b, const Motion& motion_b,
                    const CastOptions& options, const Beside& beside, PairCache* cache) {
    if (Result<void> good = check(options); !good) return good.error();
    if (Result<void> good = check(motion_a, options, 0); !good) return good.error();
    if (Result<void> good = check(motion_b, options, 1); !good) return good.error();
    const bool a_turns = is_unbounded(a) && motion_a.spin != glm::dvec3(0.0);
    if (a_turns || (is_unbounded(b) && motion_b.spin != glm::dvec3(0.0)))
        return fail(ErrorCode::unsupported, a_turns ? 0 : 1, "cast: a half-space cannot turn; turn the other");
    if (is_unbounded(a) && is_unbounded(b))
        return fail(ErrorCode::unsupported, 1,
                    "cast: two half-spaces are not supported; call `distance` at the two times");
    const Impact first = cast_once(a, motion_a, b, motion_b, options, cache, nullptr);
    const bool alone = a.shape.is_convex() && b.shape.is_convex() && beside.a.empty() && beside.b.empty();
    if (first.result == CastResult::miss || alone || rests(motion_a, motion_b) || options.duration == 0.0) return first;
    if (first.time == 0.0 && first.distance <= -options.tolerance) return first;
    const Mover mover_a{a, motion_a, beside.a}, mover_b{b, motion_b, beside.b};
    ContactsAt start(mover_a, mover_b, options, 0.0);
    const Impact impact = start.slides() ? cast_once(a, motion_a, b, motion_b, options, cache, &start) : first;
    if (impact.result != CastResult::hit || impact.distance <= -options.tolerance) return impact;
    if (impact.time == 0.0) return start.deepest(impact, kAnyNormal).value_or(miss(options));
    if (options.ignore_initial_overlaps) return impact;
    const double margin = 1e-3 * options.tolerance;
    if (!is_nearer_elsewhere(mover_a, mover_b, impact, margin, flush_tolerance(a, b))) return impact;
    ContactsAt at_hit(mover_a, mover_b, options, impact.time);
    if (!is_nearer_elsewhere(mover_a, mover_b, impact, margin, 0.0))
        return at_hit.deepest_over_crack().value_or(impact);
    // What it slides on may seem to come nearer, within rounding.
    return *at_hit.deepest(impact, start.slides() ? kSameSurface : kAnyNormal);
}

bool slides_along(const ShapeAtPose& shape, const Motion& motion, std::span<const ShapeAtPose> touched,
                  const CastOptions& options) {
    if (touched.empty()) return false;
    const Motion still;
    return ContactsAt({shape, motion, {}}, {touched[0], still, touched.subspan(1)}, options, 0.0).slides();
}

std::optional<Impact> touch_over_crack(const ShapeAtPose& shape, const Motion& motion, const ShapeAtPose& object,
                                       std::span<const ShapeAtPose> touched, const CastOptions& options) {
    const Motion still;
    return ContactsAt({shape, motion, {}}, {object, still, touched}, options, 0.0).deepest_over_crack();
}

}  // namespace crofton::convex
