// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/geometry/predicates.hpp>
#include <cstdio>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "convex_pairs.hpp"
#include "exact_shapes.hpp"
#include "shape_data.hpp"
#include "topics.hpp"

namespace crofton::cli {
namespace {

using convex::ShapeAtPose;

constexpr double kSceneOffsets[] = {0.0, 1e3, 1e7};  // in sizes

struct Tally {
    std::uint64_t cases = 0, wrong = 0, meeting = 0;
};

VerifyRow row_of(const std::string& claim, const char* source, const Tally& tally) {
    return none_row(claim, source, tally.cases, tally.wrong);
}

std::string at_offset(double offset) {
    char text[40];
    std::snprintf(text, sizeof text, " at %g sizes: ", offset);
    return text;
}

// No point of what a hull was built of lies outside.
VerifyRow hulls_hold_points(const ShapeData& data) {
    Tally tally;
    std::size_t larger = 0;
    for (std::size_t h = 0; h < data.hulls.size(); ++h) {
        const convex::Hull& hull = data.hulls[h];
        larger += hull.max_overshoot() > 0.0;
        const auto at = [&](std::size_t i) { return glm::dvec3(hull.vertices()[hull.triangles()[i]]); };
        for (std::size_t t = 0; t < hull.triangles().size(); t += 3)
            for (const glm::vec3& p : data.hull_points[h])
                tally.wrong += orientation(at(t), at(t + 1), at(t + 2), glm::dvec3(p)) < 0;
        tally.cases += data.hull_points[h].size();
    }
    return row_of(std::to_string(data.hulls.size()) + " hulls of meshes and pieces (" + std::to_string(larger) +
                      " of them cut to 256 corners, " + std::to_string(data.flat) + " flat): each holds all its points",
                  "exact orientations", tally);
}

VerifyRow hulls_that_touch(const ShapeData& data, double offset, const VerifyOptions& options) {
    const std::uint64_t pairs = std::max<std::uint64_t>(20, options.trials / 2000);
    ConvexPairs random(options.seed + 80 + static_cast<std::uint64_t>(std::log10(offset + 1.0)));
    Tally tally;
    for (; tally.cases < pairs; ++tally.cases) {
        const convex::Shape a = convex::Shape::hull(data.hulls[random.bits() % data.hulls.size()]);
        const convex::Shape b = convex::Shape::hull(data.hulls[random.bits() % data.hulls.size()]);
        const double size = a.core_radius() + b.core_radius();
        const double gap = size * std::pow(10.0, random.number(-12.0, -1.0)) * (tally.cases % 2 == 0 ? 1.0 : -1.0);
        const ConvexPairs::Pair pair = random.touching(a, b, gap, offset * data.size);
        const bool truth = meet_exactly(pair.placed_a(), pair.placed_b(), pair.normal);
        const bool apart = convex::distance(pair.placed_a(), pair.placed_b()).distance > 0.0;
        const bool deep = convex::penetration(pair.placed_a(), pair.placed_b()).overlapping;
        const bool has_points = convex::contact_manifold(pair.placed_a(), pair.placed_b()).count > 0;
        tally.wrong += (convex::intersects(pair.placed_a(), pair.placed_b()) != truth) + (apart == truth) +
                       (deep != truth) + (has_points != truth);
        tally.meeting += truth;
    }
    return row_of("these hulls," + at_offset(offset) + std::to_string(pairs) + " pairs with gaps of 1e-1 to 1e-12, " +
                      std::to_string(tally.meeting) + " meet; none wrong",
                  "planes, common points and separating axes in exact numbers", tally);
}

// Triangles of a surface that may be within `far` of a shape.
class TriangleTruth {
  public:
    TriangleTruth(const ShapeData& data, const ShapeAtPose& surface) : data_(data), surface_(surface) {}

