// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <cmath>
#include <crofton/measure/measure.hpp>
#include <crofton/sampling/sampling.hpp>
#include <crofton/study/query_distribution.hpp>
#include <error_of.hpp>
#include <glm/geometric.hpp>
#include <numbers>
#include <vector>

using namespace crofton;
using std::numbers::pi;
using study::QueryDistribution;

namespace {

Obb turned_box(std::uint64_t seed) {
    sampling::Random random(23, seed);
    Obb box;
    box.axes = glm::mat3(sampling::rotation(random.point<3>()));
    box.half_extents =
        glm::vec3(glm::dvec3(random.uniform(0.1, 1.0), random.uniform(0.1, 1.0), random.uniform(0.1, 1.0)));
    return box;
}

}  // namespace

TEST_SUITE("study/query_distribution") {
    TEST_CASE("directions may have any length") {
        for (const double length : {0x1p-1060, 0x1p-530, 1.0, 0x1p600, 0x1p1021}) {
            const std::vector<glm::dvec3> one = {length * glm::dvec3(0.75, 1.0, 3.0)};
            const auto samples = QueryDistribution::samples(one).value();
            CHECK(samples.mean_cosine({0, 0, 1}) == doctest::Approx(12.0 / 13.0).epsilon(1e-14));
            const auto band = QueryDistribution::band(one[0], 0.2).value();
            CHECK(
                band.mean_cosine({0, 0, 1}) ==
                doctest::Approx(QueryDistribution::band({0.75, 1.0, 3.0}, 0.2)->mean_cosine({0, 0, 1})).epsilon(1e-14));
        }
    }

    TEST_CASE("flat bands, zero and NaN directions, and weights that do not add up are refused by name") {
        CHECK_FALSE(QueryDistribution::band({0, 0, 0}, 0.1).has_value());
        CHECK_FALSE(QueryDistribution::band({0, std::nan(""), 0}, 0.1).has_value());
        CHECK_FALSE(QueryDistribution::band({0, 1, 0}, 0.0).has_value());
        CHECK_FALSE(QueryDistribution::band({0, 1, 0}, 1.6).has_value());
        CHECK(error_of(QueryDistribution::samples({})).code == ErrorCode::empty);
        const std::vector<glm::dvec3> two = {{1, 0, 0}, {0, 0, 0}}, good = {{1, 0, 0}, {0, 2, 0}};
        CHECK(error_of(QueryDistribution::samples(two)).item == 1);
        const std::vector<double> one = {1.0}, negative = {1.0, -1.0}, zero = {0.0, 0.0}, huge = {1e308, 1e308};
        for (const auto* weights : {&one, &negative, &zero, &huge})
            CHECK(error_of(QueryDistribution::samples(good, *weights)).code == ErrorCode::invalid_argument);
        // Also where the others outweigh it.
        for (const double bad : {-1e-300, -0.5, -HUGE_VAL, HUGE_VAL, std::nan("")})
            for (std::size_t at = 0; at < 2; ++at) {
                std::vector<double> weights(2, 1.0);
                weights[at] = bad;
                const auto refused = QueryDistribution::samples(good, weights);
                CHECK(error_of(refused).code == ErrorCode::invalid_argument);
                CHECK(error_of(refused).item == at);
            }
        CHECK(error_of(QueryDistribution::of_views({})).code == ErrorCode::empty);
        std::vector<Camera> cameras(2);
        cameras[1].far_distance = HUGE_VAL;
        CHECK(error_of(QueryDistribution::of_views(cameras)).item == 1);
        CHECK_FALSE(study::fit_box_for({}, {}, study::QueryKind::planes).has_value());
    }

    TEST_CASE("uniform directions give M, and pi F / 2") {
        const QueryDistribution uniform;
        const auto whole = QueryDistribution::band({1, 2, 3}, 0.5 * pi);
        for (std::uint64_t seed = 0; seed < 20; ++seed) {
            const Obb box = turned_box(seed);
            const auto k = measure::intrinsic_volumes_of_box(box);
            for (const QueryDistribution* d : {&uniform, &*whole}) {
                CHECK(d->measure_of_planes(box) == doctest::Approx(k.mean_curvature).epsilon(1e-3));
                CHECK(d->measure_of_lines(box) == doctest::Approx(0.5 * pi * k.area).epsilon(1e-3));
                CHECK(d->measure_of_planes(study::ConvexBody::box(box)) ==
                      doctest::Approx(k.mean_curvature).epsilon(1e-3));
            }
            // Without sampling, also for a box of rounded axes, and one that is grown (Steiner's formula).
            study::ConvexBody body = study::ConvexBody::box(box);
            CHECK(uniform.measure_of_planes(body) == doctest::Approx(k.mean_curvature).epsilon(1e-6));
            body.radius = 0.5;
            CHECK(uniform.measure_of_planes(body) == doctest::Approx(k.mean_curvature + 2.0 * pi).epsilon(1e-6));
        }
    }

    TEST_CASE("a narrow band sees a box's sides and not its top, one direction sees breadth and shadow") {
        Obb box;
        box.half_extents = glm::vec3(1.0f, 2.0f, 3.0f);
        const auto horizon = QueryDistribution::band({0, 1, 0}, 1e-3);
        // The mean of |cos| around the horizon is 2/π; upward it is 0.
        CHECK(horizon->mean_cosine({1, 0, 0}) == doctest::Approx(2.0 / pi).epsilon(1e-3));
        CHECK(horizon->mean_cosine({0, 1, 0}) < 1e-3);
        CHECK(horizon->measure_of_lines(box) == doctest::Approx(2.0 * pi * (24.0 + 8.0) * 2.0 / pi).epsilon(1e-2));
        const std::vector<glm::dvec3> one = {{0, 0, 5}};
        const auto along = QueryDistribution::samples(one);
        CHECK(along->measure_of_planes(box) == doctest::Approx(2.0 * pi * 6.0));
        CHECK(along->measure_of_lines(box) == doctest::Approx(2.0 * pi * 8.0));
    }

    TEST_CASE("formulas for boxes agree with counts of planes whose normals follow the samples") {
        sampling::Random random(24);
        std::vector<glm::dvec3> directions;
        std::vector<double> weights;
        for (int i = 0; i < 50; ++i) {
            directions.push_back(sampling::direction(random.point<2>()));
            weights.push_back(random.uniform());
        }
        const auto distribution = QueryDistribution::samples(directions, weights);
        double sum = 0.0;
        for (const double w : weights) sum += w;
        const Obb box = turned_box(5);
        const auto corner = corners(box);
        double hit = 0.0, all = 0.0;
        for (int i = 0; i < 200'000; ++i) {
            const auto pick = static_cast<std::size_t>(random.uniform() * 50.0);
            const double at = random.uniform(-2.0, 2.0);
            bool above = false, below = false;
            for (const glm::dvec3& p : corner) (glm::dot(p, directions[pick]) > at ? above : below) = true;
            all += weights[pick] / sum;
            if (above && below) hit += weights[pick] / sum;
        }
        CHECK(distribution->measure_of_planes(box) == doctest::Approx(2.0 * pi * 4.0 * hit / all).epsilon(1e-2));
    }

    TEST_CASE("fits hold every point, are never worse than the plain box, nor better than the hull") {
        for (std::uint64_t seed = 0; seed < 10; ++seed) {
            sampling::Random random(25, seed);
            std::vector<glm::dvec3> points;
            for (int i = 0; i < 9; ++i)
                points.push_back(glm::dvec3(1.0, 0.5, 0.2) * sampling::ball_point(random.point<3>()));
            const auto horizon = QueryDistribution::band({0, 1, 0}, 0.1);
            for (const auto kind : {study::QueryKind::planes, study::QueryKind::lines}) {
                const auto fitted = study::fit_box_for(points, *horizon, kind).value();
                CHECK(fitted.value <= fitted.plain_value * (1.0 + 1e-9));
                CHECK(fitted.value >= fitted.lower_bound);
                for (const glm::dvec3& p : points) CHECK(contains(fitted.box, p));
            }
        }
    }

    TEST_CASE("a path's views: faces by area, so a camera that never pitches has its top and bottom count as seen") {
        std::vector<Camera> cameras;
        for (int i = 0; i < 36; ++i) {
            Camera camera;
            camera.fov_y = 0.5;
            camera.forward = {std::cos(2.0 * pi * i / 36), 0.0, std::sin(2.0 * pi * i / 36)};
            camera.far_distance = 100.0;
            cameras.push_back(camera);
        }
        const auto views = QueryDistribution::of_views(cameras).value();
        // Around the vertical all horizontal directions are alike.
        CHECK(views.mean_cosine({1, 0, 0}) == doctest::Approx(views.mean_cosine({0, 0, 1})).epsilon(1e-6));
        CHECK(views.mean_cosine({0, 1, 0}) > views.mean_cosine({1, 0, 0}));
    }
}
