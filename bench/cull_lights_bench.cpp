// SPDX-License-Identifier: MIT
// Lights against froxels, beside the tests that others use: how long, and how many pairs too many.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/cull/lights.hpp>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <random>
#include <vector>

namespace {

using namespace crofton;

// 16×9×24 over a view of 60 degrees from 0.1 to 200; lights anywhere in it, of `radius` ½ to 1½ times.
struct Scene {
    Camera camera;
    cull::FroxelGrid grid;
    std::vector<Sphere> points;
    std::vector<cull::SpotLight> spots;

    Scene(std::size_t point_count, std::size_t spot_count, double radius) {
        camera.near_distance = 0.1;
        camera.far_distance = 200.0;
        grid = *cull::FroxelGrid::build(camera);
        std::mt19937_64 random(7);
        const auto number = [&](double low, double high) {
            return low + (high - low) * std::ldexp(static_cast<double>(random() >> 11), -53);
        };
        const double half = std::tan(0.5 * camera.fov_y);
        const auto place = [&] {
            const double depth = 200.0 * std::cbrt(number(0.0, 1.0));
            return glm::dvec3(number(-1.0, 1.0) * half * camera.aspect * depth, number(-1.0, 1.0) * half * depth,
                              -depth);
        };
        for (std::size_t i = 0; i < point_count; ++i) points.push_back({place(), radius * number(0.5, 1.5)});
        for (std::size_t i = 0; i < spot_count; ++i)
            spots.push_back({place(),
                             {static_cast<float>(number(-1.0, 1.0)), static_cast<float>(number(-1.0, 1.0)),
                              static_cast<float>(number(-1.0, 1.0))},
                             static_cast<float>(number(0.5, 0.95)),
                             static_cast<float>(2.0 * radius * number(0.5, 1.5))});
    }
};

void froxel_lights(benchmark::State& state, std::size_t points, std::size_t spots, double radius) {
    const Scene scene(points, spots, radius);
    cull::FroxelLights lights;
    (void)cull::find_lights(scene.grid, scene.points, scene.spots, lights);
    for (auto _ : state) (void)cull::find_lights(scene.grid, scene.points, scene.spots, lights);
    state.counters["pairs"] = static_cast<double>(lights.lights().size());
    state.counters["exact"] = static_cast<double>(lights.exact_tests());
}
BENCHMARK_CAPTURE(froxel_lights, 10k_points_2m, 10000, 0, 2.0)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(froxel_lights, 10k_points_5m, 10000, 0, 5.0)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(froxel_lights, 5k_points_5k_spots_2m, 5000, 5000, 2.0)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(froxel_lights, 10k_spots_2m, 0, 10000, 2.0)->Unit(benchmark::kMillisecond);

// Tests as other engines do: a froxel's axis-aligned box in view space against the sphere, its bounding sphere against
// the cone.
struct Cell {
    glm::dvec3 low, high, center;
    double radius;
};

std::vector<Cell> cells_of(const cull::FroxelGrid& grid) {
    std::vector<Cell> cells;
    for (std::uint32_t f = 0; f < grid.size(); ++f) {
        Cell cell{glm::dvec3(1e30), glm::dvec3(-1e30), glm::dvec3(0.0), 0.0};
        const std::array<glm::dvec3, 8> corners = frustum_corners(grid.froxel(f)).value();
        for (const glm::dvec3& corner : corners) {
            cell.low = glm::min(cell.low, corner);
            cell.high = glm::max(cell.high, corner);
        }
        cell.center = 0.5 * (cell.low + cell.high);
        for (const glm::dvec3& corner : corners) cell.radius = std::max(cell.radius, glm::length(corner - cell.center));
        cells.push_back(cell);
    }
    return cells;
}

// Wronski's test, as in Frostbite and others.
bool sphere_meets_cone(const Cell& cell, const cull::SpotLight& spot, const glm::dvec3& axis) {
    const glm::dvec3 v = cell.center - spot.apex;
    const double square = glm::dot(v, v), along = glm::dot(v, axis), cosine = static_cast<double>(spot.cos_half_angle);
    const double off =
        cosine * std::sqrt(std::max(0.0, square - along * along)) - along * std::sqrt(1.0 - cosine * cosine);
    return off <= cell.radius && along <= cell.radius + static_cast<double>(spot.range) && along >= -cell.radius;
}

// One pass over all pairs; the counter says how many more pairs than there are.
void usual_tests(benchmark::State& state, std::size_t points, std::size_t spots, double radius) {
    const Scene scene(points, spots, radius);
    const std::vector<Cell> cells = cells_of(scene.grid);
    cull::FroxelLights lights;
    (void)cull::find_lights(scene.grid, scene.points, scene.spots, lights);
    std::size_t pairs = 0;
    for (auto _ : state) {
        pairs = 0;
        for (const Sphere& point : scene.points)
            for (const Cell& cell : cells) {
                const glm::dvec3 off = point.center - glm::clamp(point.center, cell.low, cell.high);
                pairs += glm::dot(off, off) <= point.radius * point.radius;
            }
        for (const cull::SpotLight& spot : scene.spots) {
            const glm::dvec3 axis = glm::normalize(glm::dvec3(spot.axis));
            for (const Cell& cell : cells) pairs += sphere_meets_cone(cell, spot, axis);
        }
    }
    state.counters["pairs"] = static_cast<double>(pairs);
    state.counters["times_as_many"] = static_cast<double>(pairs) / static_cast<double>(lights.lights().size());
}
BENCHMARK_CAPTURE(usual_tests, sphere_aabb_2m, 10000, 0, 2.0)->Unit(benchmark::kMillisecond)->Iterations(1);
BENCHMARK_CAPTURE(usual_tests, sphere_aabb_5m, 10000, 0, 5.0)->Unit(benchmark::kMillisecond)->Iterations(1);
BENCHMARK_CAPTURE(usual_tests, cone_sphere_2m, 0, 10000, 2.0)->Unit(benchmark::kMillisecond)->Iterations(1);

}  // namespace
