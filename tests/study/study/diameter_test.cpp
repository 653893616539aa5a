// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <cmath>
#include <crofton/sampling/sampling.hpp>
#include <crofton/study/convex_body.hpp>
#include <crofton/study/diameter.hpp>
#include <error_of.hpp>
#include <glm/geometric.hpp>
#include <numbers>
#include <vector>

using namespace crofton;

namespace {

template <class Point>
double largest_distance(const std::vector<Point>& points) {
    double best = 0.0;
    for (const Point& a : points)
        for (const Point& b : points) best = std::max(best, glm::distance(a, b));
    return best;
}

template <class Point>
Result<study::Diameter<Point>> diameter_of(const std::vector<Point>& points) {
    return study::diameter(std::span<const Point>(points));
}

}  // namespace

TEST_SUITE("study/diameter") {
    TEST_CASE("no points, NaN and coordinates beyond 1e30 have no diameter, and the point is named") {
        CHECK(error_of(study::diameter(std::span<const glm::dvec2>())).code == ErrorCode::empty);
        CHECK(error_of(study::diameter(std::span<const glm::dvec3>())).code == ErrorCode::empty);
        std::vector<glm::dvec2> plane(4, glm::dvec2(1.0));
        plane[2].y = std::nan("");
        CHECK(error_of(diameter_of(plane)).item == 2);
        plane[2].y = -1e31;
        CHECK(error_of(diameter_of(plane)).code == ErrorCode::out_of_range);
        std::vector<glm::dvec3> space(4, glm::dvec3(1.0));
        space[3].z = HUGE_VAL;
        CHECK(error_of(diameter_of(space)).item == 3);
    }

    TEST_CASE("one point, equal points and points of a line") {
        CHECK(diameter_of(std::vector<glm::dvec2>(1, glm::dvec2(3.0)))->length == 0.0);
        CHECK(diameter_of(std::vector<glm::dvec3>(5, glm::dvec3(-1e20)))->length == 0.0);
        CHECK(diameter_of(std::vector<glm::dvec2>{{0, 0}, {3, 4}, {1.5, 2}})->length == 5.0);
        CHECK(diameter_of(std::vector<glm::dvec3>{{0, 0, 0}, {1, 2, 2}, {0.5, 1, 1}})->length == 3.0);
    }

    TEST_CASE("the diagonals of rectangles and boxes, however turned") {
        for (int i = 0; i < 200; ++i) {
            sampling::Random random(3, static_cast<std::uint64_t>(i));
            const glm::dmat3 turn = sampling::rotation(random.point<3>());
            const glm::dmat2 planar = sampling::planar_rotation(random.uniform());
            const glm::dvec3 half(random.uniform(0.1, 2.0), random.uniform(0.1, 2.0), random.uniform(0.0, 2.0));
            std::vector<glm::dvec3> box;
            std::vector<glm::dvec2> rectangle;
            for (int c = 0; c < 8; ++c) {
                const glm::dvec3 corner(c & 1 ? half.x : -half.x, c & 2 ? half.y : -half.y, c & 4 ? half.z : -half.z);
                box.push_back(turn * corner);
                rectangle.push_back(planar * glm::dvec2(corner));
            }
            CHECK(diameter_of(box)->length == doctest::Approx(2.0 * glm::length(half)).epsilon(1e-12));
            CHECK(diameter_of(rectangle)->length ==
                  doctest::Approx(2.0 * glm::length(glm::dvec2(half))).epsilon(1e-12));
        }
    }

    TEST_CASE("corners a rounding apart hide no farther ones: clusters of up to five such points") {
        for (int i = 0; i < 20'000; ++i) {
            sampling::Random random(5, static_cast<std::uint64_t>(i));
            std::vector<glm::dvec2> points;
            for (std::size_t cluster = 3 + random.bits() % 6; cluster > 0; --cluster) {
                const glm::dvec2 center(random.uniform(), random.uniform());
                for (std::size_t k = 1 + random.bits() % 5; k > 0; --k) {
                    points.push_back(center);
                    for (std::size_t step = random.bits() % 5; step > 0; --step) {
                        double& x = points.back()[static_cast<int>(random.bits() % 2)];
                        x = std::nextafter(x, random.bits() % 2 ? 2.0 : -2.0);
                    }
                }
            }
            CHECK(diameter_of(points)->length == doctest::Approx(largest_distance(points)).epsilon(1e-14));
        }
    }

    TEST_CASE("the diameter of points a rounding from a line") {
        for (int i = 0; i < 5000; ++i) {
            sampling::Random random(6, static_cast<std::uint64_t>(i));
            std::vector<glm::dvec2> points;
            for (std::size_t k = 2 + random.bits() % 30; k > 0; --k) {
                const double t = random.uniform(-1.0, 1.0);
                points.push_back({0.3 * t, 0.5 * t});
            }
            CHECK(diameter_of(points)->length == doctest::Approx(largest_distance(points)).epsilon(1e-14));
        }
    }

    TEST_CASE("coordinates whose squares are no doubles any more") {
        for (const double s : {0x1p-500, 0x1p-530, 0x1p-1000, 0x1p-1074}) {
            const auto flat = diameter_of(std::vector<glm::dvec2>{{0, 0}, {3 * s, 0}, {3 * s, 4 * s}, {0, 4 * s}});
            CHECK(flat->length == 5 * s);
            CHECK(glm::abs(flat->to - flat->from) == glm::dvec2(3 * s, 4 * s));
            const auto solid =
                diameter_of(std::vector<glm::dvec3>{{0, 0, 0}, {s, 0, 0}, {s, 2 * s, 0}, {s, 2 * s, 2 * s}});
            CHECK(solid->length == 3 * s);
            CHECK(glm::abs(solid->to - solid->from) == glm::dvec3(s, 2 * s, 2 * s));
        }
    }

    TEST_CASE("the largest of all distances, and the largest breadth, of 2,000 random sets") {
        for (int i = 0; i < 2000; ++i) {
            sampling::Random random(4, static_cast<std::uint64_t>(i));
            const std::size_t count = 2 + random.bits() % 40;
            const bool round = i % 3 == 0;  // all points are corners
            std::vector<glm::dvec2> plane;
            std::vector<glm::dvec3> space;
            for (std::size_t k = 0; k < count; ++k) {
                plane.push_back(round ? sampling::circle_point(random.uniform())
                                      : glm::dvec2(1.0, 0.3) * sampling::disc_point(random.point<2>()));
                space.push_back(round ? sampling::direction(random.point<2>())
                                      : glm::dvec3(1.0, 0.5, 0.1) * sampling::ball_point(random.point<3>()));
            }
            const auto flat = diameter_of(plane);
            const auto solid = diameter_of(space);
            REQUIRE(flat.has_value());
            REQUIRE(solid.has_value());
            CHECK(flat->length == doctest::Approx(largest_distance(plane)).epsilon(1e-14));
            CHECK(solid->length == doctest::Approx(largest_distance(space)).epsilon(1e-14));
            study::ConvexBody body;
            body.points.assign(space.begin(), space.end());
            CHECK(breadth(body, (solid->to - solid->from) / solid->length) ==
                  doctest::Approx(solid->length).epsilon(1e-12));
            for (int n = 0; n < 10; ++n)
                CHECK(breadth(body, sampling::direction(random.point<2>())) <= solid->length * (1.0 + 1e-12));
        }
    }
}
