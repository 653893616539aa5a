// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <crofton/triangulate/triangulate.hpp>
#include <error_of.hpp>
#include <limits>
#include <set>

using namespace crofton;
using triangulate::find_planar_patches;
using triangulate::PlanarPatch;
using triangulate::retriangulate_planar_patches;

namespace {

// A strip of `count` quads along x, each cut along its longer diagonal, `width` deep.
TriangleMesh fan_of_rectangle(float length, float width, int count) {
    TriangleMesh mesh;
    for (int i = 0; i <= count; ++i)
        mesh.positions.emplace_back(length * static_cast<float>(i) / static_cast<float>(count), 0, 0);
    for (int i = count; i >= 0; --i)
        mesh.positions.emplace_back(length * static_cast<float>(i) / static_cast<float>(count), width, 0);
    const auto n = static_cast<std::uint32_t>(mesh.positions.size());
    // A fan from vertex 0 over the far side, and slivers-free along the near side from the far corner.
    for (std::uint32_t i = static_cast<std::uint32_t>(count) + 1; i + 1 < n; ++i)
        mesh.indices.insert(mesh.indices.end(), {0, i, i + 1});
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(count); ++i) {
        mesh.indices.insert(mesh.indices.end(), {i, i + 1, static_cast<std::uint32_t>(count) + 1});
    }
    return mesh;
}

}  // namespace

