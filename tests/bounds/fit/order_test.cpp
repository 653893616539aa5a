// SPDX-License-Identifier: MIT
// A fit is a function of the set: the same bits for any order and any duplication of the points.
#include <doctest/doctest.h>
#include <algorithm>
#include <bit>
#include <crofton/fit/fit.hpp>
#include <random>
#include <vector>

#include "random_rotation.hpp"

using namespace crofton;
using fit::Quality;

namespace {

using Points = std::vector<glm::dvec3>;

// `count` points of a box with these half extents, turned and moved.
Points random_points(std::mt19937& random, const glm::dvec3& half, int count) {
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    const glm::dmat3 turn = random_rotation(random);
    const glm::dvec3 place(unit(random), unit(random), unit(random));
    Points points;
    for (int i = 0; i < count; ++i) {
        const double x = unit(random), y = unit(random), z = unit(random);
        points.push_back(turn * (half * glm::dvec3(x, y, z)) + 3.0 * place);
    }
    return points;
}

// Equal to the last bit, the sign of zero included.
bool same_bits(const Obb& a, const Obb& b) {
    bool same = true;
    for (int k = 0; k < 3; ++k) {
        same = same && std::bit_cast<std::uint64_t>(a.center[k]) == std::bit_cast<std::uint64_t>(b.center[k]);
        same =
            same && std::bit_cast<std::uint32_t>(a.half_extents[k]) == std::bit_cast<std::uint32_t>(b.half_extents[k]);
        for (int j = 0; j < 3; ++j)
            same = same && std::bit_cast<std::uint32_t>(a.axes[k][j]) == std::bit_cast<std::uint32_t>(b.axes[k][j]);
    }
    return same;
}

// Reversed, shuffled, and shuffled with some points twice.
std::vector<Points> reorderings(const Points& points, std::mt19937& random) {
    std::vector<Points> all(3, points);
    std::reverse(all[0].begin(), all[0].end());
    all[2].insert(all[2].end(), points.begin(), points.begin() + static_cast<std::ptrdiff_t>(points.size() / 2));
    std::shuffle(all[1].begin(), all[1].end(), random);
    std::shuffle(all[2].begin(), all[2].end(), random);
    return all;
}

template <class Point>
std::vector<Point> converted(const Points& points) {
    return {points.begin(), points.end()};
}

const measure::Criterion kCriteria[] = {measure::minimal_volume(), measure::minimal_area(),
                                        measure::minimal_perimeter()};

// How many of the boxes of all qualities and criteria differ for some order.
template <class Point>
int count_differences(const Points& points, std::mt19937& random) {
    int differences = 0;
    const std::vector<Point> original = converted<Point>(points);
    for (const Quality quality : {Quality::fast, Quality::tight, Quality::exact})
        for (const measure::Criterion& criterion : kCriteria) {
            const Obb expected = fit::fit_obb(std::span<const Point>(original), {criterion, quality}).value();
            for (const Points& other : reorderings(points, random)) {
                const std::vector<Point> reordered = converted<Point>(other);
                differences +=
                    !same_bits(fit::fit_obb(std::span<const Point>(reordered), {criterion, quality}).value(), expected);
            }
        }
    return differences;
}

}  // namespace

