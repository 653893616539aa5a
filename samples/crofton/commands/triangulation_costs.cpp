// SPDX-License-Identifier: MIT
#include "triangulation_costs.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <crofton/geometry/camera.hpp>
#include <crofton/measure/measure.hpp>
#include <crofton/render/clip_space.hpp>
#include <crofton/render/rasterizer.hpp>
#include <crofton/sampling/sampling.hpp>
#include <glm/geometric.hpp>
#include <numbers>

namespace crofton::cli {
namespace {

using Corners = std::array<glm::dvec2, 3>;

struct MeanOfCosts {
    double predicted = 0.0, measured = 0.0, squares = 0.0;

    void add(double expected, double counted) {
        predicted += expected;
        measured += counted;
        squares += (counted - expected) * (counted - expected);
    }
};

Comparison comparison_of(std::span<const MeanOfCosts> means, std::uint64_t trials) {
    Comparison result;
    const auto n = static_cast<double>(trials);
    for (const MeanOfCosts& m : means) {
        const double difference = (m.measured - m.predicted) / n;
        result.predicted.push_back(m.predicted / n);
        result.measured.push_back(m.measured / n);
        result.error.push_back(std::sqrt(std::max(0.0, m.squares / n - difference * difference) / n));
    }
    return result;
}

Corners corners_of(const TriangulatedPolygon& p, const std::array<std::uint32_t, 3>& t) {
    return {p.polygon.points[t[0]], p.polygon.points[t[1]], p.polygon.points[t[2]]};
}

double area_of(const Corners& c) {
    const glm::dvec2 u = c[1] - c[0], v = c[2] - c[0];
    return 0.5 * std::fabs(u.x * v.y - u.y * v.x);
}

double perimeter_of(const Corners& c) {
    return glm::distance(c[0], c[1]) + glm::distance(c[1], c[2]) + glm::distance(c[2], c[0]);
}

measure::TriangulationMeasures measures_of(const TriangulatedPolygon& p, std::size_t method) {
    measure::TriangulationMeasures sums;
    for (const auto& t : p.results[method].triangles) {
        const Corners c = corners_of(p, t);
        sums.triangles += 1.0;
        sums.area += area_of(c);
        sums.boundary += perimeter_of(c);
    }
    return sums;
}

// By separating axes: the square's sides and the triangle's.
bool meets_square(const Corners& c, const glm::dvec2& low) {
    const auto [left, right] = std::minmax({c[0].x, c[1].x, c[2].x});
    const auto [bottom, top] = std::minmax({c[0].y, c[1].y, c[2].y});
    if (right < low.x || left > low.x + 1.0 || top < low.y || bottom > low.y + 1.0) return false;
    const glm::dvec2 middle = low + 0.5;
    const glm::dvec2 d = c[1] - c[0], e = c[2] - c[0];
    const double turn = d.x * e.y - d.y * e.x > 0.0 ? 1.0 : -1.0;
    for (std::size_t i = 0; i < 3; ++i) {
        const glm::dvec2 side = c[(i + 1) % 3] - c[i], to = middle - c[i];
        if (turn * (side.x * to.y - side.y * to.x) < -0.5 * (std::fabs(side.x) + std::fabs(side.y))) return false;
    }
    return true;
}

bool covers(const Corners& c, const glm::dvec2& p) {
    int positive = 0, negative = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const glm::dvec2 side = c[(i + 1) % 3] - c[i], to = p - c[i];
        const double turn = side.x * to.y - side.y * to.x;
        positive += turn > 0.0;
        negative += turn < 0.0;
    }
    return positive == 0 || negative == 0;
}

// Squares of pixel centres have their corners at even coordinates and the ones after.
void count_quads(const Corners& c, double& met, double& covered) {
    const auto [left, right] = std::minmax({c[0].x, c[1].x, c[2].x});
    const auto [bottom, top] = std::minmax({c[0].y, c[1].y, c[2].y});
    for (double y = 2.0 * std::floor(bottom / 2.0 - 0.5); y <= top; y += 2.0) {
        for (double x = 2.0 * std::floor(left / 2.0 - 0.5); x <= right; x += 2.0) {
            const glm::dvec2 low(x, y);
            if (!meets_square(c, low)) continue;
            met += 1.0;
            covered += covers(c, low) || covers(c, low + glm::dvec2(1, 0)) || covers(c, low + glm::dvec2(0, 1)) ||
                       covers(c, low + 1.0);
        }
    }
}

}  // namespace

