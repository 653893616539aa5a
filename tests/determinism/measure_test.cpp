// SPDX-License-Identifier: MIT
// Measures and random motions in the same bits everywhere.
#include <crofton/measure/measure.hpp>
#include <crofton/sampling/sampling.hpp>
#include <crofton/study/convex_body.hpp>
#include <crofton/study/planar_bounds.hpp>
#include <crofton/study/planar_lines.hpp>
#include <crofton/study/spatial_lines.hpp>

#include "crowd.hpp"
#include "digest.hpp"
#include "everywhere.hpp"

using namespace crofton;
using namespace crofton::test;

namespace {

std::uint64_t in_space() {
    Digest digest;
    Random random(61);
    for (int trial = 0; trial < 20; ++trial) {
        const Camera camera = random_camera(random, 0.0);
        const auto volumes = *measure::intrinsic_volumes_of_frustum(camera);
        const auto criterion = *measure::for_frustum(camera);
        digest.add(volumes.volume).add(volumes.area).add(volumes.mean_curvature);
        digest.add(criterion.volume_weight).add(criterion.area_weight).add(criterion.mean_curvature_weight);
        std::vector<glm::dvec3> points;
        for (int i = 0; i < 60; ++i) points.push_back(sampling::ball_point(random.point<3>()));
        const auto hull = *measure::intrinsic_volumes_of_hull(points);
        digest.add(hull.volume).add(hull.area).add(hull.mean_curvature);
    }
    const std::vector<study::ConvexBody> bodies{study::ConvexBody::sphere(glm::dvec3(0.0), 1.0),
                                                study::ConvexBody::box(random_box(random, glm::dvec3(0.25), 0.0, 4.0))};
    const auto planes = *study::measure_of_planes_hitting_all(bodies),
               lines = *study::measure_of_lines_hitting_all(bodies);
    return digest.add(planes.value).add(planes.error).add(lines.value).add(lines.error).value();
}

std::uint64_t in_the_plane() {
    Digest digest;
    Random random(62);
    std::vector<Disc> discs;
    std::vector<study::PlanarSupport> figures;
    for (int i = 0; i < 4; ++i) {
        discs.push_back({0.5 * sampling::disc_point(random.point<2>()), random.uniform(0.6, 1.0)});
        figures.push_back(study::PlanarSupport(discs.back()));
    }
    digest.add(study::measure_of_lines_hitting_all(figures)).add(study::measure_of_lines_by_tangents(discs));
    std::vector<glm::dvec2> object;
    for (int i = 0; i < 20; ++i) object.push_back(0.5 * sampling::disc_point(random.point<2>()));
    const study::PlanarSupport ancestor(Disc{{0.0, 0.0}, 2.0});
    const auto disc = *study::optimal_disc(object, ancestor);
    const auto rectangle = *study::optimal_rectangle(object, ancestor);
    digest.add(disc.bound.center).add(disc.bound.radius).add(disc.measure);
    return digest.add(rectangle.measure).add(rectangle.lower_bound).value();
}

}  // namespace

TEST_SUITE("determinism/measure") {
    TEST_CASE("intrinsic volumes, criteria and quadratures are the same bits everywhere") {
        check_everywhere(0xe817129d514e037f, [](Executor&) { return in_space(); });
        check_everywhere(0x1c0f8866f726733a, [](Executor&) { return in_the_plane(); });
    }
}
