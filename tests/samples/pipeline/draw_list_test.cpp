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
        DrawList list(scene, {.one_sided = sides});
        list.select(all, Camera{});
        REQUIRE(list.ranges().size() == 4);
        for (std::size_t r = 0; r < 4; ++r) {
            CHECK(list.ranges()[r].one_sided == (list.instance_of(r) == all[2]));
            CHECK(list.ranges()[r].unclipped);
        }
        CHECK(list.predict_clipped() == 4);
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
        DrawList list(scene, {});
        list.select(all, Camera{});
        REQUIRE(list.ranges().size() == 3);
        CHECK(list.instance_of(0) == all[1]);
        CHECK(list.instance_of(1) == all[0]);
        CHECK(list.instance_of(2) == all[2]);
    }

    TEST_CASE("each face of a flat mesh has its own normal, of others those that meet at a small angle share one") {
        // Two faces that meet along the y axis at 0.2 rad, well below the angle of a crease.
        TriangleMesh roof;
        const auto sine = 0.19866933f, cosine = 0.98006658f;
        roof.positions = {{0, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {cosine, 0, -sine}};
        roof.indices = {0, 1, 2, 0, 3, 1};
        scene::Scene scene;
        const auto smooth = scene.add_mesh(roof), flat = scene.add_mesh(roof);
        const std::vector<std::uint8_t> which{0, 1};
        const DrawList list(scene, {.flat = which});
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

    TEST_CASE(
        "listed triangles are drawn as runs of the clusters' order, instances and triangles in the order of all") {
        TriangleMesh strip;
        for (std::uint32_t i = 0; i < 42; ++i) strip.positions.push_back({float(i / 2), float(i % 2), 0.0f});
        for (std::uint32_t i = 0; i < 40; ++i) strip.indices.insert(strip.indices.end(), {i, i + 1, i + 2});
        scene::Scene scene;
        const auto mesh = scene.add_mesh(strip);
        std::vector<scene::InstanceId> all;
        for (const double z : {-60.0, -50.0})
            all.push_back(*scene.add_instance(*scene.add_node(scene::kNone, {glm::dmat3(1.0), {-10, 0, z}}), *mesh));
        scene.update();
        const auto clusters = std::make_shared<const SceneClusters>(*cut_scene(scene, serial_executor()));
        REQUIRE(clusters->meshes[0]->clusters().size() >= 3);
        DrawList list(scene, {}, clusters);
        const depth::Cluster& second = clusters->meshes[0]->clusters()[1];
        const std::vector<depth::VisibleCluster> visible = {{all[0], 0, 0b1011}, {all[1], 1, 0b1}, {all[1], 2, 0b10}};
        list.select(visible, Camera{});
        REQUIRE(list.ranges().size() == 4);
        CHECK(list.instance_of(0) == all[1]);
        CHECK(list.ranges()[0].first_index == 3 * second.first_triangle);
        CHECK(list.ranges()[0].index_count == 3);
        CHECK(list.ranges()[1].first_index == 3 * (clusters->meshes[0]->clusters()[2].first_triangle + 1));
        CHECK(list.instance_of(2) == all[0]);
        CHECK(list.ranges()[2].first_index == 0);
        CHECK(list.ranges()[2].index_count == 6);
        CHECK(list.ranges()[3].first_index == 9);
        CHECK(list.transforms().size() == 2);
        CHECK(list.predict_clipped() == 5);
    }
}
