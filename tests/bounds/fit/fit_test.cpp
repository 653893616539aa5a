// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <hwy/targets.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/fit/fit.hpp>
#include <error_of.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <oracle/edges.hpp>
#include <random>
#include <vector>

#include "random_rotation.hpp"

using namespace crofton;
using fit::Quality;

namespace {

constexpr Quality kQualities[] = {Quality::fast, Quality::tight, Quality::exact};

template <class Point>
std::span<const Point> view(const std::vector<Point>& points) {
    return points;
}

template <class Point>
bool contains_all(const Obb& box, const std::vector<Point>& points) {
    for (const Point& p : points)
        if (!contains(box, glm::dvec3(p))) return false;
    return true;
}

std::vector<glm::dvec3> box_points(std::mt19937& random, const glm::dvec3& half, std::size_t inner) {
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    std::vector<glm::dvec3> points;
    for (unsigned i = 0; i < 8; ++i)
        points.push_back(half * glm::dvec3(i & 1u ? 1.0 : -1.0, i & 2u ? 1.0 : -1.0, i & 4u ? 1.0 : -1.0));
    for (std::size_t i = 0; i < inner; ++i)
        points.push_back(half * glm::dvec3(unit(random), unit(random), unit(random)));
    return points;
}

}  // namespace

TEST_SUITE("fit/fit") {
    TEST_CASE("a flat triangle whose thickness is nothing but rounding is fitted at once") {
        // Single float steps up from zero to 1e-16 would be 10^9 exact tests.
        const std::array<glm::vec3, 3> points = {{{0, 0, 8}, {1, 0, 0}, {0, 1, 0}}};
        const auto box = fit::fit_obb(std::span<const glm::vec3>(points)).value();
        for (const glm::vec3& p : points) CHECK(contains(box, glm::dvec3(p)));
        CHECK(volume(box) < 1e-12);
    }

    TEST_CASE("no points, NaN, infinite or huge points are refused by their first index") {
        CHECK(error_of(fit::fit_obb(std::span<const glm::vec3>())).code == ErrorCode::empty);
        std::vector<glm::vec3> points(10, glm::vec3(1.0f));
        points[7].y = std::numeric_limits<float>::quiet_NaN();
        points[8].x = std::numeric_limits<float>::infinity();
        auto result = fit::fit_obb(view(points));
        REQUIRE(!result);
        CHECK(error_of(result).code == ErrorCode::non_finite);
        CHECK(error_of(result).item == 7);
        points[3].z = -std::numeric_limits<float>::infinity();
        CHECK(error_of(fit::fit_obb(view(points))).item == 3);
        points[1].z = 2e30f;
        CHECK(error_of(fit::fit_obb(view(points))).item == 1);
        CHECK(error_of(fit::fit_obb(view(points))).code == ErrorCode::out_of_range);
    }

    TEST_CASE("a criterion with no weight or a negative one is refused") {
        const std::vector<glm::vec3> points(3, glm::vec3(1.0f));
        CHECK(!fit::fit_obb(view(points), {measure::Criterion{0.0, 0.0, 0.0}}));
        CHECK(!fit::fit_obb(view(points), {measure::Criterion{1.0, -1.0, 0.0}}));
    }

    TEST_CASE("one point, however often, gives a box of no size at that point") {
        for (const Quality quality : kQualities)
            for (const std::size_t count : {1u, 2u, 100u}) {
                const std::vector<glm::dvec3> points(count, glm::dvec3(1e8 + 0.3, -7.1, 1e-9));
                const Obb box = fit::fit_obb(view(points), {.quality = quality}).value();
                CHECK(box.center == points[0]);
                CHECK(box.half_extents == glm::vec3(0.0f));
                CHECK(validate(box).has_value());
                CHECK(contains_all(box, points));
            }
    }

    TEST_CASE("a segment gives a box as long as the segment and no thicker than float axes allow") {
        std::mt19937 random(3);
        std::normal_distribution<double> normal;
        for (int run = 0; run < 50; ++run)
            for (const Quality quality : kQualities) {
                const glm::dvec3 a(normal(random), normal(random), normal(random)),
                    b(normal(random), normal(random), normal(random));
                std::vector<glm::dvec3> points;
                for (int i = 0; i <= 4; ++i) points.push_back(glm::mix(a, b, 0.25 * i));
                for (const measure::Criterion& criterion :
                     {measure::minimal_volume(), measure::minimal_area(), measure::minimal_perimeter()}) {
                    const Obb box = fit::fit_obb(view(points), {criterion, quality}).value();
                    CHECK(contains_all(box, points));
                    CHECK(edge_sum(box) <= glm::distance(a, b) * (1.0 + 1e-6));
                }
            }
    }

    TEST_CASE("a turned box is found again, whatever its proportions, its place and its scale") {
        std::mt19937 random(5);
        const glm::dvec3 shapes[] = {{1, 1, 1},       {3, 2, 1},       {1, 1, 0}, {1, 0.3, 1e-6},
                                     {1, 1e-3, 1e-6}, {1, 1e-6, 1e-6}, {1, 0, 0}};
        for (const glm::dvec3& half : shapes)
            for (const double scale : {1e-30, 1e-6, 1.0, 1e6, 1e28})
                for (const double offset : {0.0, scale > 1e20 ? 3.0 : 1e5, scale > 1e20 ? 9.0 : 1e8})
                    for (const Quality quality : kQualities) {
                        const glm::dmat3 turn = random_rotation(random);
                        // Few points are searched as a whole, many by their extreme points.
                        std::vector<glm::dvec3> points = box_points(random, half, random() % 2 == 0 ? 20 : 300);
                        for (glm::dvec3& p : points)
                            p = (turn * p + glm::dvec3(offset, -0.3 * offset, 0.1 * offset)) * scale;
                        const Obb box = fit::fit_obb(view(points), {measure::minimal_perimeter(), quality}).value();
                        INFO(half.x, " ", half.y, " ", half.z, " scale ", scale, " offset ", offset, " quality ",
                             int(quality));
                        CHECK(contains_all(box, points));
                        CHECK(validate(box).has_value());
                        CHECK(edge_sum(box) <=
                              2.0 * (half.x + half.y + half.z) * scale * (1.0 + 1e-6 + 2e-16 * offset * 4.0));
                    }
    }

    TEST_CASE(
        "needles are 0.45 % wider than they are, on average: the floats near an axis are tried for the least tilt") {
        // By simulation; axes rounded to the nearest floats would make it 0.8 %.
        std::mt19937 random(6);
        const glm::dvec3 half(1, 1e-6, 1e-6);
        for (const Quality quality : kQualities) {
            double excess = 0.0;
            for (int run = 0; run < 200; ++run) {
                const glm::dmat3 turn = random_rotation(random);
                std::vector<glm::dvec3> points = box_points(random, half, 20);
                for (glm::dvec3& p : points) p = turn * p;
                const Obb box = fit::fit_obb(view(points), {measure::minimal_area(), quality}).value();
                CHECK(contains_all(box, points));
                const glm::dvec3 found(box.half_extents);
                const double longest = std::max({found.x, found.y, found.z});
                excess += (found.x + found.y + found.z - longest) / 2e-6 - 1.0;
            }
            CHECK(excess / 200 < 0.006);
        }
    }

    TEST_CASE("float points far from the origin are contained exactly") {
        std::mt19937 random(7);
        std::normal_distribution<float> normal;
        for (const float offset : {1e5f, 1e7f})
            for (const Quality quality : kQualities) {
                std::vector<glm::vec3> points;
                for (int i = 0; i < 200; ++i)
                    points.push_back(glm::vec3(offset) +
                                     10.0f * glm::vec3(normal(random), normal(random), normal(random)));
                CHECK(contains_all(fit::fit_obb(view(points), {.quality = quality}).value(), points));
            }
    }

    TEST_CASE("every quality fits every degenerate class by every criterion, few points and many, float and double") {
        std::mt19937 random(23);
        std::uniform_real_distribution<double> unit(-1.0, 1.0);
        const glm::dvec3 shapes[] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 0.2, 1e-6}, {1, 1e-6, 1e-6}, {1, 0.5, 0.2}};
        for (const glm::dvec3& half : shapes)
            for (const std::size_t count : {1u, 2u, 3u, 17u, 700u})
                for (const bool turned : {false, true}) {
                    const glm::dmat3 turn = turned ? random_rotation(random) : glm::dmat3(1.0);
                    std::vector<glm::dvec3> points;
                    for (std::size_t i = 0; i < count; ++i)
                        points.push_back(turn * (half * glm::dvec3(unit(random), unit(random), unit(random))));
                    const std::vector<glm::vec3> floats(points.begin(), points.end());
                    for (const measure::Criterion& criterion :
                         {measure::minimal_volume(), measure::minimal_area(), measure::minimal_perimeter()}) {
                        double exact = 0.0;
                        for (const Quality quality : {Quality::exact, Quality::tight, Quality::fast}) {
                            INFO(half.x, " ", half.y, " ", half.z, " count ", count, " quality ", int(quality));
                            const Obb box = fit::fit_obb(view(points), {criterion, quality}).value();
                            CHECK(contains_all(box, points));
                            CHECK(validate(box).has_value());
                            CHECK(contains_all(fit::fit_obb(view(floats), {criterion, quality}).value(), floats));
                            // No thicker than the axes make it, and not much worse than the best.
                            const double value = edge_sum(box);
                            if (criterion.mean_curvature_weight == 0.0) continue;
                            if (quality == Quality::exact)
                                exact = value;
                            else
                                CHECK(value <= exact * (quality == Quality::tight ? 1.08 : 1.2) + 1e-30);
                        }
                    }
                }
    }

    TEST_CASE("the same box, bit for bit, for any order and duplication of the points, also where many tie") {
        std::mt19937 random(11);
        std::normal_distribution<float> normal;
        std::vector<glm::vec3> clouds[4];
        for (int i = 0; i < 300; ++i)
            clouds[0].push_back(glm::vec3(3.0f * normal(random), normal(random), 0.5f * normal(random)));
        clouds[1].assign(clouds[0].begin(), clouds[0].begin() + 60);
        for (int i = 0; i < 72; ++i) clouds[2].push_back(glm::vec3(i % 3, i / 3 % 4, i / 12) * 0.1f);
        for (int i = 0; i < 720; ++i) clouds[3].push_back(glm::vec3(i % 10, i / 10 % 9, i / 90) * 0.1f);
        for (const std::vector<glm::vec3>& points : clouds)
            for (const Quality quality : kQualities) {
                if (quality == Quality::exact && points.size() == 720) continue;
                const Obb expected = fit::fit_obb(view(points), {.quality = quality}).value();
                std::vector<glm::vec3> shuffled = points;
                shuffled.insert(shuffled.end(), points.begin(), points.begin() + 50);
                for (int run = 0; run < 5; ++run) {
                    std::shuffle(shuffled.begin(), shuffled.end(), random);
                    const Obb box = fit::fit_obb(view(shuffled), {.quality = quality}).value();
                    INFO(points.size(), " points, quality ", int(quality));
                    CHECK(box.center == expected.center);
                    CHECK(box.axes == expected.axes);
                    CHECK(box.half_extents == expected.half_extents);
                }
            }
    }

    TEST_CASE("every instruction set gives the same bits") {
        std::mt19937 random(29);
        std::normal_distribution<float> normal;
        for (const std::size_t count : {5u, 31u, 64u, 700u}) {
            std::vector<glm::vec3> points;
            for (std::size_t i = 0; i < count; ++i)
                points.push_back(glm::vec3(3.0f * normal(random), normal(random), 0.5f * normal(random)));
            for (const Quality quality : kQualities) {
                const Obb expected = fit::fit_obb(view(points), {.quality = quality}).value();
                for (auto rest = hwy::SupportedTargets(); rest != 0; rest &= rest - 1) {
                    hwy::SetSupportedTargetsForTest(rest & -rest);
                    const Obb box = fit::fit_obb(view(points), {.quality = quality}).value();
                    hwy::SetSupportedTargetsForTest(0);
                    CHECK(box.center == expected.center);
                    CHECK(box.axes == expected.axes);
                    CHECK(box.half_extents == expected.half_extents);
                }
            }
        }
    }

    TEST_CASE("a tight box is never worse than a fast one, few points and many, by every criterion") {
        std::mt19937 random(5);
        std::uniform_real_distribution<double> unit(-1.0, 1.0);
        const measure::Criterion criteria[] = {measure::minimal_volume(), measure::minimal_area(),
                                               measure::minimal_perimeter()};
        int better = 0;
        for (int trial = 0; trial < 600; ++trial) {
            constexpr std::size_t kCounts[] = {5, 12, 40, 64, 200, 300, 1000};
            const glm::dvec3 size(1.0, std::abs(unit(random)), trial % 5 == 0 ? 1e-5 : std::abs(unit(random)));
            std::vector<glm::dvec3> points(kCounts[trial % 7]);
            for (glm::dvec3& p : points) {
                p = glm::dvec3(unit(random), unit(random), unit(random));
                if (trial % 3 == 1) p = glm::normalize(p);
                p = size * p;
            }
            for (const measure::Criterion& criterion : criteria) {
                const auto value = [&](Quality quality) {
                    return criterion(
                        measure::intrinsic_volumes_of_box(*fit::fit_obb(view(points), {criterion, quality})));
                };
                const double fast = value(Quality::fast), tight = value(Quality::tight);
                CAPTURE(trial);
                CHECK(tight <= fast);
                better += tight < fast;
            }
        }
        CHECK(better > 600);
    }

    TEST_CASE("fit_oriented keeps the axes and holds every point with no more than rounding to spare") {
        std::mt19937 random(13);
        std::normal_distribution<double> normal;
        for (int run = 0; run < 100; ++run) {
            const glm::mat3 axes(random_rotation(random));
            std::vector<glm::dvec3> points;
            for (int i = 0; i < (run % 4 == 0 ? 400 : 30); ++i)
                points.emplace_back(normal(random), normal(random), normal(random));
            const Obb box = fit::fit_oriented(view(points), axes).value();
            CHECK(box.axes == axes);
            CHECK(contains_all(box, points));
            for (int k = 0; k < 3; ++k) {
                Obb smaller = box;
                smaller.half_extents[k] *= 1.0f - 3e-7f;
                CHECK(!contains_all(smaller, points));
            }
        }
        CHECK(!fit::fit_oriented(view(std::vector<glm::dvec3>(1)), glm::mat3(2.0f)));
    }

    TEST_CASE("half extents are the smallest floats that contain all points, also near the next float") {
        std::mt19937 random(14);
        std::normal_distribution<double> normal;
        for (int run = 0; run < 150; ++run) {
            const glm::mat3 axes(random_rotation(random));
            std::vector<glm::dvec3> points, scaled;
            for (int i = 0; i < (run % 10 == 0 ? 300 : 8); ++i)
                points.emplace_back(normal(random), normal(random), normal(random));
            const auto fit_scaled = [&](double scale) {
                scaled.clear();
                for (const glm::dvec3& p : points) scaled.push_back(scale * p);
                return fit::fit_oriented(view(scaled), axes).value();
            };
            const int k = run % 3;
            const double large = 1.0 + 0x1p-22;
            const float first = fit_scaled(1.0).half_extents[k];
            REQUIRE(fit_scaled(large).half_extents[k] > first);
            const auto [low, high] = oracle::edge_between(
                1.0, large, [&](double scale) { return fit_scaled(scale).half_extents[k] <= first; });
            for (const double scale : {low, high}) {
                Obb box = fit_scaled(scale);
                CHECK(contains_all(box, scaled));
                box.half_extents[k] = std::nextafter(box.half_extents[k], 0.0f);
                CHECK(!contains_all(box, scaled));
            }
        }
    }

    TEST_CASE("fit_oriented takes mirrored axes: the box is the same size as with the axes that they mirror") {
        const std::vector<glm::dvec3> points = {{0, 0, 0}, {4, 1, 0}, {1, 3, 1}, {0, 0, 2}, {1, 1, 1}, {3, 0, 0}};
        for (const std::size_t copies : {1u, 100u}) {
            std::vector<glm::dvec3> all;
            for (std::size_t i = 0; i < copies * points.size(); ++i)
                all.push_back(points[i % points.size()] * (1.0 - 0.001 * static_cast<double>(i / points.size())));
            const float c = 0.8f, s = 0.6f;
            const glm::mat3 axes(glm::vec3(c, s, 0), glm::vec3(-s, c, 0), glm::vec3(0, 0, 1));
            const glm::mat3 mirrored(axes[0], axes[1], -axes[2]);
            const Obb box = fit::fit_oriented(view(all), axes).value();
            const Obb other = fit::fit_oriented(view(all), mirrored).value();
            CHECK(contains_all(other, all));
            CHECK(volume(other) == doctest::Approx(volume(box)).epsilon(1e-6));
            CHECK(glm::distance(other.center, box.center) < 1e-6);
        }
    }

    TEST_CASE("points as near as the least doubles have a box that holds them") {
        for (const double size : {1e-300, 1e-307, 1e-308, 1e-310, 1e-320, 5e-324})
            for (const Quality quality : kQualities)
                for (const std::size_t count : {2u, 40u, 400u}) {
                    std::vector<glm::dvec3> points;
                    for (std::size_t i = 0; i < count; ++i)
                        points.push_back(size * glm::dvec3(i % 2, i / 2 % 3, i / 6 % 5));
                    const Obb box = fit::fit_obb(view(points), {measure::minimal_area(), quality}).value();
                    CHECK(contains_all(box, points));
                    CHECK(validate(box).has_value());
                    CHECK(edge_sum(box) < 1e-43);
                }
    }

    TEST_CASE("points within 5e29 have a valid box in any direction, and beyond half extents may exceed 1e30") {
        for (const Quality quality : kQualities) {
            const std::vector<glm::dvec3> near = {glm::dvec3(-5e29), glm::dvec3(5e29)},
                                          far = {-near[1] * 2.0, near[1] * 2.0};
            CHECK(validate(fit::fit_obb(view(near), {.quality = quality}).value()));
            const Obb box = fit::fit_obb(view(far), {.quality = quality}).value();
            CHECK(contains_all(box, far));
            CHECK(error_of(validate(box)).code == ErrorCode::out_of_range);
        }
    }

    TEST_CASE("boxes of thousands of points are near the best: fast ones within 2 %, tight ones within 0.2 %") {
        std::mt19937 random(7);
        std::normal_distribution<double> normal;
        double fast = 0.0, tight = 0.0, best = 0.0;
        for (int run = 0; run < 12; ++run) {
            std::vector<glm::dvec3> points;
            for (int i = 0; i < 3000; ++i) {
                const glm::dvec3 p(normal(random), normal(random), normal(random));
                points.push_back((run % 2 == 0 ? p : glm::normalize(p)) * glm::dvec3(1.0, 2.0, 3.0));
            }
            const std::span<const glm::dvec3> all(points);
            const auto value = [&](Quality quality) {
                const Obb box = fit::fit_obb(all, {measure::minimal_perimeter(), quality}).value();
                return 2.0 * (box.half_extents.x + box.half_extents.y + box.half_extents.z);
            };
            fast += value(Quality::fast);
            tight += value(Quality::tight);
            best += fit::fit_exact(all, {.criterion = measure::minimal_perimeter(), .gap = 1e-4}).value().lower_bound;
        }
        CHECK(fast <= 1.02 * best);
        CHECK(tight <= 1.002 * best);
        CHECK(tight >= best);
    }
}