TEST_SUITE("triangulate/planar_patches") {
    TEST_CASE("bad meshes are refused, empty ones have no patches") {
        TriangleMesh mesh;
        CHECK(find_planar_patches(mesh)->empty());
        mesh.positions = {{0, 0, 0}, {1, 0, 0}};
        mesh.indices = {0, 1, 2};
        CHECK(error_of(find_planar_patches(mesh)).code == ErrorCode::out_of_range);
        mesh.positions.emplace_back(std::numeric_limits<float>::quiet_NaN(), 0.0f, 0.0f);
        CHECK(error_of(find_planar_patches(mesh)).code == ErrorCode::non_finite);
    }

    TEST_CASE("triangles without area and sides of three triangles join nothing") {
        TriangleMesh mesh;
        mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2, 2, 0}};
        mesh.indices = {0, 1, 2, 0, 2, 4};
        CHECK(find_planar_patches(mesh)->empty());
        mesh.indices = {0, 1, 2, 0, 2, 3, 2, 0, 3};
        CHECK(find_planar_patches(mesh)->empty());
    }

    TEST_CASE("the result of a patch tells its vertices, holes, triangles and time") {
        // A plate of 7 × 3 with `holes` square holes in a row, cut by ears.
        for (const std::size_t holes : {0u, 1u, 3u}) {
            const double length = 2.0 * static_cast<double>(holes) + 1.0;
            Polygon plate{{{0, 0}, {length, 0}, {length, 3}, {0, 3}}, {4}};
            for (std::size_t h = 0; h < holes; ++h) {
                const double x = 2.0 * static_cast<double>(h) + 1.0;
                for (const glm::dvec2& corner : {glm::dvec2(x, 1), {x, 2}, {x + 1, 2}, {x + 1, 1}})
                    plate.points.push_back(corner);
                plate.ring_ends.push_back(static_cast<std::uint32_t>(plate.points.size()));
            }
            triangulate::Triangulator triangulator;
            triangulate::Triangulation ears;
            REQUIRE(triangulator.triangulate(plate, {.method = triangulate::Method::ear}, ears));
            TriangleMesh mesh;
            for (const glm::dvec2& p : plate.points) mesh.positions.emplace_back(glm::vec2(p), 0.0f);
            for (const auto& t : ears.triangles) mesh.indices.insert(mesh.indices.end(), t.begin(), t.end());
            const auto start = std::chrono::steady_clock::now();
            const auto report = retriangulate_planar_patches(mesh);
            const std::chrono::duration<double, std::micro> elapsed = std::chrono::steady_clock::now() - start;
            REQUIRE(report);
            REQUIRE(report->results.size() == 1);
            const triangulate::PatchResult& result = report->results[0];
            CHECK(result.refused.empty());
            CHECK(result.holes == holes);
            CHECK(result.vertices == 4 + 4 * holes);
            CHECK(result.triangles.size() == 4 + 4 * holes + 2 * holes - 2);  // Euler
            CHECK(result.microseconds > 0.0);
            CHECK(result.microseconds <= elapsed.count());
        }
    }

    TEST_CASE("a cube has six patches of two triangles, a folded quad none") {
        TriangleMesh cube;
        for (int i = 0; i < 8; ++i) cube.positions.emplace_back(i & 1, i >> 1 & 1, i >> 2);
        cube.indices = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                        2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
        const auto patches = find_planar_patches(cube);
        REQUIRE(patches->size() == 6);
        for (const auto& patch : *patches) {
            CHECK(patch.triangles.size() == 2);
            CHECK(patch.weight == doctest::Approx(std::sqrt(2.0)));
        }
        TriangleMesh fold;
        fold.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 1e-3f}};
        fold.indices = {0, 1, 2, 0, 2, 3};
        CHECK(find_planar_patches(fold)->empty());
        CHECK(find_planar_patches(fold, 2e-3)->size() == 1);
    }

    TEST_CASE("seams separate: vertices at one place with different indices") {
        TriangleMesh mesh;
        mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 0, 0}, {1, 1, 0}, {0, 1, 0}};
        mesh.indices = {0, 1, 2, 3, 4, 5};
        CHECK(find_planar_patches(mesh)->empty());
    }

    TEST_CASE("a hole and a vertex inside become rings of the polygon") {
        TriangleMesh mesh;
        mesh.positions = {{0, 0, 0}, {6, 0, 0}, {6, 6, 0}, {0, 6, 0}, {2, 2, 0}, {4, 2, 0}, {4, 4, 0}, {2, 4, 0}};
        for (std::uint32_t i = 0; i < 4; ++i) {
            const std::uint32_t j = (i + 1) % 4;
            mesh.indices.insert(mesh.indices.end(), {i, j, 4 + j, i, 4 + j, 4 + i});
        }
        auto patches = find_planar_patches(mesh);
        REQUIRE(patches->size() == 1);
        CHECK((*patches)[0].polygon.ring_count() == 2);
        CHECK((*patches)[0].polygon.ring(0).size() == 4);
        // Fill the hole with a fan about its middle.
        mesh.positions.emplace_back(3, 3, 0);
        for (std::uint32_t i = 0; i < 4; ++i) mesh.indices.insert(mesh.indices.end(), {4 + i, 4 + (i + 1) % 4, 8});
        patches = find_planar_patches(mesh);
        REQUIRE(patches->size() == 1);
        CHECK((*patches)[0].polygon.ring_count() == 6);
        CHECK((*patches)[0].polygon.points.size() == 9);
    }

    TEST_CASE("the outer ring comes first, also where the mesh begins at the holes") {
        TriangleMesh mesh;
        mesh.positions = {{0, 0, 0}, {6, 0, 0}, {12, 0, 0}, {12, 6, 0}, {6, 6, 0}, {0, 6, 0},  {2, 2, 0},
                          {4, 2, 0}, {4, 4, 0}, {2, 4, 0},  {8, 2, 0},  {9, 2, 0}, {10, 4, 0}, {8, 4, 0}};
        const std::uint32_t outer[2][4] = {{0, 1, 4, 5}, {1, 2, 3, 4}}, hole[2] = {6, 10};
        for (const bool at_hole : {true, false})
            for (std::uint32_t side = 0; side < 2; ++side)
                for (std::uint32_t i = 0; i < 4; ++i) {
                    const std::uint32_t j = (i + 1) % 4, a = outer[side][i], b = outer[side][j];
                    if (at_hole)
                        mesh.indices.insert(mesh.indices.end(), {hole[side] + j, hole[side] + i, a});
                    else
                        mesh.indices.insert(mesh.indices.end(), {a, b, hole[side] + j});
                }
        const auto patches = find_planar_patches(mesh);
        REQUIRE(patches->size() == 1);
        const PlanarPatch& patch = (*patches)[0];
        REQUIRE(patch.polygon.ring_count() == 3);
        CHECK(patch.polygon.ring(0).size() == 6);
        CHECK(patch.polygon.ring(1).size() == 4);
        CHECK(patch.polygon.ring(2).size() == 4);
        REQUIRE(patch.vertices.size() == 14);
        for (std::size_t i = 0; i < 14; ++i) CHECK((patch.vertices[i] < 6) == (i < 6));
        for (std::size_t i = 6; i < 14; ++i) CHECK((patch.vertices[i] < 10) == (i < 10));
    }

    TEST_CASE("a strip becomes lighter, keeps its vertices, its area and its orientation, in any plane") {
        for (const glm::vec3 tilt : {glm::vec3(0, 0, 0), glm::vec3(0, 0, 0.5f), glm::vec3(0.3f, 0, 0.7f)}) {
            TriangleMesh mesh = fan_of_rectangle(16.0f, 1.0f, 16);
            // A shear that keeps floats exact keeps the strip planar.
            for (auto& p : mesh.positions)
                p.z = std::round(tilt.x * 8.0f) / 8.0f * p.x + std::round(tilt.z * 8.0f) / 8.0f * p.y;
            const TriangleMesh before = mesh;
            const auto report = retriangulate_planar_patches(mesh);
            REQUIRE(report.has_value());
            CHECK(report->patches == 1);
            CHECK(report->improved == 1);
            CHECK(report->weight_after < 0.3 * report->weight_before);
            CHECK(mesh.indices.size() == before.indices.size());
            CHECK(std::set(mesh.indices.begin(), mesh.indices.end()) ==
                  std::set(before.indices.begin(), before.indices.end()));
            // Again: nothing left to gain, and the report agrees with itself.
            const auto again = retriangulate_planar_patches(mesh);
            CHECK(again->improved == 0);
            CHECK(again->weight_before == doctest::Approx(report->weight_after).epsilon(1e-12));
        }
    }

    TEST_CASE("values of another number than vertices are refused") {
        const TriangleMesh mesh = fan_of_rectangle(4.0f, 1.0f, 4);
        const std::vector<float> values(2 * mesh.positions.size() - 1);
        const triangulate::VertexValues uv{values, 2, 0.0, false};
        CHECK(error_of(find_planar_patches(mesh, 0.0, {&uv, 1})).code == ErrorCode::invalid_argument);
    }

    TEST_CASE("a flat area is one patch only where its values are one linear function, up to their tolerance") {
        const TriangleMesh mesh = fan_of_rectangle(8.0f, 1.0f, 8);
        std::vector<float> uv;
        for (const auto& p : mesh.positions) uv.insert(uv.end(), {0.25f * p.x + p.y, 3.0f - p.x});
        const auto patches = [&](double tolerance, bool constant = false) {
            const triangulate::VertexValues field{uv, 2, tolerance, constant};
            return find_planar_patches(mesh, 0.0, {&field, 1}).value().size();
        };
        CHECK(patches(1e-6) == 1);
        CHECK(patches(1e-6, true) == 0);
        CHECK(patches(10.0, true) == 1);
        // The far corner of the last triangle leaves the plane of values.
        uv[2 * 4] += 0.01f;
        CHECK(patches(0.02) == 1);
        const triangulate::VertexValues field{uv, 2, 1e-3, false};
        const auto parted = find_planar_patches(mesh, 0.0, {&field, 1});
        for (const auto& patch : *parted) CHECK(std::count(patch.vertices.begin(), patch.vertices.end(), 4u) == 0);
        uv[2 * 4] = std::numeric_limits<float>::quiet_NaN();
        const auto broken = find_planar_patches(mesh, 0.0, {&field, 1});
        for (const auto& patch : *broken) CHECK(std::count(patch.vertices.begin(), patch.vertices.end(), 4u) == 0);
    }

    TEST_CASE("interpolated values change nowhere by more than twice the tolerance") {
        TriangleMesh mesh = fan_of_rectangle(16.0f, 2.0f, 16);
        std::vector<float> values;
        constexpr double kTolerance = 0.01;
        std::uint32_t state = 7;
        for (const auto& p : mesh.positions) {
            state = state * 1664525u + 1013904223u;
            const float noise = 0.004f * (static_cast<float>(state >> 16) / 65536.0f - 0.5f);
            values.push_back(0.5f * p.x - p.y + noise);
        }
        const TriangleMesh before = mesh;
        const triangulate::VertexValues field{values, 1, kTolerance, false};
        triangulate::PatchOptions options;
        options.values = {&field, 1};
        CHECK(retriangulate_planar_patches(mesh, options)->improved >= 1);
        const auto interpolated = [&](const TriangleMesh& m, const glm::dvec2& p) {
            for (std::size_t t = 0; t < m.indices.size(); t += 3) {
                const auto corner = [&](std::size_t k) { return glm::dvec2(m.positions[m.indices[t + k % 3]]); };
                double sum = 0.0, area = 0.0;
                bool inside = true;
                for (std::size_t k = 0; k < 3; ++k) {
                    const glm::dvec2 a = corner(k + 1) - p, b = corner(k + 2) - p;
                    const double part = a.x * b.y - a.y * b.x;
                    inside = inside && part >= 0.0;
                    area += part;
                    sum += part * static_cast<double>(values[m.indices[t + k]]);
                }
                if (inside && area > 0.0) return sum / area;
            }
            return std::numeric_limits<double>::quiet_NaN();
        };
        for (double x = 0.03; x < 16.0; x += 0.37)
            for (double y = 0.05; y < 2.0; y += 0.23)
                CHECK(std::fabs(interpolated(mesh, {x, y}) - interpolated(before, {x, y})) <= 2.0 * kTolerance);
    }

    TEST_CASE("a seam that ends inside a patch keeps its two sides apart") {
        // A fan around vertex 0 whose first and last rim vertices, 1 and 9, share a place: a slit between them.
        TriangleMesh mesh;
        mesh.positions = {{4, 0.5f, 0}, {9, 0, 0}, {9, 1, 0}, {7, 1, 0}, {3, 1, 0},
                          {0, 1, 0},    {0, 0, 0}, {2, 0, 0}, {6, 0, 0}, {9, 0, 0}};
        for (std::uint32_t i = 1; i < 9; ++i) mesh.indices.insert(mesh.indices.end(), {0, i, i + 1});
        const auto report = retriangulate_planar_patches(mesh).value();
        CHECK(report.patches == 1);
        CHECK(report.improved == 1);
        std::set<std::uint32_t> used;
        for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
            glm::vec3 middle(0.0f);
            for (std::size_t k = 0; k < 3; ++k) middle += mesh.positions[mesh.indices[i + k]] / 3.0f;
            // Above the slit y = 0.5 − (x − 4) / 10 or below it.
            const bool above = middle.y > 0.9f - 0.1f * middle.x;
            for (std::size_t k = 0; k < 3; ++k) {
                used.insert(mesh.indices[i + k]);
                CHECK(mesh.indices[i + k] != (above ? 9u : 1u));
            }
        }
        CHECK(used.size() == 10);
    }

    TEST_CASE("the sides of a seam stay apart and in use, whichever triangle comes first") {
        const std::uint32_t triangles[5][3] = {{5, 6, 0}, {1, 2, 3}, {4, 5, 0}, {1, 3, 4}, {4, 0, 1}};
        for (std::size_t first = 0; first < 5; ++first) {
            TriangleMesh mesh;  // a square; 3 and 5 are the seam's two ends on its side
            mesh.positions = {{0, 0, 0}, {8, 0, 0}, {8, 8, 0}, {4, 8, 0}, {4, 3, 0}, {4, 8, 0}, {0, 8, 0}};
            for (std::size_t t = 0; t < 5; ++t)
                for (const std::uint32_t i : triangles[(first + t) % 5]) mesh.indices.push_back(i);
            const auto report = retriangulate_planar_patches(mesh).value();
            CHECK(report.improved == 1);
            CHECK(std::set<std::uint32_t>(mesh.indices.begin(), mesh.indices.end()).size() == 7);
            for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
                const std::uint32_t* const corners = &mesh.indices[t];
                float middle = 0.0f;
                for (std::size_t k = 0; k < 3; ++k) middle += mesh.positions[corners[k]].x / 3.0f;
                CHECK(std::count(corners, corners + 3, middle > 4.0f ? 5u : 3u) == 0);
            }
        }
    }

    TEST_CASE("a patch that overlaps itself is left as it was, and says why") {
        // A fan that goes round one and a half times.
        TriangleMesh mesh;
        mesh.positions.emplace_back(0.0f);
        for (int i = 0; i <= 12; ++i) {
            const float x[8] = {2, 1, 0, -1, -2, -1, 0, 1}, y[8] = {0, 1, 2, 1, 0, -1, -2, -1};
            mesh.positions.emplace_back(x[i % 8], y[i % 8], 0.0f);
        }
        for (std::uint32_t i = 1; i <= 12; ++i) mesh.indices.insert(mesh.indices.end(), {0, i, i + 1});
        const TriangleMesh before = mesh;
        const auto report = retriangulate_planar_patches(mesh).value();
        CHECK(mesh.indices == before.indices);
        CHECK(report.improved == 0);
        CHECK(report.refused == 1);
        REQUIRE(report.results.size() == 1);
        CHECK_FALSE(report.results[0].refused.empty());
        CHECK(report.results[0].weight_after == report.results[0].weight_before);
    }

    TEST_CASE("a finely divided flat grid keeps its inner vertices") {
        TriangleMesh mesh;
        constexpr std::uint32_t kSide = 8;
        for (std::uint32_t y = 0; y <= kSide; ++y)
            for (std::uint32_t x = 0; x <= kSide; ++x) mesh.positions.emplace_back(3 * x, 0.0f, y);
        for (std::uint32_t y = 0; y < kSide; ++y) {
            for (std::uint32_t x = 0; x < kSide; ++x) {
                const std::uint32_t i = y * (kSide + 1) + x;
                mesh.indices.insert(mesh.indices.end(), {i, i + kSide + 1, i + 1, i + 1, i + kSide + 1, i + kSide + 2});
            }
        }
        const auto report = retriangulate_planar_patches(mesh).value();
        CHECK(report.patches == 1);
        CHECK(report.unproven == 0);
        // Every cell has two equal diagonals: already minimal.
        CHECK(report.improved == 0);
        CHECK(report.weight_after == doctest::Approx(report.weight_before));
    }
}