TEST_SUITE("fit/order") {
    TEST_CASE("tilted planar sets have the same box in any order, few points and many") {
        std::mt19937 random(41);
        for (int run = 0; run < 60; ++run) {
            const int count = run % 6 == 5 ? 300 : 4 + run % 20;
            const Points points = random_points(random, {1.0, 0.7, 0.0}, count);
            INFO("run ", run, ", ", count, " points");
            CHECK(count_differences<glm::dvec3>(points, random) == 0);
            CHECK(count_differences<glm::vec3>(points, random) == 0);
        }
    }

    TEST_CASE("straight sets, thin ones, single points and solid ones have the same bits in any order") {
        std::mt19937 random(42);
        const glm::dvec3 shapes[] = {{1, 0, 0}, {1, 1e-7, 0}, {1, 0.5, 1e-9}, {0, 0, 0}, {1, 0.8, 0.5}};
        for (int run = 0; run < 10; ++run)
            for (const glm::dvec3& half : shapes) {
                const int count = run % 5 == 4 ? 270 : 2 + 3 * run;
                const Points points = random_points(random, half, count);
                INFO("half ", half.x, " ", half.y, " ", half.z, ", ", count, " points");
                CHECK(count_differences<glm::dvec3>(points, random) == 0);
                CHECK(count_differences<glm::vec3>(points, random) == 0);
            }
    }

    TEST_CASE("zeros of either sign are one number") {
        std::mt19937 random(43);
        std::uniform_real_distribution<double> unit(-1.0, 1.0);
        for (int run = 0; run < 20; ++run) {
            Points points;
            for (int i = 0; i < 6 + run; ++i) {
                glm::dvec3 p(unit(random), i % 3 == 0 ? 0.0 : unit(random), 0.0);
                if (run % 2 == 0) p.x = 0.0;
                points.push_back(p);
                for (int k = 0; k < 3; ++k) p[k] = p[k] == 0.0 ? -0.0 : p[k];
                points.push_back(p);
            }
            CHECK(count_differences<glm::dvec3>(points, random) == 0);
            CHECK(count_differences<glm::vec3>(points, random) == 0);
        }
    }

    TEST_CASE("copies that make few points many change nothing: each point stands twice, 200 of them are 400") {
        std::mt19937 random(46);
        for (int run = 0; run < 10; ++run) {
            const Points points = random_points(random, {1.0, 0.7, run % 2 == 0 ? 0.4 : 0.0}, 200);
            Points twice = points;
            twice.insert(twice.end(), points.begin(), points.end());
            for (const Quality quality : {Quality::fast, Quality::tight})
                for (const measure::Criterion& criterion : kCriteria) {
                    const fit::FitOptions options{criterion, quality};
                    CHECK(same_bits(*fit::fit_obb(std::span<const glm::dvec3>(points), options),
                                    *fit::fit_obb(std::span<const glm::dvec3>(twice), options)));
                    const auto floats = converted<glm::vec3>(points), floats_twice = converted<glm::vec3>(twice);
                    CHECK(same_bits(*fit::fit_obb(std::span<const glm::vec3>(floats), options),
                                    *fit::fit_obb(std::span<const glm::vec3>(floats_twice), options)));
                }
        }
    }

    TEST_CASE("points listed twice change nothing, also with coordinates that are lost relative to the set's size") {
        std::mt19937 random(47);
        std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
        for (int run = 0; run < 20; ++run) {
            std::vector<glm::vec3> points;
            const auto or_nearly_zero = [&](bool is, float value) { return is ? value : 1e-20f * unit(random); };
            for (int i = 0; i < 100; ++i) {
                const float x = or_nearly_zero(i % 2 == 0, 1.0f), y = or_nearly_zero(i % 4 < 2, 0.7f);
                points.emplace_back(x, y, or_nearly_zero(i % 8 < 4, 0.3f));
            }
            std::vector<glm::vec3> twice = points;
            twice.insert(twice.end(), points.begin(), points.end());
            for (const Quality quality : {Quality::fast, Quality::tight})
                for (const measure::Criterion& criterion : kCriteria)
                    CHECK(same_bits(*fit::fit_obb(std::span<const glm::vec3>(points), {criterion, quality}),
                                    *fit::fit_obb(std::span<const glm::vec3>(twice), {criterion, quality})));
        }
    }

    TEST_CASE("boxes with given axes do not change either, around turned grids, of which many points tie") {
        std::mt19937 random(1);
        for (int run = 0; run < 300; ++run) {
            const glm::dmat3 turn = random_rotation(random);
            std::vector<glm::vec3> points;
            for (int i = 0; i < 200; ++i)
                points.push_back(glm::vec3(turn * (0.1 * glm::dvec3(i % 6, i / 6 % 6, i / 36))));
            std::vector<glm::vec3> twice = points;
            twice.insert(twice.end(), points.begin(), points.end());
            CHECK(same_bits(*fit::fit_oriented(std::span<const glm::vec3>(points), glm::mat3(turn)),
                            *fit::fit_oriented(std::span<const glm::vec3>(twice), glm::mat3(turn))));
        }
    }

    TEST_CASE("value, bound and cells of the proof do not depend on the order either") {
        std::mt19937 random(44);
        for (int run = 0; run < 30; ++run)
            for (const measure::Criterion& criterion : kCriteria) {
                const Points points = random_points(random, {1.0, 0.6, run % 3 == 0 ? 0.3 : 0.0}, 5 + run);
                const auto expected =
                    fit::fit_exact(std::span<const glm::dvec3>(points), {.criterion = criterion}).value();
                for (const Points& other : reorderings(points, random)) {
                    const auto again =
                        fit::fit_exact(std::span<const glm::dvec3>(other), {.criterion = criterion}).value();
                    CHECK(again.value == expected.value);
                    CHECK(again.lower_bound == expected.lower_bound);
                    CHECK(again.rounding == expected.rounding);
                    CHECK(again.cells == expected.cells);
                    CHECK(again.subset == expected.subset);
                }
            }
    }

    TEST_CASE("each half extent is the least float that holds the points, of flat sets too") {
        std::mt19937 random(45);
        for (int run = 0; run < 60; ++run)
            for (const Quality quality : {Quality::fast, Quality::tight, Quality::exact}) {
                const int count = run % 6 == 5 ? 300 : 4 + run % 20;
                const Points points = random_points(random, {1.0, 0.7, run % 4 == 0 ? 0.2 : 0.0}, count);
                const Obb box = fit::fit_obb(std::span<const glm::dvec3>(points), {.quality = quality}).value();
                for (int k = 0; k < 3; ++k) {
                    Obb smaller = box;
                    if (box.half_extents[k] == 0.0f) continue;
                    smaller.half_extents[k] = std::nextafter(box.half_extents[k], 0.0f);
                    const auto inside = [](const Obb& b) {
                        return [&b](const glm::dvec3& p) { return contains(b, p); };
                    };
                    CHECK(std::all_of(points.begin(), points.end(), inside(box)));
                    CHECK(!std::all_of(points.begin(), points.end(), inside(smaller)));
                }
            }
    }
}
