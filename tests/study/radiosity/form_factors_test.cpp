// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <cmath>
#include <crofton/core/executor.hpp>
#include <crofton/radiosity/patches.hpp>
#include <error_of.hpp>

#include "shapes.hpp"

using namespace crofton;
using namespace crofton::lines;
using namespace crofton::radiosity;
using shapes::Shape;

namespace {

struct Case {
    Patches patches;
    LineTracer tracer;
};

Case make_case(const Shape& shape, std::size_t count) {
    const std::vector<Material> materials(count);
    auto patches = make_patches(shape.mesh, shape.patches, materials).value();
    auto tracer = LineTracer::build(patches.mesh);
    return {std::move(patches), std::move(*tracer)};
}

// F_01 by all estimators within 4 standard errors of the truth.
void check_pair(const Shape& shape, std::size_t count, double truth) {
    const Case c = make_case(shape, count);
    for (const LocalDensity density : {LocalDensity::cosine, LocalDensity::uniform}) {
        const FactorRow row = factors_by_local_lines(c.tracer, c.patches, 0, 200'000, density, 17);
        CHECK(row.standard_errors[1] < 0.01);
        CHECK(std::abs(row.factors[1] - truth) < 4.0 * row.standard_errors[1] + 1e-9);
    }
    // The spread over sixteen independent estimates, since the lines of one bundle are not independent.
    for (const LineMethod method :
         {LineMethod::sphere_points, LineMethod::disc, LineMethod::bundles, LineMethod::walls}) {
        double sum = 0.0, squares = 0.0;
        constexpr int kRepeats = 16;
        for (int r = 0; r < kRepeats; ++r) {
            const LineSource source(c.tracer.bounds(), method, 23 + static_cast<std::uint64_t>(r));
            const auto matrix = factors_by_global_lines(c.tracer, c.patches, source, 40).value();
            sum += matrix.factor(0, 1);
            squares += matrix.factor(0, 1) * matrix.factor(0, 1);
        }
        const double mean = sum / kRepeats, error = std::sqrt((squares / kRepeats - mean * mean) / (kRepeats - 1));
        CHECK(error < 0.1 * truth);
        CHECK(std::abs(mean - truth) < 4.0 * error);
    }
}

Shape opposed(float x, float y) {
    Shape s;
    s.parallelogram({0, 0, 0}, {x, 0, 0}, {0, y, 0}, 0);
    s.parallelogram({0, 0, 1}, {0, y, 0}, {x, 0, 0}, 1);
    return s;
}

Shape right_angle(float h, float w) {
    Shape s;
    s.parallelogram({0, 0, 0}, {1, 0, 0}, {0, w, 0}, 0);
    s.parallelogram({0, 0, 0}, {0, 0, h}, {1, 0, 0}, 1);
    return s;
}

}  // namespace

TEST_SUITE("radiosity/form_factors") {
    TEST_CASE("the full matrix of too many patches is refused") {
        Shape s;
        for (std::uint32_t i = 0; i < 16'385; ++i) s.triangle({0, 0, static_cast<float>(i)}, {1, 0, 0}, {0, 1, 0}, i);
        const Case c = make_case(s, 16'385);
        const LineSource source(c.tracer.bounds(), LineMethod::walls, 1);
        CHECK(error_of(factors_by_global_lines(c.tracer, c.patches, source, 1)).code == ErrorCode::out_of_range);
    }

    TEST_CASE("two unit squares face to face at distance one: 0.199825") {
        check_pair(opposed(1, 1), 2, 0.199825);
    }

    TEST_CASE("two unit squares with a common edge at a right angle: 0.200044") {
        check_pair(right_angle(1, 1), 2, 0.200044);
    }

    TEST_CASE("in a closed room rows sum to one and factors are reciprocal") {
        Shape s;
        s.room({0, 0, 0}, {3, 2, 1}, 0);
        s.parallelogram({1, 0.5f, 0.4f}, {1, 0, 0}, {0, 1, 0.1f}, 6);  // a table top: its back swallows
        s.parallelogram({1, 0.5f, 0.4f}, {0, 1, 0.1f}, {1, 0, 0}, 7);  // and its underside
        const Case c = make_case(s, 8);
        const LineSource source(c.tracer.bounds(), LineMethod::walls, 5);
        const auto m = factors_by_global_lines(c.tracer, c.patches, source, 400).value();
        for (std::size_t i = 0; i < 8; ++i) {
            double sum = 0.0;
            for (std::size_t j = 0; j < 8; ++j) {
                sum += m.factor(i, j);
                // Both ways along a stretch at once: the counts themselves are symmetric.
                CHECK(m.transfers[i * 8 + j] == m.transfers[j * 8 + i]);
                const double there = c.patches.areas[i] * m.factor(i, j), back = c.patches.areas[j] * m.factor(j, i);
                const double error = std::hypot(c.patches.areas[i] * m.standard_error(i, j),
                                                c.patches.areas[j] * m.standard_error(j, i));
                CHECK(std::abs(there - back) < 4.5 * error + 1e-4);
            }
            CHECK(sum == doctest::Approx(1.0).epsilon(1e-4));
            const FactorRow row = factors_by_local_lines(c.tracer, c.patches, static_cast<std::uint32_t>(i), 20'000,
                                                         LocalDensity::cosine, 9);
            for (std::size_t j = 0; j < 8; ++j)
                CHECK(std::abs(row.factors[j] - m.factor(i, j)) <
                      4.5 * std::hypot(row.standard_errors[j], m.standard_error(i, j)) + 1e-3);
        }
    }

    TEST_CASE("the same counts for any number of threads") {
        Shape s;
        s.room({0, 0, 0}, {1, 1, 1}, 0);
        const Case c = make_case(s, 6);
        const LineSource source(c.tracer.bounds(), LineMethod::bundles, 5);
        ThreadPool pool(4);
        CHECK(factors_by_global_lines(c.tracer, c.patches, source, 50)->transfers ==
              factors_by_global_lines(c.tracer, c.patches, source, 50, pool)->transfers);
    }
}
