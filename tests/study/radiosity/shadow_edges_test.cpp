// SPDX-License-Identifier: MIT
// Cutting where shadows of the sun end: a plate above the ground, whose shadow is a rectangle.
#include <doctest/doctest.h>
#include <array>
#include <cmath>
#include <crofton/lines/lines.hpp>
#include <crofton/radiosity/patches.hpp>
#include <error_of.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "shapes.hpp"

using namespace crofton;
using namespace crofton::lines;
using namespace crofton::radiosity;

namespace {

const glm::dvec3 kToSun(0.5, 1.0, 0.25);
constexpr double kHeight = 2.0;

// Ground of 10 × 10 with edges of at most 0.5, and a plate of 2 × 3 above it that is seen from below and above.
TriangleMesh ground_and_plate() {
    shapes::Shape scene;
    scene.parallelogram({0, 0, 0}, {0, 0, 10}, {10, 0, 0}, 0);
    scene.parallelogram({4.03f, kHeight, 3.02f}, {0, 0, 3}, {2, 0, 0}, 1);
    scene.parallelogram({4.03f, kHeight, 3.02f}, {2, 0, 0}, {0, 0, 3}, 1);
    return refine(scene.mesh, 0.5)->mesh;
}

bool in_shadow(const glm::dvec3& p) {
    const glm::dvec3 q = p + kHeight * kToSun;
    return q.x > 4.03f && q.x < 6.03f && q.z > 3.02f && q.z < 6.02f;
}

struct Ground {
    double wrong = 0.0;  // area whose label is not what it is in
    double area = 0.0;
    std::size_t triangles = 0;
};

// By 15 · 15 / 2 points of each triangle.
Ground judge(const TriangleMesh& mesh, std::span<const std::uint32_t> lit) {
    Ground ground;
    for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
        const auto at = [&](std::size_t k) { return glm::dvec3(mesh.positions[mesh.indices[3 * t + k]]); };
        if (at(0).y != 0.0) continue;
        ++ground.triangles;
        const double area = 0.5 * glm::length(glm::cross(at(1) - at(0), at(2) - at(0)));
        int wrong = 0, all = 0;
        for (int i = 0; i < 15; ++i)
            for (int j = 0; i + j < 15; ++j, ++all) {
                const double u = (i + 1.0 / 3.0) / 15.0, v = (j + 1.0 / 3.0) / 15.0;
                wrong += in_shadow(at(0) + u * (at(1) - at(0)) + v * (at(2) - at(0))) == (lit[t] != 0) ? 1 : 0;
            }
        ground.wrong += area * wrong / all;
        ground.area += area;
    }
    return ground;
}

}  // namespace

