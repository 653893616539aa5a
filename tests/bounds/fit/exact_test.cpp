// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>
#include <crofton/fit/fit.hpp>
#include <cstdio>
#include <error_of.hpp>
#include <fstream>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "oracle/box_search.hpp"

using namespace crofton;

namespace {

using Points = std::vector<glm::dvec3>;

std::span<const glm::dvec3> view(const Points& points) {
    return points;
}

bool contains_all(const Obb& box, const Points& points) {
    return std::all_of(points.begin(), points.end(), [&](const glm::dvec3& p) { return contains(box, p); });
}

glm::dvec3 random_point(std::mt19937& random) {
    std::normal_distribution<double> normal;
    const double x = normal(random), y = normal(random), z = normal(random);
    return {x, y, z};
}

Points random_polytope(std::mt19937& random, int corners) {
    Points points;
    const glm::dvec3 shape = glm::abs(random_point(random)) + 0.2;
    for (int i = 0; i < corners; ++i) points.push_back(shape * glm::normalize(random_point(random)));
    return points;
}

measure::Criterion random_criterion(std::mt19937& random) {
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    switch (random() % 6) {
        case 0:
            return measure::minimal_volume();
        case 1:
            return measure::minimal_area();
        case 2:
            return measure::minimal_perimeter();
        default:
            return {unit(random), unit(random), unit(random)};
    }
}

glm::dmat3 random_rotation(std::mt19937& random) {
    const glm::dvec3 a = glm::normalize(random_point(random)), b = glm::normalize(glm::cross(a, random_point(random)));
    return {a, b, glm::cross(a, b)};
}

}  // namespace

