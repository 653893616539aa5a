// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>
#include <crofton/measure/measure.hpp>
#include <crofton/sampling/sampling.hpp>
#include <crofton/study/planar_lines.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <vector>

using namespace crofton;
using namespace crofton::measure;
using namespace crofton::sampling;
using namespace crofton::study;
using std::numbers::pi;

namespace {

PlanarSupport disc(double x, double y, double r) {
    return PlanarSupport(Disc{{x, y}, r});
}

// (3) by the midpoint rule, straight from the definition.
double by_midpoints(const std::vector<PlanarSupport>& figures, int n) {
    double sum = 0.0;
    for (int i = 0; i < n; ++i) {
        const double phi = (i + 0.5) * pi / n;
        double near = 1e300, far = 1e300;
        for (const PlanarSupport& h : figures) near = std::min(near, h(phi)), far = std::min(far, h(phi + pi));
        sum += std::max(0.0, near + far) * pi / n;
    }
    return sum;
}

PlanarSupport random_figure(Random& random) {
    const glm::dvec2 at(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0));
    switch (random.bits() % 4) {
        case 0:
            return PlanarSupport(Disc{at, random.uniform(0.0, 1.5)});
        case 1:
            return PlanarSupport(Rectangle{at, circle_point(random.uniform()), {random.uniform(), random.uniform()}});
        case 2:
            return PlanarSupport(Rectangle{at, {1.0, 0.0}, {random.uniform(), 0.0}});
        default: {
            std::vector<glm::dvec2> points;
            for (int i = 0; i < 9; ++i) points.push_back(at + disc_point(random.point<2>()));
            return *PlanarSupport::of_hull(points);
        }
    }
}

}  // namespace