TEST_SUITE("radiosity/shadow edges") {
    TEST_CASE("each halving makes the shadow of a plate twice as sharp, where it ends and nowhere else") {
        const TriangleMesh mesh = ground_and_plate();
        const std::size_t border = shapes::unmatched_edges(mesh);
        const double around = 2.0 * (2.0 + 3.0);
        double before = 0.0;
        std::size_t triangles = 0;
        for (const std::uint32_t halvings : {0u, 1u, 2u, 3u, 4u}) {
            const auto cut = refine_at_shadows(mesh, 3.0 * kToSun, halvings);
            REQUIRE(cut.has_value());
            const auto lit = sunlit_triangles(cut->mesh, kToSun).value();
            // A tracer of the mesh that was cut says the same.
            const LineTracer scene = LineTracer::build(mesh).value();
            const auto cut_with_tracer = refine_at_shadows(scene, mesh, 3.0 * kToSun, halvings).value();
            CHECK(cut_with_tracer.source == cut->source);
            CHECK(sunlit_triangles(scene, cut->mesh, kToSun).value() == lit);
            const Ground ground = judge(cut->mesh, lit);
            INFO("halvings ", halvings, " wrong ", ground.wrong, " triangles ", ground.triangles);
            CHECK(ground.area == doctest::Approx(100.0).epsilon(1e-6));
            CHECK(shapes::unmatched_edges(cut->mesh) == border);
            // A triangle of which a straight edge cuts off a part has at most 4/9 of its area beyond its center's side.
            const double longest = 0.5 / (1u << halvings);
            CHECK(ground.wrong <= around * longest);
            if (halvings > 0) {
                CHECK(ground.wrong <= 0.6 * before);
                // What is cut anew lies along the shadow's edge, and its neighbours: some triangles a stretch.
                CHECK(ground.triangles - triangles <= 12.0 * around / longest);
            }
            if (halvings == 1) {
                std::vector<int> parts(mesh.triangle_count(), 0);
                for (const std::uint32_t source : cut->source) ++parts[source];
                for (std::size_t t = 0; t < parts.size(); ++t) {
                    const auto at = [&](std::size_t k) { return glm::dvec3(mesh.positions[mesh.indices[3 * t + k]]); };
                    const glm::dvec3 middle = (at(0) + at(1) + at(2)) / 3.0;
                    if (middle.y != 0.0) continue;
                    const auto dark = [&](std::size_t k) { return in_shadow(at(k) + 0.06 * (middle - at(k))); };
                    if (dark(0) != dark(1) || dark(1) != dark(2)) CHECK(parts[t] == 4);
                }
            }
            before = ground.wrong, triangles = ground.triangles;
            for (std::size_t t = 0; t < cut->source.size(); ++t) {
                const auto of = [](const TriangleMesh& m, std::size_t i) {
                    const auto at = [&](std::size_t k) { return glm::dvec3(m.positions[m.indices[3 * i + k]]); };
                    return std::array{at(0), at(1), at(2)};
                };
                const auto [a, b, c] = of(mesh, cut->source[t]);
                const auto [p, q, r] = of(cut->mesh, t);
                const glm::dvec3 middle = (p + q + r) / 3.0, normal = glm::cross(b - a, c - a);
                const double least = -1e-6 * glm::dot(normal, normal);
                CHECK(glm::dot(glm::cross(b - a, middle - a), normal) >= least);
                CHECK(glm::dot(glm::cross(c - b, middle - b), normal) >= least);
                CHECK(glm::dot(glm::cross(a - c, middle - c), normal) >= least);
            }
        }
    }

    TEST_CASE("triangles that face away are dark and not cut, and without a shadow there is no cut") {
        const TriangleMesh mesh = ground_and_plate();
        const auto below = refine_at_shadows(mesh, {0.0, -1.0, 0.0}, 5).value();
        CHECK(below.mesh.indices == mesh.indices);
        const auto dark = sunlit_triangles(mesh, {0.0, -1.0, 0.0});
        for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
            const glm::vec3& p = mesh.positions[mesh.indices[3 * t]];
            if (p.y == 0.0f) CHECK((*dark)[t] == 0);
        }
        shapes::Shape alone;
        alone.parallelogram({0, 0, 0}, {0, 0, 10}, {10, 0, 0}, 0);
        const auto bare = refine_at_shadows(alone.mesh, kToSun, 5).value();
        CHECK(bare.mesh.indices == alone.mesh.indices);
        const auto bright = sunlit_triangles(alone.mesh, kToSun);
        CHECK(*bright == Vector<std::uint32_t>{1, 1});
    }

    TEST_CASE("a house on the ground: its own sides in the sun are not cut") {
        shapes::Shape scene;
        scene.parallelogram({0, 0, 0}, {0, 0, 10}, {10, 0, 0}, 0);
        scene.parallelogram({4, 0, 6}, {2, 0, 0}, {0, 2, 0}, 1);   // to z
        scene.parallelogram({6, 0, 6}, {0, 0, -2}, {0, 2, 0}, 1);  // to x
        scene.parallelogram({6, 0, 4}, {-2, 0, 0}, {0, 2, 0}, 1);
        scene.parallelogram({4, 0, 4}, {0, 0, 2}, {0, 2, 0}, 1);
        scene.parallelogram({4, 2, 6}, {2, 0, 0}, {0, 0, -2}, 1);  // the roof
        const TriangleMesh mesh = refine(scene.mesh, 0.5)->mesh;
        const auto cut = refine_at_shadows(mesh, kToSun, 3).value();
        std::vector<int> parts(mesh.triangle_count(), 0);
        for (const std::uint32_t source : cut.source) ++parts[source];
        std::size_t ground = 0;
        for (std::size_t t = 0; t < parts.size(); ++t) {
            bool flat = true, on_ground = false;
            for (std::size_t k = 0; k < 3; ++k) {
                const float y = mesh.positions[mesh.indices[3 * t + k]].y;
                flat = flat && y == 0.0f;
                on_ground = on_ground || y == 0.0f;
            }
            if (flat) ground += parts[t] > 1 ? 1u : 0u;
            if (!on_ground) CHECK(parts[t] == 1);
        }
        CHECK(ground > 0);
    }

    TEST_CASE("bad input is named") {
        const TriangleMesh mesh = ground_and_plate();
        constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
        for (const glm::dvec3& to_sun :
             {glm::dvec3(0.0), glm::dvec3(kNan, 1.0, 0.0),
              glm::dvec3(0.0, std::numeric_limits<double>::infinity(), 0.0), glm::dvec3(1e200)}) {
            CHECK(error_of(refine_at_shadows(mesh, to_sun, 1)).code == ErrorCode::out_of_range);
            CHECK(error_of(sunlit_triangles(mesh, to_sun)).code == ErrorCode::out_of_range);
        }
        CHECK(error_of(refine_at_shadows(mesh, kToSun, 8, 5000)).code == ErrorCode::budget_exceeded);
        TriangleMesh broken = mesh;
        broken.indices[5] = 1u << 30;
        CHECK(error_of(refine_at_shadows(broken, kToSun, 1)).item == 5);
        CHECK_FALSE(refine_at_shadows({}, kToSun, 1).has_value());
    }
}
