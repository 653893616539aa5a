// SPDX-License-Identifier: MIT
// The code of docs/world.md.
#include <doctest/doctest.h>
#include <cmath>
#include <crofton/convex/query.hpp>
#include <crofton/crofton.hpp>
#include <cstdio>
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
        crofton::ViewResult visible;

        // Each frame: pass the game's changes,
        world
            .set_bounds({&enemies[0].object, enemies.size(), sizeof(Enemy)},
                        {&enemies[0].box, enemies.size(), sizeof(Enemy)})
            .value();
        world.set_transform(ship, {glm::dmat3(1.0), {0.0, 1.0, -20.0}}).value();
        for (Enemy& enemy : enemies)
            if (enemy.dead) world.remove(enemy.object).value();
        // update once,
        world.update(jobs).value();
        // and then query.
        world.view({.camera = camera}, visible).value();
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
        world.add({.mesh = *house, .transform = crofton::Transform{glm::dmat3(1.0), {0.0, 0.0, -10.0}}}).value();
        world.update(jobs).value();
        // Without the objects that the house hides:
        world.view({.camera = camera, .occlusion = crofton::OcclusionOptions{}}, visible).value();

        CHECK(visible.size() == 1);

        // A left-handed engine with y up, depth from 0 to 1 and its own matrices:
        const glm::dmat4 view = glm::lookAtLH(glm::dvec3(0.0), glm::dvec3(0.0, 0.0, -1.0), glm::dvec3(0.0, 1.0, 0.0));
        const glm::dmat4 to_clip = glm::perspectiveLH_ZO(1.0, 16.0 / 9.0, 0.1, 1000.0) * view;
        world.view({.matrix = crofton::ViewMatrix{to_clip, crofton::DepthRange::zero_to_one}, .layers = 1}, visible)
            .value();

        CHECK(visible.size() == 9);  // the trigger is in layer 2 alone
    }

    TEST_CASE("the guide's shapes rest on a floor, and fall on it") {
        // clang-format off
        crofton::World world;
        crofton::ThreadPool jobs(2);
        const auto slab = crofton::convex::Shape::box({5.0f, 0.2f, 5.0f}).value();
        const auto floor = world.add({.bound = crofton::Obb{{}, glm::mat3(1.0f), {5.0f, 0.2f, 5.0f}}}).value();
        world.set_shape(floor, &slab).value();
        std::size_t pushed = 0;
        const auto push = [&](const crofton::Contact& contact, const glm::dvec3& position, const glm::dvec3& normal,
                              double depth, float* memory) {
            ++pushed;
            CHECK(contact.second.user == 7);
            CHECK(position.y == doctest::Approx(0.15));
            CHECK(normal.y == doctest::Approx(1.0));
            CHECK(depth == doctest::Approx(0.1));
            CHECK(memory[0] == 0.0f);
        };

        const auto capsule = crofton::convex::Shape::capsule(0.6f, 0.3f).value();  // a character, upright
        const crofton::Transform standing{glm::dmat3(1.0), {0.0, 1.0, 0.0}};
        const auto hero = world.add({.transform = standing, .shape = &capsule, .user = 7}).value();
        world.update(jobs).value();
        for (const crofton::Contact& contact : world.contacts())
            for (crofton::convex::TrackedPoint& point : contact.shape_points)
                push(contact, point.contact.position, point.normal, point.contact.depth, point.memory);  // and keep the impulses
        const crofton::RigidTransform from{glm::dmat3(1.0), {0.0, 9.0, 0.0}};
        const auto hit = world.cast(capsule, from, {.velocity = {0.0, -9.0, 0.0}}, {}, {.ignored = {&hero, 1}});  // where would it land?
        if (hit && *hit) std::printf("after %g s on object %u\n", (*hit)->time, (*hit)->object.index);
        // clang-format on
        CHECK(pushed == 1);
        REQUIRE(hit.has_value());
        REQUIRE(hit->has_value());
        CHECK((*hit)->object == floor);
        CHECK((*hit)->time == doctest::Approx((9.0 - 0.2 - 0.9) / 9.0).epsilon(1e-5));  // on the floor
    }
}
