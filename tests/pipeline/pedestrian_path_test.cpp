// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include "pipeline/camera_path.hpp"
#include "pipeline/pedestrian_path.hpp"

using namespace crofton;
using namespace crofton::pipeline;

namespace {

// A horizontal square of side 20 about the y axis.
void add_floor(scene::Scene& scene, double height, float half = 10.0f) {
    TriangleMesh mesh;
    for (const glm::vec3& p :
         {glm::vec3(-half, 0, -half), glm::vec3(half, 0, -half), glm::vec3(half, 0, half), glm::vec3(-half, 0, half)})
        mesh.positions.push_back(p);
    for (const std::uint32_t index : {0u, 2u, 1u, 0u, 3u, 2u}) mesh.indices.push_back(index);
    const auto node = scene.add_node(scene::kNone, {glm::dmat3(1.0), {0.0, height, 0.0}});
    REQUIRE(scene.add_instance(*node, *scene.add_mesh(std::move(mesh))).has_value());
    scene.update();
}

}  // namespace

TEST_SUITE("pipeline/pedestrian_path") {
    TEST_CASE("an empty scene has no walk") {
        scene::Scene scene;
        CHECK(find_pedestrian_path(scene, focus_of(scene)).empty());
    }

    TEST_CASE("one walks on the lowest floor with room to stand, not in the crawl space below it") {
        scene::Scene scene;
        for (const double height : {0.0, 0.01, 6.0}) add_floor(scene, height);
        const auto walk = find_pedestrian_path(scene, focus_of(scene));
        REQUIRE(walk.size() > 10);
        for (const glm::dvec3& p : walk) {
            CHECK(p.y > 0.01);
            CHECK(p.y < 6.0);
        }
    }

    TEST_CASE("where there is no floor there is no path") {
        scene::Scene scene;
        add_floor(scene, 0.0, 1.0f);
        const auto walk = find_pedestrian_path(scene, Aabb{{-10, 0, -1}, {10, 3, 1}});
        CHECK_FALSE(walk.empty());
        for (const glm::dvec3& p : walk) CHECK(std::abs(p.x) <= 1.0);
    }
}
