// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <cmath>
#include <crofton/fit/fit.hpp>
#include <crofton/geometry/mesh.hpp>
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
        Obb ancestors[2];
        ancestors[1].half_extents.x = -1.0f;
        const auto refused = bound_given_ancestors(point, ancestors, queries, measure::minimal_area());
        CHECK(error_of(refused).item == 1);
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
                const auto result =
                    bound_given_ancestors(points, ancestors, queries, measure::minimal_perimeter(), {.max_cells = 50});
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

    TEST_CASE("no orientation has fewer hits than the certificate says, and more cells say more") {
        sampling::Random random(4);
        Camera camera;
        camera.far_distance = 10.0;
        const Sphere region{glm::dvec3(0.0), 3.0};
        const study::QuerySample samples[] = {*study::QuerySample::planes(region, 4096, 1),
                                              *study::QuerySample::lines(region, 4096, 1),
                                              *study::QuerySample::frusta(camera, region, 4096, 1)};
        std::vector<glm::dvec3> points;
        for (int i = 0; i < 20; ++i)
            points.push_back(glm::dvec3(1.0, 0.5, 0.2) * sampling::ball_point(random.point<3>()));
        const std::vector<Obb> ancestors = {
            *fit::fit_oriented(points, glm::mat3(sampling::rotation(random.point<3>())))};
        for (const auto& queries : samples) {
            const auto by = [&](std::uint64_t cells) {
                return *bound_given_ancestors(points, ancestors, queries, measure::minimal_perimeter(),
                                              {.tolerance = 0.0, .max_cells = cells});
            };
            const auto none = by(0), one = by(1), few = by(64), many = by(25000);
            // What one cell leaves open takes its eight parts, and theirs.
            CHECK(one.cells == 1);
            CHECK(one.lower_bound < one.hits);
            CHECK(few.cells >= 64);
            CHECK(few.cells < 64 + 8);
            CHECK(few.cells % 8 == 1);
            CHECK(none.lower_bound > 0);
            CHECK(none.lower_bound <= few.lower_bound);
            CHECK(few.lower_bound <= many.lower_bound);
            CHECK(many.lower_bound <= many.hits);
            CHECK(many.hits <= none.hits);
            CHECK(many.lower_bound > none.lower_bound);
            CHECK(many.lower_bound > 0.7 * many.hits);
            const auto reaching = queries.hitting(queries.all(), ancestors[0]);
            for (int turn = 0; turn < 300; ++turn) {
                const auto box = *fit::fit_oriented(points, glm::mat3(sampling::rotation(random.point<3>())));
                CHECK(queries.hitting(reaching, box).size() >= many.lower_bound);
            }
            CHECK(queries.hitting(reaching, many.bound).size() == many.hits);
        }
    }

    TEST_CASE("queries that surely hit a hull are those that hit every box around it, rays and planes exactly") {
        sampling::Random random(6);
        Camera camera;
        camera.far_distance = 10.0;
        const Sphere region{glm::dvec3(0.0), 3.0};
        const study::QuerySample samples[] = {*study::QuerySample::planes(region, 2048, 3),
                                              *study::QuerySample::lines(region, 2048, 3),
                                              *study::QuerySample::frusta(camera, region, 2048, 3)};
        // A box's own hull: exact but for frusta that no edge enters.
        for (int trial = 0; trial < 10; ++trial) {
            const Obb box{glm::dvec3(0.2, 0.1, 0.0), glm::mat3(sampling::rotation(random.point<3>())),
                          glm::vec3(1.0f, 0.5f, 0.25f)};
            const auto eight = corners(box);
            const std::vector<glm::dvec3> points(eight.begin(), eight.end());
            const auto hull = *convex_hull(std::span<const glm::dvec3>(points));
            for (std::size_t kind = 0; kind < 3; ++kind) {
                int missed = 0, hits = 0;
                for (std::uint32_t q = 0; q < samples[kind].size(); ++q) {
                    const bool sure = samples[kind].surely_hits(q, points, hull.triangles);
                    const bool truly = samples[kind].hits(q, box);
                    CHECK((!sure || truly));
                    hits += truly;
                    missed += truly && !sure;
                }
                CHECK(missed <= (kind == 2 ? hits / 4 : 0));
            }
        }
    }

    TEST_CASE("a query that surely hits a hull hits the box around it when the two barely touch") {
        sampling::Random random(7);
        Camera camera;
        camera.far_distance = 10.0;
        const Sphere region{glm::dvec3(0.0), 3.0};
        const study::QuerySample samples[] = {*study::QuerySample::planes(region, 256, 3),
                                              *study::QuerySample::lines(region, 256, 3),
                                              *study::QuerySample::frusta(camera, region, 256, 3)};
        for (std::size_t kind = 0; kind < 3; ++kind) {
            int edges = 0;
            for (std::uint32_t q = 0; q < samples[kind].size(); ++q) {
                Obb box{glm::dvec3(0.0), glm::mat3(sampling::rotation(random.point<3>())),
                        glm::vec3(1.0f, 0.5f, 0.25f)};
                const auto local = corners(box);
                const auto hull = *convex_hull(std::span<const glm::dvec3>(local));
                const glm::dvec3 way(random.uniform() - 0.5, random.uniform() - 0.5, random.uniform() - 0.5);
                const auto surely = [&](double along) {
                    box.center = along * way;
                    const auto eight = corners(box);
                    return samples[kind].surely_hits(q, eight, hull.triangles);
                };
                // From a place where it hits, if there is one, to one where it does not, until they are neighbours.
                double in = -10.0;
                while (in < 10.0 && !surely(in)) in += 0.25;
                if (in >= 10.0) continue;
                double out = 100.0;
                for (double middle = 0.5 * (in + out); middle != in && middle != out; middle = 0.5 * (in + out))
                    (surely(middle) ? in : out) = middle;
                ++edges;
                for (int step = 0; step < 64; ++step, in = std::nextafter(in, -100.0)) {
                    const bool sure = surely(in);
                    CHECK((!sure || samples[kind].hits(q, box)));
                }
            }
            CHECK(edges > 50);
        }
    }
}
