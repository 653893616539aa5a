// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <cmath>
#include <crofton/measure/measure.hpp>
#include <crofton/sampling/sampling.hpp>
#include <crofton/study/spatial_lines.hpp>
#include <error_of.hpp>
#include <glm/geometric.hpp>
#include <numbers>
#include <vector>

#include "direction_cells.hpp"

using namespace crofton;
using namespace crofton::measure;
using namespace crofton::sampling;
using namespace crofton::study;
using std::numbers::pi;

namespace {

ConvexBody box(const glm::dvec3& low, const glm::dvec3& high) {
    ConvexBody result;
    for (int i = 0; i < 8; ++i)
        result.points.emplace_back((i & 1 ? high : low).x, (i & 2 ? high : low).y, (i & 4 ? high : low).z);
    return result;
}

void check(const Result<Enclosure>& measured, double expected) {
    REQUIRE(measured.has_value());
    CHECK(std::abs(measured->value - expected) <= measured->error + 1e-12 * expected);
}

}  // namespace

TEST_SUITE("study/spatial_lines") {
    TEST_CASE("no body, a body without points, NaN and negative radii are named") {
        CHECK(error_of(measure_of_planes_hitting_all({})).code == ErrorCode::empty);
        std::vector<ConvexBody> bodies = {ConvexBody::sphere(glm::dvec3(0.0), 1.0), {}};
        CHECK(error_of(measure_of_lines_hitting_all(bodies)).item == 1);
        bodies[1] = ConvexBody::sphere(glm::dvec3(0.0, std::nan(""), 0.0), 1.0);
        CHECK(error_of(measure_of_lines_hitting_all(bodies)).code == ErrorCode::non_finite);
        bodies[1] = ConvexBody::sphere(glm::dvec3(0.0), -1.0);
        CHECK(error_of(measure_of_planes_hitting_all(bodies)).item == 1);
        for (const double far : {1e31, 1e200, 1.7e308}) {
            bodies[1] = ConvexBody::sphere(glm::dvec3(0.0), far);
            CHECK(error_of(measure_of_lines_hitting_all(bodies)).item == 1);
            bodies[1] = box(glm::dvec3(-far), glm::dvec3(far));
            CHECK(error_of(measure_of_lines_hitting_all(bodies)).code == ErrorCode::out_of_range);
            CHECK(error_of(measure_of_planes_hitting_all(bodies)).item == 1);
        }
    }

    TEST_CASE("small triangles of directions have weights that add up to their area") {
        for (const double size : {1e-3, 1e-4, 1e-5, 1e-6}) {
            Random random(1);
            for (int i = 0; i < 100; ++i) {
                const glm::dvec3 n = direction(random.point<2>());
                const auto [x, y] = orthonormal_frame(n);
                const DirectionTriangle t = {glm::normalize(n + size * x), glm::normalize(n + size * y),
                                             glm::normalize(n - size * (x + y))};
                const auto weights = linear_weights(t);
                const glm::dvec3 integral = weights[0] * t[0] + weights[1] * t[1] + weights[2] * t[2];
                const glm::dvec3 flat = 0.5 * glm::cross(t[1] - t[0], t[2] - t[0]);
                CHECK(glm::length(integral) == doctest::Approx(glm::length(flat)).epsilon(4.0 * size * size + 1e-9));
            }
        }
    }

    TEST_CASE("points and parallel segments: nothing hits them but what hits all") {
        const std::vector<ConvexBody> point = {ConvexBody::sphere(glm::dvec3(1.0, 2.0, 3.0), 0.0)};
        CHECK(std::abs(measure_of_planes_hitting_all(point)->value) < 1e-12);
        CHECK(measure_of_lines_hitting_all(point)->value == 0.0);
        const std::vector<ConvexBody> segment = {{{glm::dvec3(0.0), glm::dvec3(0.0, 3.0, 4.0)}, 0.0}};
        check(measure_of_planes_hitting_all(segment), intrinsic_volumes_of_segment(5.0).mean_curvature);
        CHECK(measure_of_lines_hitting_all(segment, {.tolerance = 1e-2, .max_cells = 2000})->value == 0.0);
    }

    TEST_CASE("many cells too small to change a rounded sum add up all the same") {
        const glm::dvec3 end(1e-9, 3e-10, 1.0);
        const std::vector<ConvexBody> segment = {{{glm::dvec3(0.0), end}, 0.0}};
        const auto m = measure_of_planes_hitting_all(segment, {.tolerance = 0.0, .max_cells = 300'000}).value();
        CHECK(std::abs(m.value - pi * glm::length(end)) <= m.error + 1e-13);
    }

    TEST_CASE("planes that hit one body have measure M, to the error promised") {
        check(cauchy_mean_curvature(ConvexBody::sphere(glm::dvec3(3.0, -1.0, 2.0), 1.5)),
              intrinsic_volumes_of_sphere(1.5).mean_curvature);
        const auto m = cauchy_mean_curvature(box(glm::dvec3(0.0), glm::dvec3(1.0, 2.0, 3.0)));
        check(m, 6.0 * pi);
        CHECK(m->error <= 1e-4 * 6.0 * pi);
        Camera camera;
        camera.near_distance = 1.0, camera.far_distance = 20.0;
        camera.forward = glm::dvec3(1.0, 0.3, -0.2);
        check(cauchy_mean_curvature(*ConvexBody::frustum(camera)),
              intrinsic_volumes_of_frustum(camera)->mean_curvature);
    }

    TEST_CASE("Cauchy: the mean shadow gives the surface area") {
        check(cauchy_area(box(glm::dvec3(0.0), glm::dvec3(1.0, 2.0, 3.0))), 22.0);
        CHECK(cauchy_area(box(glm::dvec3(0.0), glm::dvec3(1.0, 2.0, 3.0)))->value ==
              doctest::Approx(22.0).epsilon(2e-3));
        CHECK(cauchy_area(box(glm::dvec3(-0.5), glm::dvec3(0.5, 0.5, -0.5)))->value ==
              doctest::Approx(2.0).epsilon(5e-3));
        check(cauchy_area(ConvexBody::sphere(glm::dvec3(9.0), 2.0), {.tolerance = 3e-2}), 16.0 * pi);
        Camera camera;
        camera.near_distance = 1.0, camera.far_distance = 5.0;
        const auto f = cauchy_area(*ConvexBody::frustum(camera));
        check(f, intrinsic_volumes_of_frustum(camera)->area);
        CHECK(f->value == doctest::Approx(intrinsic_volumes_of_frustum(camera)->area).epsilon(2e-3));
    }

    TEST_CASE("planes that hit two bodies that meet have measure M1 + M2 - M_hull") {
        // Two boxes side by side that overlap: their hull is a box again.
        const std::vector<ConvexBody> two = {box(glm::dvec3(0.0), glm::dvec3(3.0, 1.0, 2.0)),
                                             box(glm::dvec3(2.0, 0.0, 0.0), glm::dvec3(5.0, 1.0, 2.0))};
        check(measure_of_planes_hitting_all(two), pi * (6.0 + 6.0 - 8.0));
        const std::vector<ConvexBody> nested = {box(glm::dvec3(0.0), glm::dvec3(1.0)),
                                                ConvexBody::sphere(glm::dvec3(0.5), 3.0)};
        check(measure_of_planes_hitting_all(nested), 3.0 * pi);
    }

    TEST_CASE("lines that hit two squares have the measure of their form factor times pi") {
        // Published values for unit squares, facing at distance 1 and perpendicular with a common edge.
        const auto square = [](const glm::dvec3& o, const glm::dvec3& u, const glm::dvec3& v) {
            return ConvexBody{{o, o + u, o + v, o + u + v}, 0.0};
        };
        const glm::dvec3 x(1.0, 0.0, 0.0), y(0.0, 1.0, 0.0), z(0.0, 0.0, 1.0), o(0.0);
        const std::vector<ConvexBody> facing = {square(o, x, y), square(z, x, y)},
                                      corner = {square(o, x, y), square(o, x, z)};
        const QuadratureOptions fine{.tolerance = 2e-2, .max_cells = 40000};
        const auto a = measure_of_lines_hitting_all(facing, fine), b = measure_of_lines_hitting_all(corner, fine);
        check(a, pi * 0.199825);
        CHECK(a->value == doctest::Approx(pi * 0.199825).epsilon(2e-3));
        check(b, pi * 0.200044);
        CHECK(b->value == doctest::Approx(pi * 0.200044).epsilon(2e-3));
    }

    TEST_CASE("the true value is never outside the error, even when cells run out at once") {
        Random random(3);
        for (int trial = 0; trial < 40; ++trial) {
            const glm::dvec3 size(random.uniform(), random.uniform(), 0.1 * random.uniform());
            Obb turned;
            turned.axes = glm::mat3(rotation(random.point<3>()));
            turned.half_extents = glm::vec3(size);
            turned.center = glm::dvec3(random.uniform(-1.0, 1.0), 0.3, 0.0);
            const IntrinsicVolumes k = intrinsic_volumes_of_box(turned);
            const std::vector<ConvexBody> bodies = {ConvexBody::box(turned),
                                                    ConvexBody::sphere(glm::dvec3(turned.center), 2.0)};
            for (const std::uint64_t cells : {4u, 16u, 100u, 1000u}) {
                const QuadratureOptions options{.tolerance = 0.0, .max_cells = cells};
                check(measure_of_planes_hitting_all(bodies, options), k.mean_curvature);
                check(measure_of_lines_hitting_all(bodies, options), 0.5 * pi * k.area);
            }
        }
    }
}
