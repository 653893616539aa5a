// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <hwy/highway.h>
#include <algorithm>
#include <cmath>
#include <crofton/core/executor.hpp>
#include <crofton/lines/lines.hpp>
#include <error_of.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "../../study/radiosity/shapes.hpp"

using namespace crofton;
using namespace crofton::lines;

namespace {

// By signed volumes in double: t, or NaN where the line misses.
double crossing(const TriangleMesh& mesh, std::size_t t, const Line& line) {
    const glm::dvec3 a(mesh.positions[mesh.indices[3 * t]]), b(mesh.positions[mesh.indices[3 * t + 1]]),
        c(mesh.positions[mesh.indices[3 * t + 2]]);
    const auto side = [&](const glm::dvec3& p, const glm::dvec3& q) {
        return glm::dot(line.direction, glm::cross(p - line.point, q - line.point));
    };
    const double x = side(a, b), y = side(b, c), z = side(c, a);
    if (!((x > 0 && y > 0 && z > 0) || (x < 0 && y < 0 && z < 0))) return std::numeric_limits<double>::quiet_NaN();
    const glm::dvec3 n = glm::cross(b - a, c - a);
    return glm::dot(a - line.point, n) / glm::dot(line.direction, n);
}

}  // namespace

TEST_SUITE("lines/line_tracer") {
    TEST_CASE("invalid and empty meshes are refused") {
        CHECK(error_of(LineTracer::build({})).code == ErrorCode::empty);
        TriangleMesh mesh = shapes::soup(3, 1.0f, 1);
        mesh.indices[4] = 99;
        CHECK(error_of(LineTracer::build(mesh)).code == ErrorCode::out_of_range);
        mesh = shapes::soup(3, 1.0f, 1);
        mesh.positions[5].y = std::numeric_limits<float>::quiet_NaN();
        CHECK(error_of(LineTracer::build(mesh)).item == 5);
    }

    TEST_CASE("a million identical triangles make a tree, and a line through them meets each") {
        TriangleMesh mesh;
        mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
        for (int i = 0; i < 100'000; ++i) mesh.indices.insert(mesh.indices.end(), {0, 1, 2});
        const auto tracer = LineTracer::build(mesh).value();
        LineHits hits;
        const Line line{{0.2, 0.2, -5.0}, {0.0, 0.0, 1.0}};
        tracer.all_hits({&line, 1}, hits);
        REQUIRE(hits.hits.size() == 100'000);
        CHECK(std::is_sorted(hits.hits.begin(), hits.hits.end(),
                             [](const Hit& a, const Hit& b) { return a.triangle < b.triangle; }));
    }

    TEST_CASE("lines along an axis and in a face's plane do not break the boxes' arithmetic") {
        shapes::Shape room;
        room.room({0, 0, 0}, {2, 2, 2}, 0);
        const auto tracer = LineTracer::build(room.mesh).value();
        for (int axis = 0; axis < 3; ++axis) {
            Line line{{0.7, 0.9, 0.6}, glm::dvec3(0.0)};
            line.direction[axis] = 1.0;
            LineHits hits;
            tracer.all_hits({&line, 1}, hits);
            REQUIRE(hits.hits.size() == 2);
            CHECK_FALSE(hits.hits[0].front);  // it enters through the back of a wall that looks inward
            CHECK(hits.hits[1].front);
            CHECK(hits.hits[1].t - hits.hits[0].t == doctest::Approx(2.0));
        }
    }

    TEST_CASE("all crossings agree with brute force in double on random triangles of several sizes") {
        for (const float size : {0.02f, 0.2f, 1.5f}) {
            const TriangleMesh mesh = shapes::soup(3000, size, 7);
            const auto tracer = LineTracer::build(mesh).value();
            const sampling::UnitPoints points(3);
            std::vector<Line> lines;
            for (std::uint64_t i = 0; i < 300; ++i)
                lines.push_back(sampling::line_through_disc({glm::dvec3(0.0), 2.0}, points.at<4>(i)));
            LineHits hits;
            tracer.all_hits(lines, hits);
            REQUIRE(hits.ends.size() == lines.size());
            std::size_t differences = 0, total = 0;
            std::uint32_t begin = 0;
            for (std::size_t l = 0; l < lines.size(); ++l) {
                std::vector<std::uint32_t> ours, truth;
                for (std::uint32_t h = begin; h < hits.ends[l]; ++h) {
                    const Hit& hit = hits.hits[h];
                    ours.push_back(hit.triangle);
                    const double t = crossing(mesh, hit.triangle, lines[l]);
                    if (!std::isnan(t)) CHECK(std::abs(static_cast<double>(hit.t) - t) < 2e-3);
                    if (h > begin) CHECK(hits.hits[h - 1].t <= hit.t + 4e-6f);
                }
                begin = hits.ends[l];
                for (std::uint32_t t = 0; t < 3000; ++t)
                    if (!std::isnan(crossing(mesh, t, lines[l]))) truth.push_back(t);
                std::sort(ours.begin(), ours.end());
                std::vector<std::uint32_t> apart;
                std::set_symmetric_difference(ours.begin(), ours.end(), truth.begin(), truth.end(),
                                              std::back_inserter(apart));
                differences += apart.size();
                total += truth.size();
            }
            CHECK(differences <= 2 + total / 10'000);
        }
    }

    TEST_CASE("lines near each other, which go through the tree together, have the bits they have alone") {
        sampling::Random random(17);
        for (const float size : {0.03f, 0.3f, 1.5f}) {
            const TriangleMesh mesh = shapes::soup(3000, size, 8);
            const auto tracer = LineTracer::build(mesh).value();
            std::size_t crossings = 0;
            for (int round = 0; round < 60; ++round) {
                // From parallel lines at nearly one place to lines that have nothing in common, some from far away and
                // some along an axis.
                const double wide = std::exp2(-random.uniform(0.0, 14.0)),
                             apart = std::exp2(-random.uniform(0.0, 14.0));
                const double far = round % 5 == 0 ? 1000.0 : 0.0;
                glm::dvec3 middle = sampling::direction(random.point<2>());
                if (round % 3 == 0) middle = {round % 2 ? 1.0 : 0.0, round % 2 ? 0.0 : 1.0, 0.0};
                const glm::dvec3 at = sampling::ball_point(random.point<3>());
                std::vector<Line> lines;
                for (int i = 0; i < 64; ++i) {
                    glm::dvec3 direction = middle + wide * sampling::ball_point(random.point<3>());
                    if (round % 3 == 0 && i % 4 == 0) direction = middle;
                    direction = glm::normalize(direction);
                    lines.push_back(
                        {at + apart * sampling::ball_point(random.point<3>()) - far * direction, direction});
                }
                LineHits together, alone;
                tracer.all_hits(lines, together);
                REQUIRE(together.ends.size() == 64);
                for (std::size_t i = 0, first = 0; i < 64; first = together.ends[i], ++i) {
                    tracer.all_hits({&lines[i], 1}, alone);
                    REQUIRE(together.ends[i] - first == alone.hits.size());
                    for (std::size_t h = 0; h < alone.hits.size(); ++h) {
                        REQUIRE(together.hits[first + h].t == alone.hits[h].t);
                        REQUIRE(together.hits[first + h].triangle == alone.hits[h].triangle);
                        REQUIRE(together.hits[first + h].front == alone.hits[h].front);
                    }
                    crossings += alone.hits.size();
                }
            }
            CHECK(crossings > 300);
        }
    }

    TEST_CASE("lines that all look the same way along each axis have the crossings they have among others") {
        const auto tracer = LineTracer::build(shapes::soup(3000, 0.3f, 10)).value();
        for (std::int64_t rest = hwy::SupportedTargets(); rest != 0; rest &= rest - 1) {
            hwy::SetSupportedTargetsForTest(rest & -rest);
            sampling::Random random(19);
            for (unsigned octant = 0; octant < 8; ++octant)
                for (const std::size_t count : {6u, 17u, 300u}) {
                    std::vector<Line> lines;
                    for (std::size_t i = 0; i < count; ++i) {
                        glm::dvec3 direction = glm::abs(sampling::direction(random.point<2>()));
                        for (int k = 0; k < 3; ++k)
                            if (octant >> k & 1u) direction[k] = -direction[k];
                        lines.push_back({sampling::ball_point(random.point<3>()), direction});
                    }
                    LineHits same, mixed;
                    tracer.all_hits(lines, same);
                    lines.push_back({glm::dvec3(0.0), -lines[0].direction});
                    tracer.all_hits(lines, mixed);
                    CHECK(same.hits.size() > 5 * count);
                    REQUIRE(mixed.hits.size() >= same.hits.size());
                    for (std::size_t i = 0; i < count; ++i) REQUIRE(same.ends[i] == mixed.ends[i]);
                    for (std::size_t h = 0; h < same.hits.size(); ++h) {
                        REQUIRE(same.hits[h].t == mixed.hits[h].t);
                        REQUIRE(same.hits[h].triangle == mixed.hits[h].triangle);
                    }
                }
        }
        hwy::SetSupportedTargetsForTest(0);
    }

    TEST_CASE("any number of lines in one call, more than go together too, have the bits they have alone") {
        sampling::Random random(18);
        const auto tracer = LineTracer::build(shapes::soup(3000, 0.3f, 9)).value();
        std::vector<Line> lines;
        std::vector<LineHits> alone;
        std::size_t most = 0;
        for (int i = 0; i < 9000; ++i) {
            // Now and then many the same: lists of every length at one leaf.
            if (i > 0 && random.uniform(0.0, 1.0) < 0.3)
                lines.push_back(lines.back());
            else
                lines.push_back({sampling::ball_point(random.point<3>()), sampling::direction(random.point<2>())});
            tracer.all_hits({&lines.back(), 1}, alone.emplace_back());
            most = std::max(most, alone.back().hits.size());
        }
        CHECK(most > 30);
        LineHits together;
        for (const std::size_t count : {0u, 1u, 2u, 3u, 4u, 5u, 7u, 8u, 9u, 33u, 4095u, 4096u, 4097u, 9000u}) {
            tracer.all_hits({lines.data(), count}, together);
            REQUIRE(together.ends.size() == count);
            for (std::size_t i = 0, first = 0; i < count; first = together.ends[i], ++i) {
                REQUIRE(together.ends[i] - first == alone[i].hits.size());
                for (std::size_t h = 0; h < alone[i].hits.size(); ++h) {
                    REQUIRE(together.hits[first + h].t == alone[i].hits[h].t);
                    REQUIRE(together.hits[first + h].triangle == alone[i].hits[h].triangle);
                    REQUIRE(together.hits[first + h].front == alone[i].hits[h].front);
                }
            }
        }
    }

    TEST_CASE("many lines that meet more than there is room for at first have all of their crossings") {
        TriangleMesh mesh;
        mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
        for (int i = 0; i < 900; ++i) mesh.indices.insert(mesh.indices.end(), {0, 1, 2});
        const auto tracer = LineTracer::build(mesh).value();
        const std::vector<Line> lines(130, Line{{0.2, 0.2, -5.0}, {0.0, 0.0, 1.0}});
        LineHits hits;
        tracer.all_hits(lines, hits);
        REQUIRE(hits.ends.size() == 130);
        for (std::size_t i = 0; i < 130; ++i) CHECK(hits.ends[i] == 900 * (i + 1));
    }

    TEST_CASE("the first crossing is the least positive one of all, the ray's own triangle left out") {
        const TriangleMesh mesh = shapes::soup(2000, 0.3f, 9);
        const auto tracer = LineTracer::build(mesh).value();
        const sampling::UnitPoints points(5);
        std::size_t compared = 0;
        for (std::uint64_t i = 0; i < 500; ++i) {
            Line line = sampling::line_through_disc({glm::dvec3(0.0), 1.0}, points.at<4>(i));
            LineHits all;
            tracer.all_hits({&line, 1}, all);
            std::vector<Hit> ahead;
            for (const Hit& hit : all.hits)
                if (hit.t > 0.0f) ahead.push_back(hit);
            FirstHitQuery ray{line, Hit::kNothing};
            Hit first;
            tracer.first_hits({&ray, 1}, {&first, 1});
            CHECK(first.triangle == (ahead.empty() ? Hit::kNothing : ahead[0].triangle));
            if (ahead.size() < 2) continue;
            ray.skip = ahead[0].triangle;
            tracer.first_hits({&ray, 1}, {&first, 1});
            CHECK(first.triangle == ahead[1].triangle);
            ++compared;
        }
        CHECK(compared > 100);
    }
}
