// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <crofton/fit/fit.hpp>
#include <crofton/sampling/sampling.hpp>
#include <crofton/study/bound_given_ancestors.hpp>
#include <error_of.hpp>
#include <vector>

using namespace crofton;
using namespace crofton::study;

TEST_SUITE("study/bound_given_ancestors") {
    TEST_CASE("no points and bad criteria are refused") {
        const auto queries = *study::QuerySample::planes({glm::dvec3(0.0), 1.0}, 64, 1);
        CHECK(error_of(bound_given_ancestors({}, {}, queries, measure::minimal_area())).code == ErrorCode::empty);
        const std::vector<glm::dvec3> point = {glm::dvec3(0.0)};
        CHECK_FALSE(bound_given_ancestors(point, {}, queries, {}).has_value());
    }

    TEST_CASE("it is never worse than the plain fit, and contains every point") {
        sampling::Random random(2);
        Camera camera;
        camera.far_distance = 10.0;
        const Sphere region{glm::dvec3(0.0), 3.0};
        const study::QuerySample samples[] = {*study::QuerySample::planes(region, 4096, 1),
                                              *study::QuerySample::lines(region, 4096, 1),
                                              *study::QuerySample::frusta(camera, region, 4096, 1)};
        int better = 0;
        for (int trial = 0; trial < 12; ++trial) {
            std::vector<glm::dvec3> points;
            for (int i = 0; i < 30; ++i)
                points.push_back(glm::dvec3(1.0, 0.5, 0.2) * sampling::ball_point(random.point<3>()));
            // A loose ancestor of another orientation, as an upper level has it.
            const std::vector<Obb> ancestors = {
                *fit::fit_oriented(points, glm::mat3(sampling::rotation(random.point<3>())))};
            for (const auto& queries : samples) {
                const auto result = bound_given_ancestors(points, ancestors, queries, measure::minimal_perimeter());
                REQUIRE(result.has_value());
                CHECK(result->hits <= result->plain_hits);
                CHECK(result->plain_hits <= result->ancestor_hits);
                for (const glm::dvec3& p : points) CHECK(contains(result->bound, p));
                CHECK(queries.hitting(queries.hitting(queries.all(), ancestors[0]), result->bound).size() ==
                      result->hits);
                better += result->hits < result->plain_hits;
            }
        }
        CHECK(better > 12);
    }
}
