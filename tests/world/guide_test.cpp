// SPDX-License-Identifier: MIT
// The code of docs/world.md.
#include <doctest/doctest.h>
#include <cmath>
#include <crofton/crofton.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <string>
#include <vector>

namespace {

// What an engine has of its own.
struct Vertex {
    float position[3];
    std::uint8_t color[4];
};
struct Enemy {
    crofton::ObjectHandle object;
    crofton::Obb box;
    bool dead = false;
};
std::size_t drawn = 0, started = 0, ended = 0;
void fail_loading(const std::string& why) {
    FAIL(why);
}
void draw(std::uint64_t) {
    ++drawn;
}
void start_sound(std::uint64_t, std::uint64_t) {
    ++started;
}
void stop_sound(std::uint64_t, std::uint64_t) {
    ++ended;
}

}  // namespace

TEST_SUITE("world/guide") {
    TEST_CASE("the guide's code runs and does what it says") {
        const std::vector<Vertex> vertices = {{{0, 0, 0}, {}}, {{1, 0, 0}, {}}, {{0, 1, 0}, {}}, {{0, 0, 1}, {}}};
        const std::vector<std::uint32_t> indices = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};

        crofton::World world;
        const auto mesh =
            world.add_mesh({.positions = {vertices[0].position, vertices.size(), sizeof(Vertex)}, .indices = indices});
        if (!mesh) return fail_loading(mesh.error().message);  // which vertex or index, why, what to do
        const auto ship = world.add_node({.transform = {glm::dmat3(1.0), {0.0, 0.0, -20.0}}}).value();
        const auto turret = world.add({.mesh = *mesh, .node = ship, .user = 42}).value();
        const auto trigger = world.add({.bound = crofton::Sphere{{0.0, 0.0, -20.0}, 5.0}, .layers = 2}).value();

        std::vector<Enemy> enemies(8);
        for (Enemy& enemy : enemies) enemy.object = world.add({.bound = enemy.box}).value();
        for (std::size_t i = 0; i < enemies.size(); ++i) enemies[i].box.center.z = -18.0 - double(i);
        enemies[3].dead = true;
        crofton::ThreadPool jobs(2);
        crofton::Camera camera;
        crofton::VisibleObjects visible;

        // Each frame: what the game has changed,
        world.set_bounds({&enemies[0].object, enemies.size(), sizeof(Enemy)},
                         {&enemies[0].box, enemies.size(), sizeof(Enemy)});
        world.set_transform(ship, {glm::dmat3(1.0), {0.0, 1.0, -20.0}});
        for (Enemy& enemy : enemies)
            if (enemy.dead) world.remove(enemy.object);
        // once
        world.update(jobs);
        // and then whatever it wants to know.
        world.view(camera, visible);
        for (std::size_t i = 0; i < visible.size(); ++i) draw(visible[i].user);
        for (const crofton::Contact& contact : world.contacts()) {
            if (contact.phase == crofton::ContactPhase::began) start_sound(contact.first.user, contact.second.user);
            if (contact.phase == crofton::ContactPhase::ended) stop_sound(contact.first.user, contact.second.user);
        }

        CHECK(drawn == 9);
        CHECK(started >= 2);
        CHECK(ended == 0);
        CHECK(world.contains(turret));
        CHECK(world.contains(trigger));
        CHECK(!world.contains(enemies[3].object));

        const crofton::Obb block = {{0.0, 0.0, 0.0}, glm::mat3(1.0f), {4.0f, 4.0f, 1.0f}};
        std::vector<glm::dvec3> corners;
        for (const glm::dvec3& corner : crofton::corners(block)) corners.push_back(corner);
        const std::vector<std::uint32_t> faces = {0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                                                  2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6};
        const auto house = world.add_mesh({.positions = corners, .indices = faces, .occluders = true});
        if (!house) return fail_loading(house.error().message);
        world.add({.mesh = *house, .transform = crofton::scene::Transform{glm::dmat3(1.0), {0.0, 0.0, -10.0}}});
        world.update(jobs);
        world.view(camera, crofton::OcclusionOptions{}, visible);  // without what the house hides

        CHECK(visible.size() == 1);

        // A left-handed engine with y up, depth from 0 to 1 and its own matrices:
        const glm::dmat4 view = glm::lookAtLH(glm::dvec3(0.0), glm::dvec3(0.0, 0.0, -1.0), glm::dvec3(0.0, 1.0, 0.0));
        const glm::dmat4 to_clip = glm::perspectiveLH_ZO(1.0, 16.0 / 9.0, 0.1, 1000.0) * view;
        const auto frustum = crofton::frustum_of(to_clip, crofton::DepthRange::zero_to_one);
        if (frustum) world.view(crofton::cull::View{.frustum = *frustum, .layer_mask = 1}, visible);

        CHECK(visible.size() == 9);  // the trigger is in layer 2 alone
    }
}
