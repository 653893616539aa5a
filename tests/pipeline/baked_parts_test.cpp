// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include "pipeline/baked_parts.hpp"

using namespace crofton;

namespace {

// Two triangles on a node each; `corner` is one of the second's.
scene::Scene two_triangles(const glm::vec3& corner, bool swapped = false) {
    scene::Scene scene;
    const auto first = scene.add_node(scene::kNone, {}), second = scene.add_node(scene::kNone, {});
    for (const bool other : {false, true}) {
        TriangleMesh mesh;
        mesh.positions = {{0, 0, 0}, {1, 0, 0}, other ? corner : glm::vec3(0, 1, 0)};
        mesh.indices = {0, 1, 2};
        REQUIRE(scene.add_instance(other != swapped ? *second : *first, *scene.add_mesh(std::move(mesh))).has_value());
    }
    return scene;
}

}  // namespace

TEST_SUITE("pipeline/baked_parts") {
    TEST_CASE("what belongs to a scene is another's if meshes, and the nodes that hold them, are the same") {
        const scene::Scene scene = two_triangles({0, 2, 0});
        CHECK(pipeline::same_parts(scene, two_triangles({0, 2, 0})));
        CHECK_FALSE(pipeline::same_parts(scene, two_triangles({0, 3, 0})));
        CHECK_FALSE(pipeline::same_parts(scene, two_triangles({0, 2, 0}, true)));
        scene::Scene more = two_triangles({0, 2, 0});
        REQUIRE(more.add_node(scene::kNone, {}).has_value());
        CHECK_FALSE(pipeline::same_parts(scene, more));
    }
}