    template <class Visit>
    void visit_near(const ShapeAtPose& shape, double far, Visit visit) const {
        const glm::dvec3 middle =
            glm::transpose(surface_.pose.rotation) * (shape.pose.translation - surface_.pose.translation);
        const double reach =
            (shape.shape.core_radius() + far) * (1.0 + 1e-5) + 1e-9 * (data_.size + glm::length(middle));
        for (const Triangle& t : data_.triangles) {
            const glm::dvec3 low = glm::min(glm::min(t[0], t[1]), t[2]), high = glm::max(glm::max(t[0], t[1]), t[2]);
            const glm::dvec3 gap = glm::max(glm::max(low - middle, middle - high), glm::dvec3(0.0));
            if (glm::dot(gap, gap) > reach * reach) continue;
            const convex::Shape part = *convex::Shape::triangle(glm::vec3(t[0]), glm::vec3(t[1]), glm::vec3(t[2]));
            if (!visit(ShapeAtPose{part, surface_.pose})) return;
        }
    }
    [[nodiscard]] bool meets(const ShapeAtPose& shape) const {
        bool met = false;
        visit_near(shape, 0.0, [&](const ShapeAtPose& part) {
            const convex::Distance d = convex::distance(part, shape);
            // Nearly all are apart, by the plane that their distance gives.
            met = !(d.distance > 0.0 && is_parted_by(part, shape, d.normal)) && meet_exactly(part, shape, d.normal);
            return !met;
        });
        return met;
    }
    // Lower and upper bounds of the distance, by all triangles that may be nearest.
    [[nodiscard]] std::array<double, 2> distance(const ShapeAtPose& shape, double far) const {
        std::array<double, 2> least{HUGE_VAL, HUGE_VAL};
        visit_near(shape, far, [&](const ShapeAtPose& part) {
            const convex::Distance d = convex::distance(part, shape);
            least = {std::min(least[0], d.lower), std::min(least[1], d.upper)};
            return true;
        });
        return least;
    }

