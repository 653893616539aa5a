// SPDX-License-Identifier: MIT
// theory.md (6): the expected number of a polygon's triangles that a random frustum meets is affine in the weight.
#include <doctest/doctest.h>
#include <cmath>
#include <crofton/geometry/camera.hpp>
#include <crofton/measure/measure.hpp>
#include <crofton/sampling/sampling.hpp>
#include <crofton/triangulate/triangulate.hpp>
#include <glm/geometric.hpp>
#include <oracle/triangulation_check.hpp>

#include "polygons.hpp"

using namespace crofton;
using triangulate::Method;

namespace {

// A façade of 12 m × 8 m with a door and three rows of five windows, askew as old houses are.
Polygon facade() {
    Polygon p = test::polygon({{{0, 0}, {5.5, 0}, {5.5, 2.2}, {6.5, 2.2}, {6.5, 0}, {12, 0}, {12, 8}, {0, 8}}});
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 5; ++column) {
            if (row == 0 && column == 2) continue;
            const double x = 0.4 + 2.4 * column + 0.3 * row, y = 0.6 + 2.5 * row + 0.13 * column;
            for (const glm::dvec2 d : {glm::dvec2(0, 0), glm::dvec2(1, 0), glm::dvec2(1, 1.4), glm::dvec2(0, 1.4)})
                p.points.push_back(glm::dvec2(x, y) + d);
            p.ring_ends.push_back(static_cast<std::uint32_t>(p.points.size()));
        }
    }
    return p;
}

double perimeter(const Polygon& p) {
    double sum = 0.0;
    for (std::size_t r = 0; r < p.ring_count(); ++r) {
        const auto ring = p.ring(r);
        for (std::size_t i = 0; i < ring.size(); ++i) sum += glm::distance(ring[i], ring[(i + 1) % ring.size()]);
    }
    return sum;
}

}  // namespace

TEST_SUITE("triangulate/triangles_passed") {
    TEST_CASE("frusta meet as many triangles as formula (6) says, for all methods, and fewest for the minimum weight") {
        const Polygon polygon = facade();
        Camera camera;
        camera.fov_y = 0.9;
        camera.aspect = 1.5;
        camera.near_distance = 0.5;
        camera.far_distance = 12.0;
        const auto b = measure::intrinsic_volumes_of_frustum(camera);
        REQUIRE(b.has_value());
        // Every camera whose frustum may reach the façade stands in this box.
        const double half_far = camera.far_distance * std::tan(camera.fov_y / 2);
        const double radius = std::sqrt(camera.far_distance * camera.far_distance +
                                        half_far * half_far * (1.0 + camera.aspect * camera.aspect));
        const glm::dvec3 low(-radius, -radius, -radius), size(12.0 + 2 * radius, 8.0 + 2 * radius, 2 * radius);
        const double area = oracle::twice_polygon_area(polygon).get_d() / 2;
        struct Run {
            triangulate::Triangulation result;
            double sum = 0.0, square = 0.0;
        } runs[3];
        const Method methods[] = {Method::ear, Method::delaunay, Method::minimum_weight};
        for (int m = 0; m < 3; ++m) runs[m].result = *triangulate::triangulate(polygon, {.method = methods[m]});
        REQUIRE(runs[2].result.optimal);
        CHECK(runs[2].result.weight < runs[1].result.weight);
        sampling::Random random(6);
        constexpr int kFrusta = 20000;
        for (int trial = 0; trial < kFrusta; ++trial) {
            const glm::dmat3 rotation = sampling::rotation(random.point<3>());
            const auto u = random.point<3>();
            camera.position = low + size * glm::dvec3(u[0], u[1], u[2]);
            camera.forward = -rotation[2];
            camera.up = rotation[1];
            const auto frustum = frustum_of(camera);
            REQUIRE(frustum.has_value());
            for (Run& run : runs) {
                double passed = 0.0;
                for (const auto& t : run.result.triangles) {
                    passed += intersects(*frustum, glm::dvec3(polygon.points[t[0]], 0),
                                         glm::dvec3(polygon.points[t[1]], 0), glm::dvec3(polygon.points[t[2]], 0));
                }
                run.sum += passed;
                run.square += passed * passed;
            }
        }
        const double cell = size.x * size.y * size.z;
        for (const Run& run : runs) {
            const auto k = static_cast<double>(run.result.triangles.size());
            const double predicted =
                measure::triangles_met(*b, {k, area, perimeter(polygon), run.result.weight}) / cell;
            const double mean = run.sum / kFrusta;
            const double error = std::sqrt((run.square / kFrusta - mean * mean) / kFrusta);
            MESSAGE("weight " << run.result.weight << ", triangles passed: predicted " << predicted << ", measured "
                              << mean << " ± " << error);
            CHECK(std::fabs(mean - predicted) < 4.0 * error);
        }
        CHECK(runs[2].sum < runs[1].sum);
        CHECK(runs[1].sum < runs[0].sum);
    }
}
