// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <crofton/pvs/pvs.hpp>
#include <crofton/sampling/sampling.hpp>
#include <error_of.hpp>
#include <limits>
#include <vector>

using namespace crofton;
using namespace crofton::pvs;

TEST_SUITE("pvs/cells") {
    TEST_CASE("bad bounds, no cells and too many are named errors") {
        const double nan = std::numeric_limits<double>::quiet_NaN();
        const Aabb good{{0.0, 0.0, 0.0}, {1.0, 2.0, 3.0}};
        CHECK(error_of(Cells::grid({{0.0, nan, 0.0}, {1.0, 1.0, 1.0}}, {1, 1, 1})).code == ErrorCode::non_finite);
        CHECK(error_of(Cells::grid({{0.0, 0.0, 0.0}, {1.0, 0.0, 1.0}}, {1, 1, 1})).code == ErrorCode::degenerate);
        CHECK(error_of(Cells::grid(Aabb{}, {1, 1, 1})).code == ErrorCode::non_finite);
        CHECK(error_of(Cells::grid(good, {4, 0, 4})).code == ErrorCode::invalid_argument);
        for (const glm::uvec3& counts :
             {glm::uvec3(1u << 25, 1, 1), glm::uvec3(4096, 4096, 2), glm::uvec3(~0u, ~0u, ~0u)})
            CHECK(error_of(Cells::grid(good, counts)).code == ErrorCode::out_of_range);
        CHECK(error_of(Cells::boxes({})).code == ErrorCode::empty);
        std::vector<Aabb> boxes(3, good);
        boxes[2].max.y = -1.0;
        CHECK(error_of(Cells::boxes(boxes)).code == ErrorCode::empty);
        CHECK(error_of(Cells::boxes(boxes)).item == 2);
        boxes[2] = {{0.0, 0.0, 0.0}, {0.0, 0.0, 5.0}};
        CHECK(error_of(Cells::boxes(boxes)).code == ErrorCode::degenerate);
        boxes[1].min.x = nan;
        CHECK(error_of(Cells::boxes(boxes)).item == 1);
    }

    TEST_CASE("a grid's cells fill its bounds, and each point is found in a cell that holds it, at any offset") {
        for (const double offset : {0.0, 1e3, 1e7}) {
            const glm::dvec3 o(offset, -offset, 0.5 * offset);
            const Aabb bounds{o + glm::dvec3(-3.0, 0.0, 2.0), o + glm::dvec3(4.0, 1.3, 9.1)};
            const Cells cells = Cells::grid(bounds, {7, 3, 11}).value();
            REQUIRE(cells.size() == 231);
            CHECK(cells.box(0).min == bounds.min);
            CHECK(cells.box(230).max == bounds.max);
            double volume = 0.0;
            for (std::size_t c = 0; c < cells.size(); ++c) {
                const glm::dvec3 e = cells.box(c).max - cells.box(c).min;
                volume += e.x * e.y * e.z;
                CHECK(cells.find(cells.box(c).center()) == c);
            }
            CHECK(volume == doctest::Approx(7.0 * 1.3 * 7.1).epsilon(1e-6));
            sampling::Random random(3);
            for (int i = 0; i < 1000; ++i) {
                const glm::dvec3 p = sampling::box_point(bounds, random.point<3>());
                const Aabb box = cells.box(cells.find(p));
                const double tolerance = 1e-15 * offset + 1e-12;
                for (int k = 0; k < 3; ++k) {
                    CHECK(p[k] >= box.min[k] - tolerance);
                    CHECK(p[k] <= box.max[k] + tolerance);
                }
            }
            CHECK(cells.find(bounds.max) == 230);
            CHECK(cells.find(bounds.min - glm::dvec3(0.1, 0.0, 0.0)) == kNoCell);
            CHECK(cells.find(glm::dvec3(std::numeric_limits<double>::quiet_NaN())) == kNoCell);
        }
    }

    TEST_CASE("of boxes that overlap the first holds the point") {
        const std::vector<Aabb> boxes = {{{0.0, 0.0, 0.0}, {2.0, 2.0, 2.0}}, {{1.0, 0.0, 0.0}, {3.0, 2.0, 2.0}}};
        const Cells cells = Cells::boxes(boxes).value();
        CHECK(cells.find({1.5, 1.0, 1.0}) == 0);
        CHECK(cells.find({2.5, 1.0, 1.0}) == 1);
        CHECK(cells.find({4.0, 1.0, 1.0}) == kNoCell);
    }
}
