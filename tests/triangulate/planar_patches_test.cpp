#include <doctest/doctest.h>
#include <cmath>
#include <crofton/triangulate/planar_patches.hpp>
#include <limits>
#include <set>

using namespace crofton;
using triangulate::find_planar_patches;
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
        CHECK(find_planar_patches(mesh).error().code == ErrorCode::out_of_range);
        mesh.positions.emplace_back(std::numeric_limits<float>::quiet_NaN(), 0.0f, 0.0f);
        CHECK(find_planar_patches(mesh).error().code == ErrorCode::non_finite);
    }

    TEST_CASE("triangles without area and sides of three triangles join nothing") {
        TriangleMesh mesh;
        mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2, 2, 0}};
        mesh.indices = {0, 1, 2, 0, 2, 4};
        CHECK(find_planar_patches(mesh)->empty());
        mesh.indices = {0, 1, 2, 0, 2, 3, 2, 0, 3};
        CHECK(find_planar_patches(mesh)->empty());
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
        const auto report = retriangulate_planar_patches(mesh);
        REQUIRE(report.has_value());
        CHECK(report->patches == 1);
        CHECK(report->unproven == 0);
        // Every cell has two equal diagonals: already minimal.
        CHECK(report->improved == 0);
        CHECK(report->weight_after == doctest::Approx(report->weight_before));
    }
}
