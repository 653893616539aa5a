// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <cmath>
#include <crofton/lines/lines.hpp>

#include "../../study/radiosity/shapes.hpp"

using namespace crofton;
using namespace crofton::lines;

namespace {

constexpr LineMethod kMethods[] = {LineMethod::sphere_points, LineMethod::disc, LineMethod::bundles, LineMethod::walls};

shapes::Shape flat_scene() {
    shapes::Shape s;
    s.parallelogram({0, 0, 0}, {10, 0, 0}, {0, 10, 0}, 0);
    s.parallelogram({3, 3, 0.5f}, {0, 2, 0}, {2, 0, 0}, 1);
    return s;
}

}  // namespace

TEST_SUITE("lines/line_source") {
    TEST_CASE("every method crosses a surface 2·N·S/F times on average") {
        const shapes::Shape shape = flat_scene();
        const auto tracer = LineTracer::build(shape.mesh).value();
        for (const LineMethod method : kMethods) {
            // By sixteen independent samples: the lines of one bundle are not independent of each other.
            double sum = 0.0, squares = 0.0;
            constexpr int kRepeats = 16;
            for (int r = 0; r < kRepeats; ++r) {
                const LineSource source(tracer.bounds(), method, 3 + static_cast<std::uint64_t>(r));
                const double share =
                    visibility_complexity(tracer, source, 10).mean_crossings * source.surface_area() / 208.0;
                sum += share;
                squares += share * share;
            }
            const double mean = sum / kRepeats, error = std::sqrt((squares / kRepeats - mean * mean) / (kRepeats - 1));
            CHECK(error < 0.1);
            CHECK(std::abs(mean - 1.0) < 4.0 * error);
            const auto seen = visibility_complexity(tracer, LineSource(tracer.bounds(), method, 3), 100);
            CHECK(std::abs(static_cast<double>(seen.lines) - 102'400.0) <
                  (method == LineMethod::bundles ? 1500.0 : 0.5));
        }
    }

    TEST_CASE("on a flat scene the walls of its box waste fewer lines than its sphere") {
        const shapes::Shape shape = flat_scene();
        const auto tracer = LineTracer::build(shape.mesh).value();
        const auto wasted = [&](LineMethod method) {
            return visibility_complexity(tracer, LineSource(tracer.bounds(), method, 1), 50).wasted;
        };
        CHECK(wasted(LineMethod::walls) < 0.2);
        CHECK(wasted(LineMethod::disc) > 0.6);
    }

    TEST_CASE("a block is the same whenever it is drawn") {
        const shapes::Shape shape = flat_scene();
        const auto tracer = LineTracer::build(shape.mesh);
        for (const LineMethod method : kMethods) {
            const LineSource source(tracer->bounds(), method, 3);
            Vector<Line> a, b;
            source.draw(7, a);
            source.draw(8, b);
            CHECK_FALSE(a[0].direction == b[0].direction);
            source.draw(7, b);
            REQUIRE(a.size() == b.size());
            for (std::size_t i = 0; i < a.size(); ++i)
                CHECK((a[i].point == b[i].point && a[i].direction == b[i].direction));
        }
    }
}