TEST_SUITE("study/planar_lines") {
    TEST_CASE("no figure leaves all lines, a point none, figures far apart those between them") {
        CHECK(measure_of_lines_hitting_all(std::span<const PlanarSupport>{}) ==
              std::numeric_limits<double>::infinity());
        const std::vector<PlanarSupport> point = {disc(3.0, 4.0, 0.0)};
        CHECK(std::abs(measure_of_lines_hitting_all(point)) < 1e-14);
        const std::vector<PlanarSupport> twice = {disc(3.0, 4.0, 0.0), disc(3.0, 4.0, 0.0)};
        CHECK(std::abs(measure_of_lines_hitting_all(twice)) < 1e-14);
        // Two discs of radius r at distance d: crossed minus open string, 2·(inner tangents − outer tangents + arcs).
        const double d = 10.0, r = 1.0, angle = std::asin(2.0 * r / d);
        const double crossed = 2.0 * std::sqrt(d * d - 4.0 * r * r) + 2.0 * r * (pi + 2.0 * angle),
                     open = 2.0 * d + 2.0 * pi * r;
        const std::vector<PlanarSupport> apart = {disc(0.0, 0.0, r), disc(d, 0.0, r)};
        CHECK(measure_of_lines_hitting_all(apart) == doctest::Approx(crossed - open).epsilon(1e-12));
    }

    TEST_CASE("three discs in a row are hit by fewer lines than the outer two, out of the row by none") {
        const std::vector<PlanarSupport> two = {disc(0.0, 0.0, 1.0), disc(10.0, 0.0, 1.0)};
        std::vector<PlanarSupport> three = two;
        three.push_back(disc(5.0, 0.9, 0.2));
        CHECK(measure_of_lines_hitting_all(three) < measure_of_lines_hitting_all(two));
        CHECK(measure_of_lines_hitting_all(three) > 0.0);
        three.push_back(disc(5.0, 1.5, 0.2));
        CHECK(measure_of_lines_hitting_all(three) == 0.0);
    }

    TEST_CASE("a single figure is hit by as many lines as its perimeter is long") {
        const std::vector<glm::dvec2> square = {{0.0, 0.0}, {2.0, 0.0}, {2.0, 2.0}, {0.0, 2.0}};
        CHECK(PlanarSupport::of_convex_polygon(square).integral() == doctest::Approx(8.0).epsilon(1e-14));
        CHECK(disc(5.0, -3.0, 2.0).integral() == doctest::Approx(4.0 * pi).epsilon(1e-14));
        for (const double turn : {0.0, 0.1, 0.25, 0.4, 0.5, 0.74, 0.75, 0.99}) {
            const PlanarSupport r(Rectangle{{3.0, 1.0}, circle_point(turn), {2.0, 0.5}});
            CHECK(r.integral() == doctest::Approx(10.0).epsilon(1e-14));
        }
        const std::vector<glm::dvec2> segment = {{1.0, 1.0}, {4.0, 5.0}};
        CHECK(PlanarSupport::of_convex_polygon(segment).integral() == doctest::Approx(10.0).epsilon(1e-14));
    }

    TEST_CASE("a nearly straight row of corners has the perimeter of its sides, however its angles are rounded") {
        for (int i = 0; i < 20'000; ++i) {
            Random random(2, static_cast<std::uint64_t>(i));
            const double bulge = std::pow(10.0, random.uniform(-18.0, -8.0));
            std::vector<glm::dvec2> points;
            for (std::size_t k = 2 + random.bits() % 12; k > 0; --k) {
                const double y = random.uniform(-1.0, 1.0);
                points.push_back({-bulge * y * y, y});
                for (int quarter = 0; quarter < i % 4; ++quarter) points.back() = {-points.back().y, points.back().x};
            }
            const auto corners = *convex_hull(points);
            double sides = 0.0;
            for (std::size_t k = 0; k < corners.size(); ++k)
                sides += glm::distance(corners[k], corners[(k + 1) % corners.size()]);
            CHECK(std::abs(PlanarSupport::of_convex_polygon(corners).integral() - sides) < 1e-13);
        }
    }

    TEST_CASE("support values are those of the farthest point") {
        Random random(1);
        for (int trial = 0; trial < 200; ++trial) {
            std::vector<glm::dvec2> points;
            for (int i = 0; i < 1 + trial % 12; ++i)
                points.push_back(disc_point(random.point<2>()) + glm::dvec2(0.5, 2.0));
            const PlanarSupport h = *PlanarSupport::of_hull(points);
            for (int i = 0; i < 40; ++i) {
                const double phi = random.uniform(-7.0, 7.0);
                double farthest = -1e300;
                for (const glm::dvec2& p : points)
                    farthest = std::max(farthest, p.x * std::cos(phi) + p.y * std::sin(phi));
                CHECK(h(phi) == doctest::Approx(farthest).epsilon(1e-12));
            }
        }
    }

    TEST_CASE("for two figures that meet it is L1 + L2 - L_hull, the paper's (7)") {
        Random random(2);
        int met = 0;
        for (int trial = 0; trial < 500; ++trial) {
            const std::vector<PlanarSupport> two = {random_figure(random), random_figure(random)};
            // They meet iff no direction separates them; sampled directions leave a margin.
            double gap = 1e300;
            for (int i = 0; i < 720; ++i) gap = std::min(gap, two[0](i * pi / 360.0) + two[1](i * pi / 360.0 + pi));
            if (gap < 0.05) continue;
            ++met;
            const double expected = two[0].integral() + two[1].integral() - max(two[0], two[1]).integral();
            CHECK(measure_of_lines_hitting_all(two) == doctest::Approx(expected).epsilon(1e-12));
        }
        CHECK(met > 50);
    }

    TEST_CASE("agrees with the midpoint rule for any mixture of figures") {
        Random random(3);
        for (int trial = 0; trial < 200; ++trial) {
            std::vector<PlanarSupport> figures;
            for (int i = 0; i < 2 + trial % 5; ++i) figures.push_back(random_figure(random));
            CHECK(std::abs(measure_of_lines_hitting_all(figures) - by_midpoints(figures, 4000)) < 2e-5);
        }
    }

    TEST_CASE("arcs and tangents, the paper's (9), agree for discs that overlap, nest or stand apart") {
        Random random(4);
        for (int trial = 0; trial < 500; ++trial) {
            std::vector<Disc> discs;
            std::vector<PlanarSupport> figures;
            const double spread = trial % 2 ? 1.0 : 4.0;
            for (int i = 0; i < 1 + trial % 7; ++i) {
                discs.push_back({spread * disc_point(random.point<2>()), random.uniform(0.0, 2.0)});
                figures.emplace_back(discs.back());
            }
            CHECK(std::abs(measure_of_lines_hitting_all(figures) - measure_of_lines_by_tangents(discs)) < 1e-11);
        }
    }

    TEST_CASE("motions change nothing, scaling scales, and a further figure never adds lines") {
        Random random(5);
        for (int trial = 0; trial < 100; ++trial) {
            std::vector<PlanarSupport> here, there;
            const glm::dmat2 turn = planar_rotation(random.uniform());
            const glm::dvec2 shift(random.uniform(-9.0, 9.0), random.uniform(-9.0, 9.0));
            double last = std::numeric_limits<double>::infinity();
            for (int k = 0; k < 6; ++k) {
                std::vector<glm::dvec2> points, moved;
                for (int i = 0; i < 7; ++i) {
                    points.push_back(disc_point(random.point<2>()) + 0.2 * glm::dvec2(k));
                    moved.push_back(3.0 * (turn * points.back()) + shift);
                }
                here.push_back(*PlanarSupport::of_hull(points));
                there.push_back(*PlanarSupport::of_hull(moved));
                const double value = measure_of_lines_hitting_all(here);
                CHECK(value <= last + 1e-12);
                CHECK(measure_of_lines_hitting_all(there) == doctest::Approx(3.0 * value).epsilon(1e-10));
                last = value;
            }
        }
    }

    TEST_CASE("the envelope of n discs has at most 2n pieces and is below each of them") {
        Random random(6);
        std::vector<PlanarSupport> discs;
        for (int i = 0; i < 1000; ++i)
            discs.push_back(PlanarSupport(Disc{disc_point(random.point<2>()), 2.0 + random.uniform()}));
        const PlanarSupport envelope = lower_envelope(discs);
        CHECK(envelope.pieces().size() <= 2001);
        for (int i = 0; i < 500; ++i) {
            const double phi = i * pi / 250.0;
            double least = 1e300;
            for (const PlanarSupport& h : discs) least = std::min(least, h(phi));
            CHECK(envelope(phi) == doctest::Approx(least).epsilon(1e-12));
        }
    }
}
