// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>
#include <crofton/radiosity/patches.hpp>
#include <error_of.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "shapes.hpp"

using namespace crofton;
using namespace crofton::lines;
using namespace crofton::radiosity;

namespace {

double area_of(const TriangleMesh& mesh) {
    const std::vector<Material> materials(mesh.triangle_count());
    const auto patches = make_patches(mesh, materials).value();
    double sum = 0.0;
    for (const double a : patches.areas) sum += a;
    return sum;
}

}  // namespace

TEST_SUITE("radiosity/patches") {
    TEST_CASE("patches keep which triangle is whose, and each triangle's area, which add up to a patch's") {
        shapes::Shape room;
        room.room({1, 2, 3}, {4, 4, 9}, 0);
        const std::vector<Material> materials(6);
        const auto patches = make_patches(room.mesh, room.patches, materials).value();
        REQUIRE(std::equal(room.patches.begin(), room.patches.end(), patches.patch_of_triangle.begin(),
                           patches.patch_of_triangle.end()));
        REQUIRE(patches.triangle_areas.size() == 12);
        std::vector<double> sums(6, 0.0);
        for (std::size_t t = 0; t < 12; ++t) {
            const auto at = [&](std::size_t k) {
                return glm::dvec3(room.mesh.positions[room.mesh.indices[3 * t + k]]);
            };
            const double a = glm::distance(at(0), at(1)), b = glm::distance(at(1), at(2)),
                         c = glm::distance(at(2), at(0)), s = 0.5 * (a + b + c);
            CHECK(patches.triangle_areas[t] == doctest::Approx(std::sqrt(s * (s - a) * (s - b) * (s - c))));  // Heron
            sums[room.patches[t]] += patches.triangle_areas[t];
        }
        for (std::size_t p = 0; p < 6; ++p) CHECK(patches.areas[p] == doctest::Approx(sums[p]));
        // 3 × 2 × 6: two sides each of 12, 6 and 18.
        std::sort(sums.begin(), sums.end());
        CHECK(sums == std::vector<double>{6, 6, 12, 12, 18, 18});
        const auto single = make_patches(room.mesh, std::vector<Material>(12)).value();
        for (std::uint32_t t = 0; t < 12; ++t) {
            CHECK(single.patch_of_triangle[t] == t);
            CHECK(single.areas[t] == single.triangle_areas[t]);
        }
    }

    TEST_CASE("bad materials, patch numbers and triangles are named") {
        shapes::Shape room;
        room.room({0, 0, 0}, {1, 1, 1}, 0);
        std::vector<Material> materials(6);
        CHECK(make_patches(room.mesh, room.patches, materials).has_value());
        materials[3].reflectance.y = 1.0f;
        const auto mirror = make_patches(room.mesh, room.patches, materials);
        REQUIRE_FALSE(mirror.has_value());
        CHECK(error_of(mirror).item == 3);
        CHECK(error_of(mirror).message.find("reflectance") != std::string::npos);
        materials[3].reflectance.y = -0.1f;
        CHECK(error_of(make_patches(room.mesh, room.patches, materials)).item == 3);
        materials[3] = {};
        materials[5].emission.x = std::numeric_limits<float>::quiet_NaN();
        CHECK(error_of(make_patches(room.mesh, room.patches, materials)).item == 5);
        materials[5] = {};
        materials.emplace_back();
        CHECK(error_of(make_patches(room.mesh, room.patches, materials)).message.find("patch 6") != std::string::npos);
        materials.resize(5);
        CHECK(error_of(make_patches(room.mesh, room.patches, materials)).code == ErrorCode::out_of_range);
        materials.resize(6);
        shapes::Shape flat = room;
        flat.mesh.positions[flat.mesh.indices[7]] = flat.mesh.positions[flat.mesh.indices[6]];
        const auto degenerate = make_patches(flat.mesh, flat.patches, materials);
        REQUIRE_FALSE(degenerate.has_value());
        CHECK(error_of(degenerate).code == ErrorCode::degenerate);
        CHECK(error_of(degenerate).item == 2);
        CHECK(error_of(make_patches({}, {})).code == ErrorCode::empty);
    }

    TEST_CASE("refining keeps area and closedness, knows its sources, and reaches the target") {
        shapes::Shape shape;
        shape.room({0, 0, 0}, {3, 1, 2}, 0);
        shape.sphere({1, 0.5f, 1}, 0.3f, 6, false, 6);
        REQUIRE(shapes::unmatched_edges(shape.mesh) == 0);
        for (const double longest : {5.0, 0.7, 0.11}) {
            const auto refined = refine(shape.mesh, longest).value();
            CHECK(shapes::unmatched_edges(refined.mesh) == 0);
            CHECK(area_of(refined.mesh) == doctest::Approx(area_of(shape.mesh)).epsilon(1e-6));
            REQUIRE(refined.source.size() == refined.mesh.triangle_count());
            std::vector<double> by_source(shape.mesh.triangle_count(), 0.0);
            const std::vector<Material> materials(refined.source.size());
            const auto patches = make_patches(refined.mesh, materials);
            for (std::size_t t = 0; t < refined.source.size(); ++t) by_source[refined.source[t]] += patches->areas[t];
            const std::vector<Material> coarse_materials(by_source.size());
            const auto coarse = make_patches(shape.mesh, coarse_materials);
            for (std::size_t t = 0; t < by_source.size(); ++t)
                CHECK(by_source[t] == doctest::Approx(coarse->areas[t]).epsilon(1e-5));
        }
        CHECK(error_of(refine(shape.mesh, 0.0)).code == ErrorCode::out_of_range);
        CHECK(error_of(refine(shape.mesh, 1e-4, 1000)).code == ErrorCode::budget_exceeded);
    }

    TEST_CASE("a triangle whose sides are met is cut alike wherever it lies, and by the shortest lines") {
        const std::vector<glm::vec3> corners = {{0, 0, 0}, {4, 0, 0}, {1, 3, 0}};
        const std::vector<glm::vec3> met = {{0.5f, 0, 0}, {1.25f, 0, 0},     {3, 0, 0},         {3.25f, 0.75f, 0},
                                            {2, 2, 0},    {0.75f, 2.25f, 0}, {0.25f, 0.75f, 0}, {0.125f, 0.375f, 0}};
        std::vector<std::uint32_t> expected;
        double length = 0.0;
        for (const glm::vec3& shift : {glm::vec3(0.0f), glm::vec3(64, 32, 16), glm::vec3(-8, 0.5f, 256)}) {
            TriangleMesh mesh;
            mesh.positions.assign(corners.begin(), corners.end());
            mesh.indices = {0, 1, 2};
            for (const glm::vec3& p : met) {  // each is a corner of a triangle that stands on the side
                for (const glm::vec3& q : {p, p + glm::vec3(0, 0, 1), p + glm::vec3(0.25f, 0, 1)}) {
                    mesh.indices.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
                    mesh.positions.push_back(q);
                }
            }
            for (glm::vec3& p : mesh.positions) p += shift;  // exactly
            const auto mended = mend_t_junctions(mesh, 1e-5).value();
            double sum = 0.0;
            for (std::size_t i = 0; i < mended.mesh.indices.size(); ++i) {
                const std::size_t next = i % 3 == 2 ? i - 2 : i + 1;
                sum += glm::distance(glm::dvec3(mended.mesh.positions[mended.mesh.indices[i]]),
                                     glm::dvec3(mended.mesh.positions[mended.mesh.indices[next]]));
            }
            if (expected.empty()) {
                expected.assign(mended.mesh.indices.begin(), mended.mesh.indices.end());
                length = sum;
            }
            CHECK(std::equal(expected.begin(), expected.end(), mended.mesh.indices.begin(), mended.mesh.indices.end()));
            CHECK(sum == length);
        }
        CHECK(expected.size() == 3 * (9 + 8));
    }

    TEST_CASE("T-junctions of a closed box are removed, and stay removed after refining") {
        // One face of a cube is cut into rows of unequal number on either side of its neighbours' whole sides.
        shapes::Shape box;
        box.room({0, 0, 0}, {1, 1, 1}, 0);
        shapes::Shape cut;
        cut.mesh.positions = box.mesh.positions;
        cut.mesh.indices.assign(box.mesh.indices.begin() + 6, box.mesh.indices.end());
        const float rows[] = {0.0f, 0.3f, 0.35f, 0.8f, 1.0f};
        for (int r = 0; r < 4; ++r)
            for (int half = 0; half < (r == 2 ? 2 : 1); ++half) {
                const float z0 = r == 2 ? 0.5f * static_cast<float>(half) : 0.0f, dz = r == 2 ? 0.5f : 1.0f;
                cut.parallelogram({0, rows[r], z0}, {0, rows[r + 1] - rows[r], 0}, {0, 0, dz}, 0);
            }
        REQUIRE(shapes::unmatched_edges(cut.mesh) > 0);
        const auto color_at = [](const glm::vec3& p) { return 0.3f + 0.1f * glm::vec3(p.x, p.y - p.z, p.z); };
        for (const glm::vec3& p : cut.mesh.positions) cut.mesh.colors.push_back(color_at(p));
        const auto mended = mend_t_junctions(cut.mesh, 1e-5).value();
        CHECK(shapes::unmatched_edges(mended.mesh) == 0);
        // New corners have the colour of their place.
        REQUIRE(mended.mesh.positions.size() > cut.mesh.positions.size());
        REQUIRE(mended.mesh.colors.size() == mended.mesh.positions.size());
        for (std::size_t i = 0; i < mended.mesh.colors.size(); ++i)
            CHECK(glm::length(mended.mesh.colors[i] - color_at(mended.mesh.positions[i])) < 1e-5f);
        CHECK(area_of(mended.mesh) == doctest::Approx(area_of(cut.mesh)).epsilon(1e-6));
        CHECK(shapes::unmatched_edges(refine(mended.mesh, 0.11)->mesh) == 0);
        CHECK(shapes::unmatched_edges(refine(cut.mesh, 0.11)->mesh) > 0);
        // A mesh without T-junctions is left as it is, and bad arguments are refused.
        CHECK(mend_t_junctions(box.mesh, 1e-5)->mesh.indices == box.mesh.indices);
        CHECK(error_of(mend_t_junctions(box.mesh, -1.0)).code == ErrorCode::out_of_range);
    }

    TEST_CASE("small triangles share a patch with their like nearby, large ones keep their own") {
        shapes::Shape s;
        s.parallelogram({0, 0, 0}, {4, 0, 0}, {0, 4, 0}, 0);  // two large triangles
        for (int k = 0; k < 4; ++k)
            s.parallelogram({0.1f * static_cast<float>(k), 0, 0.1f}, {0.1f, 0, 0}, {0, 0.1f, 0}, 1);
        s.parallelogram({0, 0, 0.1f}, {0, 0.1f, 0}, {0.1f, 0, 0}, 2);  // the other side
        s.parallelogram({3, 3, 0.1f}, {0.1f, 0, 0}, {0, 0.1f, 0}, 3);  // far away
        const Vector<std::uint32_t> patch = group_small_triangles(s.mesh, {}, 1.0);
        REQUIRE(patch.size() == s.mesh.triangle_count());
        CHECK(patch[0] != patch[1]);
        for (std::size_t t = 3; t < 10; ++t) CHECK(patch[t] == patch[2]);
        CHECK(patch[10] == patch[11]);
        CHECK(patch[10] != patch[2]);
        CHECK(patch[12] != patch[2]);
        CHECK(*std::max_element(patch.begin(), patch.end()) == 4);
        std::vector<std::uint32_t> labels(patch.size(), 0);
        labels[5] = 1;
        CHECK(group_small_triangles(s.mesh, labels, 1.0)[5] != group_small_triangles(s.mesh, labels, 1.0)[4]);
    }

    TEST_CASE("corner values are means over the face, and do not bleed across edges") {
        shapes::Shape room;
        room.room({0, 0, 0}, {1, 1, 1}, 0);
        const std::vector<Material> materials(12);
        const auto patches = make_patches(room.mesh, materials);
        std::vector<glm::vec3> values(12, glm::vec3(0.0f));
        values[0] = glm::vec3(2.0f);  // one half of a wall
        const auto corners = corner_values(*patches, values);
        CHECK(corners[0].x == doctest::Approx(1.0));  // shared by both halves
        CHECK(corners[1].x == doctest::Approx(2.0));  // its own
        CHECK(corners[3].x == doctest::Approx(1.0));
        for (std::size_t c = 6; c < corners.size(); ++c) CHECK(corners[c].x == 0.0f);
    }
}
