// SPDX-License-Identifier: MIT
// The kinematic formula (1) and its likes: predicted measures of motions against counted ones.
#include <crofton/measure/measure.hpp>
#include <crofton/sampling/sampling.hpp>
#include <numbers>

#include "bodies.hpp"
#include "topics.hpp"

namespace crofton::cli {
namespace {

using measure::IntrinsicVolumes;
using measure::PlanarMeasures;

struct NamedBody {
    const char* name;
    Body body;
    IntrinsicVolumes volumes;
};

std::vector<NamedBody> frusta() {
    struct Lens {
        const char* name;
        double tan_x, tan_y, near, far;
        bool perspective;
    };
    constexpr Lens lenses[] = {{"a frustum (1, 0.6, near 0.1, far 10)", 1.0, 0.6, 0.1, 10.0, true},
                               {"a wide frustum", 2.0, 1.5, 0.5, 4.0, true},
                               {"a telescope's frustum", 0.05, 0.04, 1.0, 40.0, true},
                               {"a shallow frustum", 1.0, 1.0, 3.0, 3.2, true},
                               {"an orthographic volume", 3.0, 2.0, 0.0, 8.0, false},
                               {"a flat orthographic volume", 4.0, 0.1, 0.0, 6.0, false}};
    std::vector<NamedBody> result;
    for (const Lens& l : lenses)
        result.push_back({l.name, frustum_body(l.tan_x, l.tan_y, l.near, l.far, l.perspective),
                          frustum_volumes(l.tan_x, l.tan_y, l.near, l.far, l.perspective)});
    return result;
}

std::vector<NamedBody> bodies() {
    const std::vector<glm::dvec3> triangle = {{-1.0, -1.0, 0.0}, {2.0, -1.0, 0.0}, {-1.0, 1.5, 0.0}};
    const double perimeter = 3.0 + 2.5 + std::sqrt(9.0 + 6.25);
    return {{"a cube", box_body({0.5, 0.5, 0.5}), measure::intrinsic_volumes_of_box(1.0, 1.0, 1.0)},
            {"a needle", box_body({3.0, 0.05, 0.05}), measure::intrinsic_volumes_of_box(6.0, 0.1, 0.1)},
            {"a plate", box_body({1.2, 0.35, 0.025}), measure::intrinsic_volumes_of_box(2.4, 0.7, 0.05)},
            {"a sphere", sphere_body(0.8), measure::intrinsic_volumes_of_sphere(0.8)},
            {"a triangle", flat_body(triangle), measure::intrinsic_volumes_of_flat_polygon(0.5 * 3.0 * 2.5, perimeter)},
            {"a segment", segment_body(2.0), measure::intrinsic_volumes_of_segment(2.0)}};
}

// μ by counting.
VerifyRow counted(const NamedBody& b, const NamedBody& k, std::uint64_t trials, std::uint64_t seed) {
    const Placements placements(b.body, k.body);
    const sampling::UnitPoints points(seed);
    std::uint64_t hits = 0;
    for (std::uint64_t i = 0; i < trials; ++i) hits += meet(moved(b.body, placements.motion(points.at<6>(i))), k.body);
    const Share share = share_of(hits, trials);
    return measured_row(std::string("motions of ") + b.name + " that hit " + k.name, "theory.md (1)",
                        measure::kinematic_measure(b.volumes, k.volumes), placements.measure() * share.value,
                        placements.measure() * share.standard_error);
}

VerifyRow counted(const char* claim, const Figure& b, const Figure& k, std::uint64_t trials, std::uint64_t seed) {
    const auto measures = [](const Figure& f) { return measure::planar_measures_of_convex_polygon(f); };
    const double half_side = 6.0;
    const sampling::UnitPoints points(seed);
    std::uint64_t hits = 0;
    for (std::uint64_t i = 0; i < trials; ++i)
        hits +=
            meet(moved(b, sampling::planar_motion(glm::dvec2(-half_side), glm::dvec2(half_side), points.at<3>(i))), k);
    const double all = 4.0 * half_side * half_side;
    const Share share = share_of(hits, trials);
    return measured_row(claim, "theory.md (1), in the plane", measure::kinematic_measure(measures(b), measures(k)),
                        all * share.value, all * share.standard_error);
}

}  // namespace

std::vector<VerifyRow> kinematic_rows(const VerifyOptions& options) {
    std::vector<VerifyRow> rows;
    std::uint64_t seed = options.seed * 1000;
    for (const NamedBody& b : frusta())
        for (const NamedBody& k : bodies()) rows.push_back(counted(b, k, options.trials, seed++));

    const Figure wedge = {{0.0, 0.0}, {3.0, -1.0}, {3.0, 1.0}},
                 square = {{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}};
    const Figure segment = {{-1.0, 0.0}, {1.0, 0.0}}, sliver = {{-1.5, -0.01}, {1.5, -0.01}, {1.5, 0.01}, {-1.5, 0.01}};
    rows.push_back(counted("motions of a plane frustum that hit a square", wedge, square, options.trials, seed++));
    rows.push_back(counted("motions of a plane frustum that hit a sliver", wedge, sliver, options.trials, seed++));
    rows.push_back(counted("motions of a segment that hit a square", segment, square, options.trials, seed++));
    rows.push_back(
        counted("motions of a segment that hit a segment (Buffon)", segment, segment, options.trials, seed++));

    return rows;
}

}  // namespace crofton::cli