Comparison triangles_passed(std::span<const TriangulatedPolygon> polygons, std::uint64_t trials) {
    Camera camera;
    camera.fov_y = 0.9;
    camera.aspect = 1.5;
    camera.near_distance = 0.05;
    camera.far_distance = 1.0;
    const auto b = *measure::intrinsic_volumes_of_frustum(camera);
    // Every camera whose frustum may reach the polygon stands in this box.
    const double half = camera.far_distance * std::tan(camera.fov_y / 2);
    const double radius = std::sqrt(1.0 + half * half * (1.0 + camera.aspect * camera.aspect));
    const glm::dvec3 low(-radius), size(1.0 + 2.0 * radius, 1.0 + 2.0 * radius, 2.0 * radius);
    const double cell = size.x * size.y * size.z;
    const sampling::UnitPoints points(6);
    const std::size_t methods = polygons[0].results.size();
    std::vector<MeanOfCosts> means(methods);
    std::vector<std::vector<double>> expected;
    for (const auto& p : polygons) {
        expected.emplace_back();
        for (std::size_t m = 0; m < methods; ++m)
            expected.back().push_back(measure::triangles_met(b, measures_of(p, m)) / cell);
    }
    for (std::uint64_t i = 0; i < trials; ++i) {
        const std::size_t index = i % polygons.size();
        const TriangulatedPolygon& p = polygons[index];
        const auto u = points.at<6>(i);
        const glm::dmat3 rotation = sampling::rotation({u[0], u[1], u[2]});
        camera.position = low + size * glm::dvec3(u[3], u[4], u[5]);
        camera.forward = -rotation[2];
        camera.up = rotation[1];
        const auto frustum = frustum_of(camera);
        if (!frustum) continue;
        for (std::size_t m = 0; m < methods; ++m) {
            double passed = 0.0;
            for (const auto& t : p.results[m].triangles) {
                const Corners c = corners_of(p, t);
                passed += intersects(*frustum, glm::dvec3(c[0], 0.0), glm::dvec3(c[1], 0.0), glm::dvec3(c[2], 0.0));
            }
            means[m].add(expected[index][m], passed);
        }
    }
    return comparison_of(means, trials);
}

QuadComparison pixel_quads(std::span<const TriangulatedPolygon> polygons, std::uint64_t trials, double size) {
    const std::size_t methods = polygons[0].results.size();
    const sampling::UnitPoints points(7);
    std::vector<MeanOfCosts> means(methods);
    QuadComparison result;
    result.covered.assign(methods, 0.0);
    for (std::uint64_t i = 0; i < trials; ++i) {
        const TriangulatedPolygon& p = polygons[i % polygons.size()];
        const auto u = points.at<3>(i);
        const glm::dmat2 rotation = sampling::planar_rotation(u[0]);
        const glm::dvec2 offset(2.0 * u[1], 2.0 * u[2]);
        for (std::size_t m = 0; m < methods; ++m) {
            double expected = 0.0, met = 0.0, covered = 0.0;
            for (const auto& t : p.results[m].triangles) {
                Corners c = corners_of(p, t);
                for (auto& q : c) q = rotation * (size * q) + offset;
                expected += area_of(c) / 4.0 + perimeter_of(c) / (2.0 * std::numbers::pi) + 0.25;
                count_quads(c, met, covered);
            }
            means[m].add(expected, met);
            result.covered[m] += covered / static_cast<double>(trials);
        }
    }
    result.met = comparison_of(means, trials);
    return result;
}

Result<std::vector<DrawCost>> draw_wall(std::span<const TriangulatedPolygon> polygons, int frames) {
    render::DeviceOptions device_options;
    device_options.kind = render::DeviceKind::cpu;
    auto device = render::Device::create(device_options);
    if (!device) return device.error();
    auto rasterizer = render::Rasterizer::create(*device);
    if (!rasterizer) return rasterizer.error();
    const auto columns = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(polygons.size()))));
    const double side = 1.1 * static_cast<double>(columns);
    std::vector<DrawCost> result;
    for (std::size_t m = 0; m < polygons[0].results.size(); ++m) {
        Vector<render::Vertex> vertices;
        Vector<std::uint32_t> indices;
        for (std::size_t i = 0; i < polygons.size(); ++i) {
            const auto first = static_cast<std::uint32_t>(vertices.size());
            const glm::dvec2 at = 1.1 * glm::dvec2(static_cast<double>(i % columns), static_cast<double>(i / columns));
            for (const auto& q : polygons[i].polygon.points)
                vertices.push_back({glm::vec3(at + q, 0.0), {0.0f, 0.0f, 1.0f}, glm::vec3(0.6f)});
            for (const auto& t : polygons[i].results[m].triangles)
                for (const std::uint32_t corner : t) indices.push_back(first + corner);
        }
        if (auto set = rasterizer->set_geometry(vertices, indices); !set) return set.error();
        const render::DrawRange range{0, static_cast<std::uint32_t>(indices.size()), 0};
        sampling::Random random(8);
        DrawCost cost;
        std::vector<double> times;
        for (int f = 0; f < frames; ++f) {
            // Ten polygons fit into the picture's height; the camera looks a little askew.
            Camera camera;
            camera.position = {random.uniform(0.0, side), random.uniform(0.0, side), random.uniform(4.0, 10.0)};
            camera.forward = {random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), -1.0};
            camera.far_distance = 100.0;
            const render::DrawTransform transform =
                render::draw_transform(render::ModelToClip(camera)(glm::dmat3(1.0), glm::dvec3(0.0)), glm::dmat3(1.0));
            const auto start = std::chrono::steady_clock::now();
            const auto drawn = rasterizer->draw({camera, {&transform, 1}, {&range, 1}});
            if (!drawn) return drawn.error();
            times.push_back(
                std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
            cost.submitted += static_cast<double>(drawn->input_assembly_primitives) / frames;
            cost.clipped += static_cast<double>(drawn->clipping_primitives) / frames;
        }
        std::nth_element(times.begin(), times.begin() + frames / 2, times.end());
        cost.milliseconds = times[static_cast<std::size_t>(frames) / 2];
        result.push_back(cost);
    }
    return result;
}

}  // namespace crofton::cli
