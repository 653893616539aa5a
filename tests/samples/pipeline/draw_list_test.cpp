// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <crofton/geometry/transform.hpp>
#include <utility>
#include <vector>

#include "assets/scene_source.hpp"
#include "pipeline/draw_list.hpp"
#include "pipeline/pipeline.hpp"

using namespace crofton;
using namespace crofton::pipeline;

TEST_SUITE("pipeline/draw_list") {
    TEST_CASE("only one-sided meshes are drawn so, and no mirrored placement of them") {
        TriangleMesh triangle;
        triangle.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
        triangle.indices = {0, 1, 2};
        scene::Scene scene;
        const auto two_sided = scene.add_mesh(triangle), one_sided = scene.add_mesh(triangle);
        const glm::dmat3 mirror(-1, 0, 0, 0, 1, 0, 0, 0, 1);
        std::vector<scene::InstanceId> all;
        for (const auto& mesh : {two_sided, one_sided})
            for (const glm::dmat3& linear : {glm::dmat3(1.0), mirror})
                all.push_back(*scene.add_instance(*scene.add_node(scene::kNone, {linear, {0, 0, -10}}), *mesh));
        scene.update();
        const std::vector<std::uint8_t> sides{0, 1};
        for (const std::uint8_t moves : {std::uint8_t{0}, std::uint8_t{1}}) {
            const std::vector<std::uint8_t> is_mover(all.size(), moves);
            DrawList list(scene, all, is_mover, {.one_sided = sides});
            list.select(all, Camera{});
            REQUIRE(list.ranges().size() == 4);
            for (std::size_t r = 0; r < 4; ++r) {
                CHECK(list.ranges()[r].one_sided == (list.instance_of(r) == all[2]));
                CHECK(list.ranges()[r].unclipped);
            }
            CHECK(list.predict_clipped() == 4);
        }
    }

    TEST_CASE("draws go front to back, by their farthest points") {
        TriangleMesh triangle;
        triangle.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
        triangle.indices = {0, 1, 2};
        scene::Scene scene;
        const auto mesh = scene.add_mesh(triangle);
        std::vector<scene::InstanceId> all;
        // The third is large and reaches behind the others, though its middle is as near as that of the first.
        for (const auto& [z, scale] : {std::pair{-20.0, 1.0}, {-10.0, 1.0}, {-10.0, 60.0}})
            all.push_back(
                *scene.add_instance(*scene.add_node(scene::kNone, {glm::dmat3(scale), {0, -0.5 * scale, z}}), *mesh));
        scene.update();
        for (const std::uint8_t moves : {std::uint8_t{0}, std::uint8_t{1}}) {
            const std::vector<std::uint8_t> is_mover(all.size(), moves);
            DrawList list(scene, all, is_mover, {});
            list.select(all, Camera{});
            REQUIRE(list.ranges().size() == 3);
            CHECK(list.instance_of(0) == all[1]);
            CHECK(list.instance_of(1) == all[0]);
            CHECK(list.instance_of(2) == all[2]);
        }
    }

    TEST_CASE("each face of a flat mesh has its own normal, of others those that meet at a small angle share one") {
        // Two faces that meet along the y axis at 0.2 rad, well below the angle of a crease.
        TriangleMesh roof;
        const auto sine = 0.19866933f, cosine = 0.98006658f;
        roof.positions = {{0, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {cosine, 0, -sine}};
        roof.indices = {0, 1, 2, 0, 3, 1};
        scene::Scene scene;
        const auto smooth = scene.add_mesh(roof), flat = scene.add_mesh(roof);
        const std::vector<scene::InstanceId> all{*scene.add_instance(*scene.add_node(scene::kNone, {}), *smooth),
                                                 *scene.add_instance(*scene.add_node(scene::kNone, {}), *flat)};
        scene.update();
        const std::vector<std::uint8_t> is_mover(2, 0), which{0, 1};
        const DrawList list(scene, all, is_mover, {.flat = which});
        REQUIRE(list.indices().size() == 12);
        const auto normal = [&](std::size_t corner) { return list.vertices()[list.indices()[corner]].normal; };
        for (const std::size_t shared : {0u, 1u}) {
            const std::size_t other = shared == 0 ? 3 : 5;
            CHECK(normal(shared) == normal(other));
            CHECK(normal(6 + shared).z == 1.0f);
            CHECK(normal(6 + other).z == doctest::Approx(cosine));
            CHECK(normal(6 + other).x == doctest::Approx(sine));
        }
    }
}