  private:
    const ShapeData& data_;
    const ShapeAtPose& surface_;
};

// A box of 0.1 to 6 % of the surface's size, or one of the hulls if they are small.
convex::Shape probe_of(const ShapeData& data, ConvexPairs& random) {
    if (!data.hulls.empty() && random.bits() % 2 == 0) {
        const convex::Shape hull = convex::Shape::hull(data.hulls[random.bits() % data.hulls.size()]);
        if (hull.core_radius() < 0.1 * data.size) return hull;
    }
    const double scale = 0.5 * data.size * std::pow(10.0, random.number(-2.0, -1.0));
    const double x = random.number(0.1, 0.6), y = random.number(0.1, 0.6), z = random.number(0.1, 0.6);
    return *convex::Shape::box(glm::vec3(scale * glm::dvec3(x, y, z)));
}

// A probe that touches one triangle of the surface, but for a gap; and if `nearest`, none nearer than that.
ConvexPairs::Pair place_probe(const ShapeData& data, double gap, double offset, bool nearest, ConvexPairs& random) {
    const Triangle& t = data.triangles[random.bits() % data.triangles.size()];
    const convex::Shape part = *convex::Shape::triangle(glm::vec3(t[0]), glm::vec3(t[1]), glm::vec3(t[2]));
    const convex::Shape probe = probe_of(data, random);
    if (!nearest) return random.touching(part, probe, gap, offset);
    ConvexPairs::Pair pair = random.touching(part, probe, random.number(0.0, 0.3) * data.size, offset);
    const convex::Distance d = convex::distance({data.surface(), pair.pose_a}, pair.placed_b());
    pair.pose_b.translation -= (d.distance - gap) * d.normal;
    return pair;
}

VerifyRow surface_touched(const ShapeData& data, double offset, const VerifyOptions& options) {
    const std::uint64_t pairs = std::max<std::uint64_t>(20, options.trials / 4000);
    ConvexPairs random(options.seed + 90 + static_cast<std::uint64_t>(std::log10(offset + 1.0)));
    const convex::Shape whole = data.surface();
    Tally tally;
    for (; tally.cases < pairs; ++tally.cases) {
        const double gap = 0.1 * data.size * std::pow(10.0, random.number(-12.0, -1.0));
        const ConvexPairs::Pair pair =
            place_probe(data, tally.cases % 2 == 0 ? gap : -gap, offset * data.size, tally.cases % 4 < 2, random);
        const ShapeAtPose surface{whole, pair.pose_a}, probe = pair.placed_b();
        const TriangleTruth triangles(data, surface);
        const bool truth = triangles.meets(probe);
        const convex::Distance d = convex::distance(surface, probe);
        const bool has_points = convex::contact_manifold(surface, probe).count > 0;
        tally.wrong += (convex::intersects(surface, probe) != truth) + ((d.distance == 0.0) != truth);
        tally.wrong += has_points != truth;
        tally.meeting += truth;
        if (truth) continue;
        const std::array<double, 2> least = triangles.distance(probe, d.distance);
        const double error_bound = 1e-9 * (data.size + glm::length(pair.pose_b.translation - pair.pose_a.translation));
        tally.wrong += !(d.distance <= least[1] + error_bound && d.distance >= least[0] - error_bound);
    }
    return row_of(std::to_string(data.triangles.size()) + " triangles as one " +
                      (data.field ? "height field," : "mesh,") + at_offset(offset) + std::to_string(pairs) +
                      " shapes with gaps of 1e-2 to 1e-13, " + std::to_string(tally.meeting) +
                      " meet; none wrong, distances as of the nearest triangle",
                  "each triangle near it in exact numbers", tally);
}

// Shapes that fly at the surface: at no moment before the impact do they meet a triangle.
VerifyRow surface_hit(const ShapeData& data, const VerifyOptions& options) {
    constexpr int kMoments = 50;
    const std::uint64_t casts = std::max<std::uint64_t>(4, options.trials / 20'000);
    ConvexPairs random(options.seed + 95);
    const convex::Shape whole = data.surface();
    Tally tally;
    std::uint64_t hits = 0;
    for (std::uint64_t i = 0; i < casts; ++i) {
        const ConvexPairs::Pair pair = place_probe(data, 0.1 * data.size, 0.0, i % 2 == 0, random);
        const ShapeAtPose surface{whole, pair.pose_a}, probe = pair.placed_b();
        const double rate = random.number(0.0, 6.0);
        const convex::Motion motion{-0.3 * data.size * pair.normal, rate * random.direction(), {}};
        const double tolerance = 1e-6 * data.size;
        const auto impact = convex::cast(surface, {}, probe, motion, {.tolerance = tolerance});
        tally.wrong += !impact || impact->result == convex::CastResult::unresolved;
        if (!impact || impact->result == convex::CastResult::unresolved) continue;
        const TriangleTruth triangles(data, surface);
        const auto at = [&](double time) { return convex::moved(pair.pose_b, motion, time); };
        const bool hit = impact->result == convex::CastResult::hit;
        hits += hit;
        const double end = hit ? impact->time : 1.0;
        for (int k = 0; k < kMoments && end > 0.0; ++k, ++tally.cases) {
            const RigidTransform pose = at(end * (k + 0.5) / kMoments);
            tally.wrong += triangles.meets({pair.b, pose});
        }
        const RigidTransform last = at(end);
        tally.wrong += hit && triangles.distance({pair.b, last}, 2.0 * tolerance)[0] > tolerance;
    }
    return row_of(std::to_string(casts) + " casts of turning shapes at it, " + std::to_string(hits) +
                      " hits: none meets a triangle at " + std::to_string(kMoments) +
                      " moments before, and then one is within the tolerance",
                  "each triangle near it in exact numbers", tally);
}

}  // namespace

Result<std::vector<VerifyRow>> verify_collided_scene(const std::string& source, const assets::LoadOptions& which,
                                                     const VerifyOptions& options) {
    const auto data = read_shape_data(source, which);
    if (!data) return data.error();
    std::vector<VerifyRow> rows;
    if (!data->hulls.empty()) {
        rows.push_back(hulls_hold_points(*data));
        for (const double offset : kSceneOffsets) rows.push_back(hulls_that_touch(*data, offset, options));
    }
    for (const double offset : kSceneOffsets) rows.push_back(surface_touched(*data, offset, options));
    rows.push_back(surface_hit(*data, options));
    const std::string name = source.substr(source.find_last_of("/\\") + 1) + (which.map.empty() ? "" : " " + which.map);
    for (VerifyRow& row : rows) row.claim = name + ": " + row.claim;
    return rows;
}

}  // namespace crofton::cli
