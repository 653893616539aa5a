// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>
#include <counting_memory.hpp>
#include <crofton/geometry/predicates.hpp>
#include <error_of.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "bake_geometry.hpp"

using namespace crofton;
using namespace crofton::pvs;
using namespace crofton::testing;

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

    TEST_CASE("convex cells without a volume, without finite corners or without number are named errors") {
        sampling::Random random(1);
        std::vector<ConvexCell> cells(3, random_cell(random, {}, 1.0));
        CHECK(error_of(Cells::convex({})).code == ErrorCode::empty);
        cells[2].corners[7].y = std::numeric_limits<double>::infinity();
        CHECK(error_of(Cells::convex(cells)).code == ErrorCode::non_finite);
        CHECK(error_of(Cells::convex(cells)).item == 2);
        cells[1].corners.fill({1.0, 2.0, 3.0});
        CHECK(error_of(Cells::convex(cells)).code == ErrorCode::degenerate);
        CHECK(error_of(Cells::convex(cells)).item == 1);
        for (std::size_t i = 0; i < 8; ++i)
            cells[1].corners[i] = {static_cast<double>(i % 3), 0.5 * static_cast<double>(i / 3), 4.0};
        CHECK(error_of(Cells::convex(cells)).item == 1);
        for (std::size_t i = 0; i < 8; ++i) cells[1].corners[i] = static_cast<double>(i) * glm::dvec3(1.0, 2.0, 3.0);
        CHECK(error_of(Cells::convex(cells)).item == 1);
    }

    TEST_CASE("convex cells have the surfaces of cubes, prisms and tetrahedra, and a cube is found as its box is") {
        for (const double offset : {0.0, 1e7}) {
            const glm::dvec3 o = offset * glm::dvec3(1.0, -0.7, 0.3);
            ConvexCell cube, prism, tetrahedron;
            for (unsigned i = 0; i < 8; ++i)
                cube.corners[i] = o + glm::dvec3(i & 1 ? 2.0 : 0.0, i & 2 ? 3.0 : 0.0, i & 4 ? 4.0 : 0.0);
            const glm::dvec3 tips[] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
            const glm::dvec3 base[] = {{0, 0, 0}, {3, 0, 0}, {0, 0, 4}};
            for (std::size_t i = 0; i < 8; ++i) {
                prism.corners[i] = o + base[i % 3] + (i % 2 ? glm::dvec3(0.0, 2.0, 0.0) : glm::dvec3(0.0));
                tetrahedron.corners[i] = o + tips[i % 4];
            }
            const Cells cells = Cells::convex(std::vector<ConvexCell>{cube, prism, tetrahedron}).value();
            REQUIRE(cells.is_convex());
            CHECK_FALSE(cells.is_grid());
            const double epsilon = offset > 0.0 ? 1e-8 : 1e-14;
            CHECK(cells.surface(0) == doctest::Approx(2.0 * (6.0 + 12.0 + 8.0)).epsilon(epsilon));
            CHECK(cells.surface(1) == doctest::Approx(2.0 * 6.0 + 2.0 * (3.0 + 4.0 + 5.0)).epsilon(epsilon));
            CHECK(cells.surface(2) == doctest::Approx(std::sqrt(3.0) * 8.0).epsilon(epsilon));
            CHECK(cells.planes(0).size() == 6);
            CHECK(cells.planes(1).size() == 5);
            CHECK(cells.planes(2).size() == 4);
            // Corners in the middle of an edge change nothing.
            ConvexCell marked = prism;
            marked.corners[6] = 0.5 * (prism.corners[0] + prism.corners[2]);
            marked.corners[7] = 0.5 * (prism.corners[1] + prism.corners[3]);
            const Cells again = Cells::convex(std::vector<ConvexCell>{marked}).value();
            CHECK(again.planes(0).size() == 5);
            CHECK(again.surface(0) == doctest::Approx(cells.surface(1)).epsilon(epsilon));
            const Cells box = Cells::boxes(std::vector<Aabb>{cells.box(0)}).value();
            CHECK(box.surface(0) == doctest::Approx(52.0).epsilon(epsilon));
            sampling::Random random(2);
            for (int i = 0; i < 1000; ++i) {
                const Aabb around{cells.box(0).min - 0.5, cells.box(0).max + 0.5};
                const glm::dvec3 p = sampling::box_point(around, random.point<3>());
                CHECK((cells.find(p) == 0) == (box.find(p) == 0));
            }
        }
    }

    TEST_CASE("a point is found in the first convex cell that holds it, by exact orientations") {
        sampling::Random random(4);
        for (const double offset : {0.0, 1e3, 1e7}) {
            std::vector<ConvexCell> convex;
            for (int i = 0; i < 60; ++i) {
                const double x = random.uniform(-4.0, 4.0), y = random.uniform(-1.0, 1.0),
                             z = random.uniform(-4.0, 4.0);
                convex.push_back(random_cell(random, glm::dvec3(offset) + glm::dvec3(x, y, z), 1.5));
            }
            const Cells cells = Cells::convex(convex).value();
            // 1 within by more than rounding, -1 outside, 0 too near to a plane.
            const auto side_of = [&](const ConvexCell& cell, const glm::dvec3& p) {
                int result = 1;
                const auto& c = cell.corners;
                for (std::size_t i = 0; i < 8; ++i)
                    for (std::size_t j = i + 1; j < 8; ++j)
                        for (std::size_t k = j + 1; k < 8; ++k) {
                            bool above = false, below = false;
                            const glm::dvec3 across = glm::cross(c[j] - c[i], c[k] - c[i]);
                            const double size = glm::length(across);
                            if (size < 1e-6) continue;
                            for (const glm::dvec3& q : c) {
                                if (std::abs(glm::dot(across, q - c[i])) < 1e-7 * size) continue;
                                (orientation(c[i], c[j], c[k], q) > 0 ? above : below) = true;
                            }
                            if (above == below) continue;
                            const double height = glm::dot(across, p - c[i]) / size;
                            if (std::abs(height) < 1e-6)
                                result = std::min(result, 0);
                            else if ((orientation(c[i], c[j], c[k], p) > 0) != above)
                                result = -1;
                        }
                return result;
            };
            int inside = 0, outside = 0;
            for (int n = 0; n < 1500; ++n) {
                const glm::dvec3 p = sampling::box_point(cells.bounds(), random.point<3>());
                std::uint32_t truth = kNoCell;
                bool known = true;
                for (std::uint32_t i = 0; i < convex.size() && known && truth == kNoCell; ++i) {
                    const int side = side_of(convex[i], p);
                    known = side != 0;
                    if (side > 0) truth = i;
                }
                if (!known) continue;
                CHECK(cells.find(p) == truth);
                ++(truth == kNoCell ? outside : inside);
            }
            CHECK(inside > 100);
            CHECK(outside > 300);
        }
    }

    TEST_CASE("boxes that all lie on each other take no more memory than some words each") {
        const std::vector<Aabb> boxes(40'000, Aabb{{0.0, 0.0, 0.0}, {1.0, 2.0, 3.0}});
        const CountingMemory memory;
        const auto cells = Cells::boxes(boxes).value();
        CHECK(memory.bytes_in_use() < 400 * boxes.size());
        CHECK(cells.find({0.5, 0.5, 0.5}) == 0);
        CHECK(cells.find({0.5, 2.5, 0.5}) == kNoCell);
    }

    TEST_CASE("the first of overlapping boxes contains the point") {
        const std::vector<Aabb> boxes = {{{0.0, 0.0, 0.0}, {2.0, 2.0, 2.0}}, {{1.0, 0.0, 0.0}, {3.0, 2.0, 2.0}}};
        const Cells cells = Cells::boxes(boxes).value();
        CHECK(cells.find({1.5, 1.0, 1.0}) == 0);
        CHECK(cells.find({2.5, 1.0, 1.0}) == 1);
        CHECK(cells.find({4.0, 1.0, 1.0}) == kNoCell);
    }
}