TEST_SUITE("fit/exact") {
    TEST_CASE("a gap or a time budget out of range is refused, bad points as in fit_obb") {
        const Points points(4, glm::dvec3(1.0));
        const auto no_gap = fit::fit_exact(view(points), {.gap = 0.0});
        REQUIRE(!no_gap.has_value());
        CHECK(error_of(no_gap).code == ErrorCode::invalid_argument);
        CHECK(!fit::fit_exact(view(points), {.gap = std::numeric_limits<double>::quiet_NaN()}));
        CHECK(!fit::fit_exact(view(points), {.time_budget_seconds = -1.0}));
        Points bad = points;
        bad[2].x = std::numeric_limits<double>::infinity();
        CHECK(error_of(fit::fit_exact(view(bad))).item == 2);
        CHECK(error_of(fit::fit_exact(view({}))).code == ErrorCode::empty);
    }

    TEST_CASE("points, segments and flat sets are proved as quickly as others") {
        std::mt19937 random(1);
        for (int run = 0; run < 40; ++run)
            for (int rank = 0; rank < 3; ++rank)
                for (const auto& criterion :
                     {measure::minimal_volume(), measure::minimal_area(), measure::minimal_perimeter()}) {
                    const glm::dvec3 origin = random_point(random) * 10.0;
                    const glm::dvec3 u = rank > 0 ? random_point(random) : glm::dvec3(0.0);
                    const glm::dvec3 v = rank > 1 ? random_point(random) : glm::dvec3(0.0);
                    std::uniform_real_distribution<double> unit(-1.0, 1.0);
                    Points points;
                    for (int i = 0; i < 12; ++i) points.push_back(origin + unit(random) * u + unit(random) * v);
                    const auto fitted = fit::fit_exact(view(points), {.criterion = criterion}).value();
                    CHECK(fitted.complete);
                    CHECK(contains_all(fitted.box, points));
                    CHECK(fitted.lower_bound <= fitted.value);
                    if (criterion.volume_weight == 0.0 && rank > 0 && !(criterion.area_weight > 0.0 && rank == 1))
                        CHECK(fitted.gap <= 1e-6);
                    // No thicker than float axes make it.
                    const float thin =
                        std::min({fitted.box.half_extents.x, fitted.box.half_extents.y, fitted.box.half_extents.z});
                    CHECK(static_cast<double>(thin) <= 1e-6 * edge_sum(fitted.box));
                }
    }

    TEST_CASE("for thin and flat sets the gap is closed except for the rounding of axes to float, by volume too") {
        std::mt19937 random(9);
        std::uniform_real_distribution<double> unit(-1.0, 1.0);
        for (const double thin : {1e-2, 1e-4, 1e-6, 1e-8, 0.0})
            for (int run = 0; run < 8; ++run)
                for (const auto& criterion :
                     {measure::minimal_volume(), measure::minimal_area(), measure::minimal_perimeter()}) {
                    const glm::dmat3 turn = random_rotation(random);
                    Points points;
                    for (int i = 0; i < 30; ++i)
                        points.push_back(turn * glm::dvec3(unit(random), 0.7 * unit(random), thin * unit(random)));
                    const auto fitted = fit::fit_exact(view(points), {.criterion = criterion}).value();
                    INFO(thin, " ", criterion.volume_weight);
                    CHECK(fitted.complete == (fitted.gap - fitted.rounding <= 2e-7 + 1e-12 || fitted.rounding > 0.999));
                    if (thin >= 1e-4 || criterion.volume_weight == 0.0) CHECK(fitted.complete);
                    CHECK(contains_all(fitted.box, points));
                    CHECK(fitted.rounding >= 0.0);
                    CHECK(fitted.rounding <= fitted.gap);
                    // Widths are known to 1e-13 of the size.
                    const double noise = thin > 0.0 ? 3e-13 / thin : 0.0;
                    CHECK(fitted.gap - fitted.rounding <= 2.1e-7 + noise);
                    // A tilt of 6e-8 along edges of length 2 and 1.4.
                    const double tilted = criterion.volume_weight > 0.0 && thin > 0.0 ? 4e-7 / thin : 1e-6;
                    if (thin > 0.0 || criterion.volume_weight == 0.0) CHECK(fitted.rounding <= tilted);
                    if (thin == 0.0 && criterion.volume_weight > 0.0) CHECK(fitted.lower_bound == 0.0);
                }
    }

    TEST_CASE("a needle is not flat: its volume is proved, though its extreme points may be three or four in a plane") {
        std::mt19937 random(10);
        std::uniform_real_distribution<double> unit(0.0, 1.0);
        for (const double thin : {1e-2, 1e-3, 1e-4})
            for (int run = 0; run < 40; ++run) {
                const glm::dvec3 along = glm::normalize(random_point(random));
                Points points;
                const int count = 5 + static_cast<int>(60.0 * unit(random));
                for (int i = 0; i < count; ++i) {
                    const double at = unit(random);
                    points.push_back(at * along + thin * random_point(random));
                }
                const auto fitted = fit::fit_exact(view(points), {.criterion = measure::minimal_volume()}).value();
                const auto tight = fit::fit_obb(view(points), {measure::minimal_volume(), fit::Quality::tight}).value();
                // All cells may be spent on a few points that are nearly flat.
                CHECK((fitted.lower_bound > 0.5 * fitted.value || (!fitted.complete && count < 8)));
                CHECK(fitted.value <= (1.0 + 1e-6) * measure::intrinsic_volumes_of_box(tight).volume);
            }
    }

    TEST_CASE("a box, turned, is its own best box") {
        std::mt19937 random(2);
        for (int run = 0; run < 60; ++run) {
            const glm::dvec3 half = glm::abs(random_point(random)) + 0.05;
            const glm::dmat3 turn = random_rotation(random);
            Points points;
            for (unsigned i = 0; i < 8; ++i)
                points.push_back(turn *
                                 (half * glm::dvec3(i & 1u ? 1.0 : -1.0, i & 2u ? 1.0 : -1.0, i & 4u ? 1.0 : -1.0)));
            const measure::Criterion criterion = random_criterion(random);
            const auto fitted = fit::fit_exact(view(points), {.criterion = criterion}).value();
            CHECK(fitted.value == doctest::Approx(criterion(2.0 * half.x, 2.0 * half.y, 2.0 * half.z)).epsilon(1e-6));
            CHECK(fitted.gap <= 1e-6);
        }
    }

    TEST_CASE("a regular tetrahedron fits best into the cube of which its edges are diagonals") {
        const Points points = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
        const auto fitted = fit::fit_exact(view(points), {.criterion = measure::minimal_volume()}).value();
        CHECK(fitted.value == doctest::Approx(8.0).epsilon(1e-6));
        CHECK(fitted.lower_bound <= 8.0);
    }

    TEST_CASE("no orientation that brute force tries is better than the proved bound, for any weights") {
        std::mt19937 random(3);
        for (int run = 0; run < 60; ++run) {
            const Points points = random_polytope(random, 4 + run % 14);
            const measure::Criterion criterion = random_criterion(random);
            const auto fitted = fit::fit_exact(view(points), {.criterion = criterion}).value();
            const auto searched = oracle::search_boxes(points, criterion, 14, 4000);
            CHECK(fitted.complete);
            CHECK(fitted.gap <= 1e-6);
            CHECK(contains_all(fitted.box, points));
            CHECK(searched.value >= fitted.lower_bound * (1.0 - 1e-12));
            CHECK(searched.value >= fitted.value * (1.0 - 1e-6));
        }
    }

    TEST_CASE("two adjacent faces of the optimum hold an edge each, for any weights") {
        std::mt19937 random(4);
        for (int run = 0; run < 200; ++run) {
            const Points points = random_polytope(random, 5 + run % 20);
            const auto fitted =
                fit::fit_exact(view(points), {.criterion = random_criterion(random), .gap = 1e-10}).value();
            REQUIRE(fitted.complete);
            // An axis is flush if one of its two faces touches two points or more.
            int flush_axes = 0;
            for (int k = 0; k < 3; ++k) {
                int touching[2] = {0, 0};
                for (const glm::dvec3& p : points) {
                    const double t = glm::dot(p - fitted.box.center, glm::dvec3(fitted.box.axes[k]));
                    const double half = static_cast<double>(fitted.box.half_extents[k]);
                    if (t >= half - 2e-6) ++touching[0];
                    if (t <= -half + 2e-6) ++touching[1];
                }
                CHECK(touching[0] >= 1);
                CHECK(touching[1] >= 1);
                flush_axes += touching[0] >= 2 || touching[1] >= 2;
            }
            CHECK(flush_axes >= 2);
        }
    }

    TEST_CASE("turning the points does not change the value, doubling them scales the box to the bit") {
        std::mt19937 random(5);
        for (int run = 0; run < 30; ++run) {
            const Points points = random_polytope(random, 30);
            const auto criterion = measure::minimal_area();
            const auto fitted = fit::fit_exact(view(points), {.criterion = criterion}).value();
            const glm::dmat3 turn = random_rotation(random);
            Points turned, doubled;
            for (const glm::dvec3& p : points) {
                turned.push_back(turn * p);
                doubled.push_back(p * 1024.0);
            }
            CHECK(fit::fit_exact(view(turned), {.criterion = criterion})->value ==
                  doctest::Approx(fitted.value).epsilon(1e-6));
            const auto scaled = fit::fit_exact(view(doubled), {.criterion = criterion}).value();
            CHECK(scaled.box.axes == fitted.box.axes);
            CHECK(scaled.box.center == fitted.box.center * 1024.0);
            CHECK(scaled.box.half_extents == fitted.box.half_extents * 1024.0f);
        }
    }

    TEST_CASE("a spent budget or a callback that says stop leaves the best so far, with a bound that holds") {
        std::mt19937 random(6);
        Points points;
        for (int i = 0; i < 1000; ++i) points.push_back(glm::normalize(random_point(random)));
        const auto full = fit::fit_exact(view(points), {.criterion = measure::minimal_area(), .gap = 1e-3}).value();
        CHECK(full.complete);
        CHECK(full.gap <= 1.001e-3);
        for (const std::uint64_t cells : {0u, 100u, 3000u}) {
            const auto cut =
                fit::fit_exact(view(points), {.criterion = measure::minimal_area(), .max_cells = cells}).value();
            CHECK(!cut.complete);
            CHECK(contains_all(cut.box, points));
            CHECK(cut.lower_bound <= full.value);
            CHECK(cut.value >= full.lower_bound);
            CHECK(cut.gap == doctest::Approx((cut.value - cut.lower_bound) / cut.value));
        }
        int calls = 0;
        const auto stop = [&](const fit::Progress& progress) {
            CHECK(progress.lower_bound <= progress.value);
            return ++calls >= 3;
        };
        const FunctionRef<bool(const fit::Progress&)> callback(stop);
        CHECK(
            !fit::fit_exact(view(points), {.criterion = measure::minimal_area(), .should_stop = &callback})->complete);
        CHECK(calls == 3);
        CHECK(!fit::fit_exact(view(points), {.criterion = measure::minimal_area(), .time_budget_seconds = 0.0})
                   ->complete);
    }

    TEST_CASE("progress of a flat set by volume reports volumes: 0, not areas") {
        std::mt19937 random(10);
        const glm::dmat3 turn = random_rotation(random);
        Points points;
        for (int i = 0; i < 2000; ++i) {
            const glm::dvec2 p = glm::normalize(glm::dvec2(random_point(random)));
            points.push_back(turn * glm::dvec3(p, 0.0));
        }
        int calls = 0;
        const auto look = [&](const fit::Progress& progress) {
            CHECK(progress.value < 1e-6);
            CHECK(progress.lower_bound == 0.0);
            return ++calls >= 10;
        };
        const FunctionRef<bool(const fit::Progress&)> callback(look);
        CHECK(fit::fit_exact(view(points),
                             {.criterion = measure::minimal_volume(), .gap = 1e-9, .should_stop = &callback}));
        CHECK(calls > 0);
    }

    TEST_CASE("weights of any size choose the same box: those of 1e-300 and of 1e300, far sets and near ones") {
        std::mt19937 random(11);
        for (const double size : {1e-9, 1.0, 1e25}) {
            Points points = random_polytope(random, 12);
            for (glm::dvec3& p : points) p *= size;
            const auto expected = fit::fit_exact(view(points), {.criterion = {1.0, 0.0, 0.0}}).value();
            CHECK(expected.complete);
            for (const double weight : {0x1p-1000, 0x1p1000}) {
                const measure::Criterion criterion{weight, 0.0, 0.0};
                const auto fitted = fit::fit_exact(view(points), {.criterion = criterion}).value();
                CAPTURE(size);
                CAPTURE(weight);
                CHECK(fitted.complete);
                CHECK(fitted.box.axes == expected.box.axes);
                CHECK(fitted.cells == expected.cells);
                const auto quick = fit::fit_obb(view(points), {{1.0, 0.0, 0.0}}).value();
                CHECK(fit::fit_obb(view(points), {criterion})->axes == quick.axes);
            }
        }
    }

    TEST_CASE("every lower bound in progress reports is a bound: no box is found below it later") {
        std::mt19937 random(7);
        int told = 0;
        for (int trial = 0; trial < 400; ++trial) {
            Points points;
            for (int i = 0; i < 20 + trial; ++i) points.push_back(glm::normalize(random_point(random)));
            std::vector<double> bounds;
            std::uint64_t before = 0;
            // Told by the work done: eight cells are no more than so many points to look at, and 8192 are between
            // calls.
            const std::uint64_t least_cells = 8 * (8192 / (64 + 6 * points.size()));
            const auto keep = [&](const fit::Progress& progress) {
                CHECK(progress.cells >= before + least_cells);
                before = progress.cells;
                return bounds.push_back(progress.lower_bound), false;
            };
            const FunctionRef<bool(const fit::Progress&)> callback(keep);
            const auto found =
                fit::fit_exact(view(points), {.criterion = measure::minimal_volume(), .should_stop = &callback});
            REQUIRE(found);
            for (const double bound : bounds) CHECK(bound <= found->value);
            told += static_cast<int>(bounds.size());
        }
        CHECK(told > 100);
    }

    TEST_CASE("a proof of four digits more takes seven levels of cells, some ten cells a level") {
        // The bound's error is quadratic in a cell's size: a halving quarters it, and 10^4 is less than 4^7. Each cell
        // that survives becomes eight.
        std::mt19937 random(8);
        for (const auto& criterion :
             {measure::minimal_volume(), measure::minimal_area(), measure::minimal_perimeter()}) {
            double more = 0.0;
            for (int trial = 0; trial < 20; ++trial) {
                Points points;
                for (int i = 0; i < 20; ++i) points.push_back(random_point(random) * glm::dvec3(1.0, 0.7, 0.5));
                const auto coarse = fit::fit_exact(view(points), {.criterion = criterion, .gap = 1e-5}).value();
                const auto fine = fit::fit_exact(view(points), {.criterion = criterion, .gap = 1e-9}).value();
                CHECK(fine.complete);
                more += static_cast<double>(fine.cells - coarse.cells) / 20.0;
            }
            CHECK(more <= 7 * 10 * 8);
        }
    }

    TEST_CASE("the best known boxes of real meshes are matched within 1e-6") {
        const std::string folder = std::string(CROFTON_SHARED_DATA) + "/meshes/";
        std::ifstream table(folder + "reference.csv");
        if (!table) {
            MESSAGE("skipped: no shared data");
            return;
        }
        std::string line;
        std::getline(table, line);
        while (std::getline(table, line)) {
            std::replace(line.begin(), line.end(), ',', ' ');
            char name[64];
            double vertices = 0.0, hull = 0.0, known[3] = {};
            REQUIRE(std::sscanf(line.c_str(), "%63s %lf %lf %lf %lf %lf", name, &vertices, &hull, &known[0], &known[1],
                                &known[2]) == 6);
            std::ifstream file(folder + name + ".obj");
            Points points;
            for (std::string text; std::getline(file, text);) {
                glm::dvec3 p;
                if (std::sscanf(text.c_str(), "v %lf %lf %lf", &p.x, &p.y, &p.z) == 3) points.push_back(p);
            }
            REQUIRE(static_cast<double>(points.size()) == vertices);
            INFO(std::string(name));
            for (int c = 0; c < 3; ++c) {
                const auto criterion = c == 0   ? measure::minimal_volume()
                                       : c == 1 ? measure::minimal_area()
                                                : measure::minimal_perimeter();
                const auto fitted = fit::fit_exact(view(points), {.criterion = criterion}).value();
                CHECK(fitted.complete);
                CHECK(fitted.gap <= 1e-6);
                CHECK(fitted.value <= known[c] * (1.0 + 1e-6));
                CHECK(fitted.lower_bound <= known[c] * (1.0 + 1e-8));
                if (points.size() < 4000) CHECK(contains_all(fitted.box, points));
            }
        }
    }

    TEST_CASE("flat sets of any size by volume, faces and edges are proved to the gap, or not complete") {
        std::mt19937_64 random(81);
        std::uniform_real_distribution<double> uniform(-1.0, 1.0);
        int complete = 0, incomplete = 0;
        for (int decade = -30; decade <= 18; decade += 2)
            for (int trial = 0; trial < 4; ++trial) {
                const double size = std::pow(10.0, decade), height = trial % 2 ? 0.25 * size : 0.0;
                std::vector<glm::dvec3> points;
                for (int i = 0; i < 5 + trial; ++i)
                    points.push_back({size * uniform(random), size * uniform(random), height});
                const fit::ExactOptions options{.criterion = {0.3, 0.2, 0.5}, .gap = trial < 2 ? 2e-7 : 1e-5};
                const auto found = fit::fit_exact(std::span<const glm::dvec3>(points), options).value();
                CAPTURE(decade);
                const double unproved = found.gap - found.rounding;
                if (found.complete) CHECK(unproved <= options.gap * (1.0 + 1e-6) + 1e-12);
                if (decade <= 6) CHECK(found.complete);  // volume counts no more than a million times as much
                (found.complete ? complete : incomplete) += 1;
                CHECK(found.lower_bound <= found.value);
                // No axis-aligned box that lies flat has less than what is said to be proved.
                for (int step = 0; step < 180; ++step) {
                    const double angle = 0.01745329 * step, c = std::cos(angle), s = std::sin(angle);
                    double low[2] = {1e300, 1e300}, high[2] = {-1e300, -1e300};
                    for (const glm::dvec3& p : points)
                        for (int k = 0; k < 2; ++k) {
                            const double t = k == 0 ? c * p.x + s * p.y : c * p.y - s * p.x;
                            low[k] = std::min(low[k], t), high[k] = std::max(high[k], t);
                        }
                    CHECK(found.lower_bound <=
                          options.criterion(high[0] - low[0], high[1] - low[1], 0.0) * (1.0 + 1e-12));
                }
            }
        CHECK(complete > 60);
        CHECK(incomplete > 10);
    }

    TEST_CASE(
        "of sets that are nearly straight, exact fits are never worse than tight ones, nor those than fast ones") {
        std::mt19937_64 random(82);
        std::uniform_real_distribution<double> uniform(-1.0, 1.0);
        std::normal_distribution<double> normal;
        for (const double thickness : {1e-6, 1e-8, 1e-9, 1e-10, 1e-12})
            for (int trial = 0; trial < 60; ++trial) {
                const glm::dquat turn =
                    glm::normalize(glm::dquat(normal(random), normal(random), normal(random), normal(random)));
                std::vector<glm::dvec3> points;
                for (int i = 0; i < 4 + trial % 40; ++i)
                    points.push_back(turn * (glm::dvec3(1.0, thickness, thickness) *
                                             glm::dvec3(uniform(random), uniform(random), uniform(random))));
                const measure::Criterion criterion =
                    trial % 2 ? measure::minimal_perimeter() : measure::Criterion{0.3, 0.2, 0.5};
                const auto value = [&](fit::Quality quality) {
                    const auto box = fit::fit_obb(std::span<const glm::dvec3>(points), {criterion, quality});
                    return criterion(measure::intrinsic_volumes_of_box(box.value()));
                };
                const double tight = value(fit::Quality::tight);
                CAPTURE(thickness);
                CHECK(tight <= value(fit::Quality::fast));
                CHECK(value(fit::Quality::exact) <= tight * (1.0 + 1e-6));
            }
    }
}
