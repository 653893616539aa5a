// SPDX-License-Identifier: MIT
// Convex shapes: yes or no, depth and casts, against numbers that are never rounded.
#include <algorithm>
#include <array>
#include <cmath>

#include "convex_pairs.hpp"
#include "exact_shapes.hpp"
#include "topics.hpp"

namespace crofton::cli {
namespace {

using convex::ShapeAtPose;

constexpr double kPairOffsets[] = {0.0, 1e3, 1e7};

// All shapes of one size, or each of its own.
enum class Sizes { one, any };

// Whether a and b meet, as each question tells that has a yes or no: alone, and with what a neighbouring pose has left.
// Returns how many of these answers are not the truth.
std::uint64_t wrong_answers(const ShapeAtPose& a, const ShapeAtPose& b, const RigidTransform& earlier, bool truth) {
    const ShapeAtPose before{b.shape, earlier};
    convex::PairCache cache, manifold_cache;
    (void)convex::intersects(a, before, &cache);
    (void)convex::contact_manifold(a, before, {}, &manifold_cache);
    const std::array answers{convex::intersects(a, b),
                             convex::intersects(a, b, &cache),
                             convex::distance(a, b).distance == 0.0,
                             convex::penetration(a, b).overlapping,
                             convex::contact_manifold(a, b).count > 0,
                             convex::contact_manifold(a, b, {}, &manifold_cache).count > 0};
    return static_cast<std::uint64_t>(std::count(answers.begin(), answers.end(), !truth));
}

VerifyRow yes_or_no(Sizes sizes, int decade, double offset, const VerifyOptions& options) {
    const std::uint64_t pairs = std::max<std::uint64_t>(20, options.trials / (sizes == Sizes::one ? 500 : 2000));
    ConvexPairs random(options.seed * 1000 + static_cast<std::uint64_t>(decade) * 10 + (offset > 0.0 ? 1 : 0) +
                       (offset > 1e5 ? 1 : 0) + (sizes == Sizes::one ? 0 : 500));
    std::uint64_t wrong = 0, meeting = 0;
    for (std::uint64_t i = 0; i < pairs; ++i) {
        const double gap = std::pow(10.0, -decade) * random.number(0.1, 1.0) * (i % 2 == 0 ? 1.0 : -1.0);
        const ConvexPairs::Pair pair =
            sizes == Sizes::one ? random.next(12, gap, offset) : random.next_of_sizes(12, gap, offset);
        const ShapeAtPose a = pair.placed_a(), b = pair.placed_b();
        RigidTransform earlier = pair.pose_b;
        earlier.translation += (sizes == Sizes::one ? 0.01 : 0.01 * pair.b.core_radius()) * random.direction();
        const bool truth = meet_exactly(a, b, pair.normal);
        wrong += wrong_answers(a, b, earlier, truth);
        meeting += truth;
    }
    char claim[200];
    std::snprintf(claim, sizeof claim,
                  sizes == Sizes::one
                      ? "convex shapes at %g m, gaps and overlaps of 1e-%d: %llu pairs, %llu meet; none wrong"
                      : "of sizes 1e-6 to 1e6 at %g m, 1e-%d of the larger: %llu pairs, %llu meet; none wrong",
                  offset, decade, static_cast<unsigned long long>(pairs), static_cast<unsigned long long>(meeting));
    return none_row(claim, "planes, common points and separating axes in exact numbers", pairs, wrong);
}

VerifyRow depths(const VerifyOptions& options) {
    const std::uint64_t pairs = std::max<std::uint64_t>(20, options.trials / 2000);
    ConvexPairs random(options.seed + 77);
    std::uint64_t wrong = 0, met = 0;
    for (std::uint64_t i = 0; i < pairs; ++i) {
        const double overlap = i % 3 == 0 ? 0.3 : std::pow(10.0, random.number(-12.0, -1.0));
        const ConvexPairs::Pair pair = random.next(6, -overlap, i % 5 == 0 ? 1e5 : 0.0);
        const ShapeAtPose a = pair.placed_a(), b = pair.placed_b();
        const convex::Penetration p = convex::penetration(a, b);
        if (!p.overlapping) {
            wrong += meet_exactly(a, b, pair.normal);
            continue;
        }
        ++met;
        const double size = pair.a.core_radius() + pair.b.core_radius() +
                            glm::length(pair.pose_b.translation - pair.pose_a.translation);
        wrong += !depth_lies_between(a, b, p.lower, p.upper) || p.upper - p.lower > 1e-9 * size;
    }
    return none_row("depths of overlaps of 0.3 and 1e-1 to 1e-12: " + std::to_string(met) +
                        " lie between their bounds, which differ by at most 1e-9 of the size",
                    "all faces of the Minkowski sum, in exact numbers", met, wrong);
}

ConvexPairs::Pair start_of(ConvexPairs& random, double offset) {
    ConvexPairs::Pair pair = random.next(8, random.number(0.2, 2.0), offset);
    pair.pose_b.translation += 0.3 * random.direction();
    return pair;
}

// No sample before the impact, or of a miss at all, has the shapes meet.
VerifyRow casts_sampled(const VerifyOptions& options) {
    constexpr int kSamples = 10'000;
    const std::uint64_t casts = std::max<std::uint64_t>(4, options.trials / 50'000);
    ConvexPairs random(options.seed + 78);
    std::uint64_t wrong = 0, hits = 0, unresolved = 0, samples = 0;
    for (std::uint64_t i = 0; i < casts; ++i) {
        const ConvexPairs::Pair pair = start_of(random, 0.0);
        const glm::dvec3 way = random.direction(), axis_a = random.direction(), axis_b = random.direction();
        const double rate_a = random.number(0.0, 9.0), rate_b = random.number(0.0, 9.0);
        const convex::Motion a{way, rate_a * axis_a, glm::dvec3(0.0)};
        const convex::Motion b{-4.0 * pair.normal, rate_b * axis_b, glm::dvec3(0.0)};
        const auto impact = convex::cast(pair.placed_a(), a, pair.placed_b(), b);
        wrong += !impact;
        unresolved += impact && impact->result == convex::CastResult::unresolved;
        if (!impact || impact->result == convex::CastResult::unresolved) continue;
        const bool hit = impact->result == convex::CastResult::hit;
        hits += hit;
        const double end = hit ? impact->time : 1.0;
        bool met_before = false;
        // Shapes that overlap from the start have no time before.
        for (int k = 0; k < kSamples && end > 0.0 && !met_before; ++k) {
            ++samples;
            const double time = end * (k + 0.5) / kSamples;
            const RigidTransform at_a = convex::moved(pair.pose_a, a, time), at_b = convex::moved(pair.pose_b, b, time);
            const ShapeAtPose there_a{pair.a, at_a}, there_b{pair.b, at_b};
            const glm::dvec3 normal = convex::distance(there_a, there_b).normal;
            met_before = !is_parted_by(there_a, there_b, normal) && meet_exactly(there_a, there_b, normal);
        }
        const RigidTransform at_a = convex::moved(pair.pose_a, a, end), at_b = convex::moved(pair.pose_b, b, end);
        const bool far = hit && convex::distance({pair.a, at_a}, {pair.b, at_b}).lower > 1e-6;
        wrong += met_before || far;
    }
    return none_row(std::to_string(casts) + " casts of turning shapes, " + std::to_string(hits) + " hits, " +
                        std::to_string(unresolved) +
                        " undecided: they overlap at none of 10,000 earlier times, and are then within 1e-6",
                    "separating planes in exact numbers", samples, wrong);
}

// Casts along translations. Finds the first contact by bisection between the impact and a time when the shapes overlap.
// Poses are not rounded.
VerifyRow casts_bisected(const VerifyOptions& options) {
    const std::uint64_t casts = std::max<std::uint64_t>(20, options.trials / 5000);
    ConvexPairs random(options.seed + 79);
    std::uint64_t wrong = 0, compared = 0;
    for (std::uint64_t i = 0; i < casts; ++i) {
        const ConvexPairs::Pair pair = start_of(random, kPairOffsets[i % std::size(kPairOffsets)]);
        const convex::Motion motion{-4.0 * pair.normal + 0.3 * random.direction(), glm::dvec3(0.0), glm::dvec3(0.0)};
        const auto impact = convex::cast(pair.placed_a(), {}, pair.placed_b(), motion);
        wrong += !impact;
        if (!impact) continue;
        const auto meet_at = [&](double time) {
            return meet_exactly(pair.placed_a(), pair.placed_b(), pair.normal, {motion.velocity, time});
        };
        double early = 0.0, late = -1.0;
        for (int k = 0; k <= 64 && late < 0.0; ++k)
            if (meet_at(k / 64.0)) late = k / 64.0;
        if (late < 0.0) continue;  // a hit may be a near miss: within the tolerance
        ++compared;
        for (int step = 0; step < 45; ++step) {
            const double middle = 0.5 * (early + late);
            (meet_at(middle) ? late : early) = middle;
        }
        wrong += impact->result != convex::CastResult::hit || impact->time > late;
    }
    return none_row(std::to_string(compared) +
                        " casts of translations, at 0, 1e3 and 1e7 m: none tells a later impact than bisection",
                    "bisection in exact numbers", compared, wrong);
}

// How far the shape reaches along a direction of the world.
double reach_along(const ShapeAtPose& shape, const glm::dvec3& direction) {
    const glm::dvec3 farthest = convex::support_point(shape.shape, glm::transpose(shape.pose.rotation) * direction);
    return glm::dot(direction, shape.pose.rotation * farthest + shape.pose.translation);
}

// Casts of every pair of kinds. At the impact, each point is in its shape, no point of the shape is farther along the
// normal, and the normal separates the shapes.
VerifyRow casts_points(const VerifyOptions& options) {
    const convex::Shape box = convex::Shape::box({0.4f, 0.7f, 0.3f}).value();
    const std::array shapes{
        box,
        convex::Shape::sphere(0.5).value(),
        convex::Shape::capsule(0.6f, 0.3f).value(),
        convex::Shape::rounded(box, 0.2).value(),
        convex::Shape::cylinder(0.5f, 0.4f).value(),
        convex::Shape::cone(0.5f, 0.4f).value(),
        convex::Shape::triangle({0.0f, 0.0f, 0.0f}, {1.0f, 0.2f, 0.0f}, {0.3f, 0.9f, 0.1f}).value()};
    constexpr double kTolerance = 1e-5;
    const std::uint64_t casts = std::max<std::uint64_t>(2, options.trials / 2000) * shapes.size() * shapes.size();
    ConvexPairs random(options.seed + 80);
    std::uint64_t wrong = 0, hits = 0;
    for (std::uint64_t i = 0; i < casts; ++i) {
        const convex::Shape &first = shapes[i % shapes.size()], &second = shapes[i / shapes.size() % shapes.size()];
        const ConvexPairs::Pair pair = random.touching(first, second, random.number(0.2, 2.0), 0.0);
        const convex::Motion a{0.2 * random.direction(), random.number(0.0, 1.0) * random.direction(), glm::dvec3(0.0)};
        const convex::Motion b{-4.0 * pair.normal, random.number(0.0, 1.0) * random.direction(), glm::dvec3(0.0)};
        const auto impact = convex::cast(pair.placed_a(), a, pair.placed_b(), b);
        wrong += !impact;
        if (!impact || impact->result != convex::CastResult::hit) continue;
        ++hits;
        const RigidTransform at_a = convex::moved(pair.pose_a, a, impact->time),
                             at_b = convex::moved(pair.pose_b, b, impact->time);
        const ShapeAtPose hit_a{pair.a, at_a}, hit_b{pair.b, at_b};
        const glm::dvec3& n = impact->normal;
        const double end_a = reach_along(hit_a, n), end_b = -reach_along(hit_b, -n);
        const bool is_right = std::fabs(glm::length(n) - 1.0) < 1e-9 && end_b - end_a > -kTolerance &&
                              std::fabs(glm::dot(n, impact->on_a) - end_a) < kTolerance &&
                              std::fabs(glm::dot(n, impact->on_b) - end_b) < kTolerance &&
                              convex::closest_point(hit_a, impact->on_a).distance < kTolerance &&
                              convex::closest_point(hit_b, impact->on_b).distance < kTolerance &&
                              std::fabs(glm::distance(impact->on_a, impact->on_b) - impact->distance) < kTolerance;
        wrong += !is_right;
    }
    return none_row("casts of seven kinds of shapes, " + std::to_string(hits) +
                        " hits: points on both surfaces, and a normal that parts them",
                    "support points", hits, wrong);
}

}  // namespace

std::vector<VerifyRow> verify_convex(const VerifyOptions& options) {
    std::vector<VerifyRow> rows;
    for (const Sizes sizes : {Sizes::one, Sizes::any})
        for (const double offset : kPairOffsets)
            for (int decade = 1; decade <= 12; ++decade) rows.push_back(yes_or_no(sizes, decade, offset, options));
    rows.push_back(depths(options));
    rows.push_back(casts_sampled(options));
    rows.push_back(casts_bisected(options));
    rows.push_back(casts_points(options));
    return rows;
}

}  // namespace crofton::cli
