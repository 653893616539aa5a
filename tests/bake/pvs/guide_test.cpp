// SPDX-License-Identifier: MIT
// The example of docs/pvs.md, compiled and run.
#include <doctest/doctest.h>
#include <crofton/crofton.hpp>
#include <crofton/pvs/pvs.hpp>
#include <cstdio>
#include <vector>

#include "bake_geometry.hpp"

namespace {

int report(const crofton::Error& error) {
    std::printf("%s\n", error.message.c_str());
    return 1;
}

template <class Draw>
int show(const crofton::Aabb& eyes, const crofton::scene::Scene& scene,
         const std::vector<crofton::scene::InstanceId>& movers, const crofton::World& world,
         const crofton::Camera& camera, crofton::ViewResult& visible, const Draw& draw_object) {
    using namespace crofton;

    const auto cells = pvs::Cells::grid(eyes, {16, 1, 16});
    if (!cells) return report(cells.error());
    const auto geometry = pvs::geometry_of(scene, movers);
    if (!geometry) return report(geometry.error());
    auto bake = pvs::Bake::create(*geometry, *cells, {.epsilon = 1e-2});
    if (!bake) return report(bake.error());
    if (const auto ran = bake->run(); !ran) return report(ran.error());  // until the guarantee holds
    const auto sets = pvs::Pvs::finish(*bake);
    if (!sets) return report(sets.error());

    // Each frame: the visible objects among the set of the eye's cell, and moving objects.
    world
        .view({.camera = camera, .candidate_mask = sets->visible_from(camera.position, pvs::Mode::statistical)},
              visible)
        .value();
    for (const std::uint32_t id : visible.ids()) draw_object(id);
    return 0;
}

}  // namespace

TEST_SUITE("pvs/guide") {
    TEST_CASE("the guide's example draws what is before the wall, and what moves behind it") {
        using namespace crofton;
        scene::Scene scene;
        World world;
        const auto put = [&](const glm::dvec3& center, const glm::dvec3& half) {
            pvs::BakeGeometry shape;
            testing::add_box(shape, testing::box_around({}, half));
            const auto node = scene.add_node(scene::kNone, {glm::dmat3(1.0), center}).value();
            REQUIRE(scene.add_instance(node, scene.add_mesh(shape.mesh).value()).has_value());
            REQUIRE(world.add({.bound = obb_of(testing::box_around(center, half))}).has_value());
        };
        put({0.0, 1.0, -10.0}, glm::dvec3(60.0, 40.0, 0.5));  // the wall
        put({0.0, 1.0, -5.0}, glm::dvec3(0.5));
        put({0.0, 1.0, -15.0}, glm::dvec3(0.5));
        put({2.0, 1.0, -15.0}, glm::dvec3(0.5));  // moves
        scene.update();
        for (int i = 0; i < 40; ++i) REQUIRE(world.update().has_value());  // what is new counts as moving at first
        Camera camera;
        camera.position = {0.0, 1.0, 0.0};
        ViewResult visible;
        std::vector<std::uint32_t> drawn;
        const Aabb eyes{{-2.0, 0.0, -2.0}, {2.0, 2.0, 2.0}};
        CHECK(show(eyes, scene, {3}, world, camera, visible, [&](std::uint32_t id) { drawn.push_back(id); }) == 0);
        CHECK(drawn == std::vector<std::uint32_t>{0, 1, 3});
        CHECK(show(Aabb{}, scene, {}, world, camera, visible, [](std::uint32_t) {}) == 1);
    }
}
