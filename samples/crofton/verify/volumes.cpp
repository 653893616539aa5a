// SPDX-License-Identifier: MIT
// The sharp rows on sections 1 and 2 of theory.md: formulas against volumes of sums of bodies, shadows and breadths.
#include <algorithm>
#include <cmath>
#include <crofton/geometry/mesh.hpp>
#include <crofton/measure/measure.hpp>
#include <crofton/sampling/sampling.hpp>
#include <crofton/study/convex_body.hpp>
#include <crofton/study/diameter.hpp>
#include <crofton/study/planar_support.hpp>
#include <crofton/study/query_distribution.hpp>
#include <crofton/study/spatial_lines.hpp>
#include <glm/geometric.hpp>
#include <numbers>

#include "geometry.hpp"
#include "topics.hpp"

namespace crofton::cli {
namespace {

using measure::IntrinsicVolumes;
using std::numbers::pi;

struct NamedSolid {
    const char* name;
    Corners3 corners;
    IntrinsicVolumes volumes;
};

const Corners3 kTetrahedron = {{0.0, 0.0, 0.0}, {1.0, 0.1, 0.0}, {0.2, 0.9, 0.1}, {0.3, 0.2, 0.7}};
const std::vector<std::uint32_t> kFaces = {0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2};

std::vector<NamedSolid> views() {
    return {{"a perspective frustum", frustum_body(1.0, 0.6, 0.1, 4.0, true).corners,
             frustum_volumes(1.0, 0.6, 0.1, 4.0, true)},
            {"an orthographic volume", frustum_body(1.5, 0.8, 0.0, 3.0, false).corners,
             frustum_volumes(1.5, 0.8, 0.0, 3.0, false)},
            {"a box, as a collision partner", box_body({0.5, 0.3, 1.0}).corners,
             measure::intrinsic_volumes_of_box(1.0, 0.6, 2.0)},
            {"a segment, as a ray", segment_body(3.0).corners, measure::intrinsic_volumes_of_segment(3.0)}};
}

std::vector<NamedSolid> objects() {
    return {{"a plate", box_body({1.2, 0.35, 0.025}).corners, measure::intrinsic_volumes_of_box(2.4, 0.7, 0.05)},
            {"a tetrahedron", kTetrahedron, *measure::intrinsic_volumes_of_polytope(kTetrahedron, kFaces)},
            {"a triangle", flat_body({{0.0, 0.0, 0.0}, {3.0, 0.0, 0.0}, {0.0, 4.0, 0.0}}).corners,
             measure::intrinsic_volumes_of_flat_polygon(6.0, 12.0)}};
}

VerifyRow row(std::string claim, const char* source, double predicted, const Mean& mean, double factor = 1.0) {
    // Where all batches agree, rounding is left.
    return measured_row(std::move(claim), source, predicted, factor * mean.value(),
                        std::max(std::abs(factor) * mean.standard_error(), 1e-6 * std::abs(predicted)));
}

// (1) and (2): for a given rotation B meets K wherever the sum of K and −B says.
void kinematic(const VerifyOptions& options, std::vector<VerifyRow>& rows) {
    std::uint64_t seed = options.seed * 1000 + 300;
    double by_faces = 0.0, by_hull = 0.0;
    for (const NamedSolid& b : views())
        for (const NamedSolid& k : objects()) {
            const Faceted first = faceted(b.corners), second = faceted(k.corners);
            // Thin bodies spread more.
            const Mean mean =
                mean_over_rotations(seed++, effort(options, first.volume > 0.0 ? 256 : 1024),
                                    [&](const glm::dmat3& turn) { return meeting_volume(first, second, turn); });
            const std::string pair = std::string(b.name) + " and " + k.name;
            rows.push_back(row("mean volume of the sum of " + pair, "theory.md (1)",
                               measure::kinematic_measure(b.volumes, k.volumes), mean));
            rows.push_back(measured_row("criterion for " + pair + ": its excess over the volume of B", "theory.md (2)",
                                        measure::for_partner(b.volumes)(k.volumes), mean.value() - first.volume,
                                        mean.standard_error()));
            sampling::Random random(options.seed, seed);
            for (int i = 0; i < 10; ++i) {
                const glm::dmat3 turn = sampling::rotation(random.point<3>());
                by_faces += meeting_volume(first, second, turn);
                by_hull += meeting_volume_by_hull(b.corners, k.corners, turn);
            }
        }
    rows.push_back(computed_row("volumes of sums: by faces and supports as by the hull of all sums of corners",
                                "Minkowski's mixed volumes", by_hull, by_faces, 1e-9 * by_hull));
}

// Section 1: Cauchy's formula and the mean breadth, for every function that gives F and M.
void cauchy(const VerifyOptions& options, std::vector<VerifyRow>& rows) {
    std::uint64_t seed = options.seed * 1000 + 330;
    std::vector<NamedSolid> solids = views();
    for (NamedSolid& k : objects()) solids.push_back(std::move(k));
    Corners3 hull_of = kTetrahedron;
    hull_of.emplace_back(0.3, 0.3, 0.2);  // inside
    solids.push_back({"the hull of five points", hull_of, *measure::intrinsic_volumes_of_hull(hull_of)});
    for (const NamedSolid& k : solids) {
        if (k.corners.size() > 2)
            rows.push_back(row(std::string("F of ") + k.name + ": 4 × the mean shadow", "theory.md section 1, Cauchy",
                               k.volumes.area,
                               mean_over_directions(seed++, effort(options, 64),
                                                    [&](const glm::dvec3& n) { return shadow_area(k.corners, n); }),
                               4.0));
        rows.push_back(row(std::string("M of ") + k.name + ": 2π × the mean breadth", "theory.md section 1, breadth",
                           k.volumes.mean_curvature,
                           mean_over_directions(seed++, effort(options, 64),
                                                [&](const glm::dvec3& n) { return breadth(k.corners, n); }),
                           2.0 * pi));
        if (k.volumes.volume > 0.0)
            rows.push_back(computed_row(std::string("V of ") + k.name + ": tetrahedra", "theory.md section 1",
                                        k.volumes.volume, hull_volume(k.corners), 1e-9 * k.volumes.volume));
    }
    const std::vector<NamedSolid> kept = objects();
    const Corners3& plate = kept[0].corners;
    rows.push_back(row(
        "measure of the lines that hit a plate: 2π × its mean shadow", "theory.md section 6, Crofton",
        sampling::measure_of_lines(kept[0].volumes.area),
        mean_over_directions(seed++, effort(options, 64), [&](const glm::dvec3& n) { return shadow_area(plate, n); }),
        2.0 * pi));
    study::ConvexBody body;
    body.points.assign(kTetrahedron.begin(), kTetrahedron.end());
    const auto by_planes = cauchy_mean_curvature(body);
    const auto by_shadows = cauchy_area(body);
    rows.push_back(computed_row("M of a tetrahedron: the integral over planes", "theory.md (4), one body",
                                kept[1].volumes.mean_curvature, by_planes->value, by_planes->error));
    rows.push_back(computed_row("F of a tetrahedron: the integral over shadows", "theory.md (5), one body",
                                kept[1].volumes.area, by_shadows->value, 2e-3 * kept[1].volumes.area));
}

// The densities of lines, planes and directions: counts and moments.
void densities(const VerifyOptions& options, std::vector<VerifyRow>& rows) {
    const std::uint64_t trials = 4 * options.trials;
    const sampling::UnitPoints points(options.seed * 1000 + 380);
    const glm::dvec3 half(0.6, 0.3, 0.2), axis = glm::normalize(glm::dvec3(1.0, -2.0, 0.5));
    const double radius = glm::length(half);
    std::uint64_t hits = 0;
    Mean first, second, fourth, cosine;
    for (std::uint64_t i = 0; i < trials; ++i) {
        const auto u = points.at<5>(i);
        const glm::dvec3 n = sampling::direction({u[0], u[1]});
        const double along = glm::dot(n, axis);
        first.add(std::abs(along));
        second.add(along * along);
        fourth.add(along * along * along * along);
        cosine.add(glm::dot(sampling::cosine_direction(axis, {u[3], u[4]}), axis));
        hits += std::abs(radius * (2.0 * u[2] - 1.0)) <= glm::dot(glm::abs(n), half);
    }
    const Share share = share_of(hits, trials);
    rows.push_back(measured_row("planes that hit a box, of those that hit its sphere: M",
                                "theory.md section 1, density of planes",
                                measure::intrinsic_volumes_of_box(1.2, 0.6, 0.4).mean_curvature,
                                4.0 * pi * radius * share.value, 4.0 * pi * radius * share.standard_error));
    const char* const source = "theory.md section 6, density of directions";
    rows.push_back(row("directions: mean |cosine| with an axis", source, 0.5, first));
    rows.push_back(row("directions: mean cosine² with an axis", source, 1.0 / 3.0, second));
    rows.push_back(row("directions: mean cosine⁴ with an axis", source, 0.2, fourth));
    rows.push_back(row("cosine-weighted directions: mean cosine", source, 2.0 / 3.0, cosine));
}

// Improper tests: differences of sums, and of what is left when the faces of B move inward.
void improper(const VerifyOptions& options, std::vector<VerifyRow>& rows) {
    // A long diagonal in a box: most that meets the one misses the other.
    const Corners3 bound = box_body({0.6, 0.4, 0.3}).corners, object = {{-0.6, -0.4, -0.3}, {0.6, 0.4, 0.3}};
    const IntrinsicVolumes b = measure::intrinsic_volumes_of_box(1.2, 0.8, 0.6),
                           o = *measure::intrinsic_volumes_of_hull(object);
    const Faceted faceted_bound = faceted(bound), faceted_object = faceted(object);
    std::uint64_t seed = options.seed * 1000 + 390;
    for (const NamedSolid& query : views()) {
        const Faceted moving = faceted(query.corners);
        rows.push_back(row(std::string("improper outside tests of ") + query.name, "theory.md section 2, m_o",
                           measure::improper_outside(query.volumes, b, o),
                           mean_over_rotations(seed++, effort(options, 2048), [&](const glm::dmat3& turn) {
                               return meeting_volume(moving, faceted_bound, turn) -
                                      meeting_volume(moving, faceted_object, turn);
                           })));
    }
    const double size = 1e5;
    const Body far = frustum_body(1.0, 0.6, 0.2 * size, size, true);
    rows.push_back(row("improper inside tests of a frustum of depth 100,000", "theory.md section 2, m_i",
                       measure::improper_inside(frustum_volumes(1.0, 0.6, 0.2 * size, size, true), b, o),
                       mean_over_rotations(seed++, effort(options, 512), [&](const glm::dmat3& turn) {
                           return containing_volume(far, object, turn) - containing_volume(far, bound, turn);
                       })));
}

// Section 3.4 of the paper: directions that are not uniform, by counting planes and lines.
void preferred(const VerifyOptions& options, std::vector<VerifyRow>& rows) {
    Obb box;
    box.axes = glm::mat3(sampling::rotation({0.2, 0.6, 0.9}));
    box.half_extents = glm::vec3(0.6f, 0.35f, 0.2f);
    const auto corner = corners(box);
    const Corners3 plain(corner.begin(), corner.end());
    const double half_width = 0.3;
    const auto band = study::QueryDistribution::band({0.0, 1.0, 0.0}, half_width);
    if (!band) return rows.push_back(untried_row("preferred directions", "theory.md section 2"));
    Mean planes, lines;
    constexpr std::uint64_t batches = 128;
    for (std::uint64_t batch = 0; batch < batches; ++batch) {
        const std::uint64_t seed = 1346 + 64 * sampling::seed_of_repetition(options.seed, batch, batches);
        const sampling::UnitPoints points(seed, sampling::Sequence::quasi_random);
        double breadths = 0.0, shadows = 0.0;
        for (std::uint64_t i = 0; i < 64; ++i) {
            const auto u = points.at<2>(i);
            const double y = std::sin(half_width) * (2.0 * u[0] - 1.0), r = std::sqrt(1.0 - y * y);
            const glm::dvec3 n(r * std::cos(2.0 * pi * u[1]), y, r * std::sin(2.0 * pi * u[1]));
            breadths += breadth(plain, n) / 64.0;
            shadows += shadow_area(plain, n) / 64.0;
        }
        planes.add(breadths), lines.add(shadows);
    }
    const char* const source = "theory.md section 2, preferred directions";
    rows.push_back(row("planes within 0.3 of upright that hit a box: weighted edges", source,
                       band->measure_of_planes(box), planes, 2.0 * pi));
    rows.push_back(row("lines within 0.3 of the horizon that hit a box: weighted faces", source,
                       band->measure_of_lines(box), lines, 2.0 * pi));
}

// The diameter is the largest breadth, found by walking uphill from many directions.
void diameters(const VerifyOptions& options, std::vector<VerifyRow>& rows) {
    sampling::Random random(options.seed, 31);
    Corners3 cloud;
    Figure flat;
    for (int i = 0; i < 60; ++i) {
        cloud.push_back(glm::dvec3(1.0, 0.7, 0.4) * sampling::ball_point(random.point<3>()));
        flat.push_back(glm::dvec2(1.0, 0.6) * sampling::disc_point(random.point<2>()));
    }
    study::ConvexBody body;
    body.points.assign(cloud.begin(), cloud.end());
    double largest = 0.0;
    for (int start = 0; start < 40; ++start) {
        glm::dvec3 n = sampling::direction(random.point<2>());
        for (int step = 0; step < 50; ++step) n = glm::normalize(support_point(body, n) - support_point(body, -n));
        largest = std::max(largest, study::breadth(body, n));
    }
    rows.push_back(computed_row("the diameter of 60 points in space is their largest breadth", "paper (2), breadth",
                                study::diameter(std::span<const glm::dvec3>(cloud))->length, largest, 1e-9));
    const auto support = *study::PlanarSupport::of_hull(flat);
    double widest = 0.0;
    for (int i = 0; i < 200'000; ++i) widest = std::max(widest, support.breadth(pi * i / 200'000));
    rows.push_back(computed_row("the diameter of 60 points in the plane is their largest breadth", "paper (2), breadth",
                                study::diameter(std::span<const glm::dvec2>(flat))->length, widest, 1e-9));
    rows.push_back(computed_row("the mean breadth in the plane is the perimeter over π", "paper (2), breadth",
                                measure::planar_measures_of_convex_polygon(*measure::convex_hull(flat)).perimeter / pi,
                                mean_over_angles([&](double phi) { return support.breadth(phi); }), 1e-6));
}

}  // namespace

std::vector<VerifyRow> volume_rows(const VerifyOptions& options) {
    std::vector<VerifyRow> rows;
    kinematic(options, rows);
    cauchy(options, rows);
    densities(options, rows);
    improper(options, rows);
    preferred(options, rows);
    diameters(options, rows);
    return rows;
}

}  // namespace crofton::cli
