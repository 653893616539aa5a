// SPDX-License-Identifier: MIT
// crofton_character: a capsule walks through a World of boxes: along walls, into corners, up steps and slopes. It
// prints where it gets to, and fails where it is not where it should be.
#include <cmath>
#include <cstdio>
#include <glm/gtc/quaternion.hpp>

#include "character.hpp"

using namespace crofton;

namespace {

constexpr std::uint32_t kSolid = 1, kGhost = 2;  // layers: the character meets the first alone

int failures = 0;

void check(bool good, const char* what, const sample::Character& character) {
    const glm::dvec3& p = character.position();
    std::printf("%-58s (%7.3f, %7.3f, %7.3f)%s\n", what, p.x, p.y, p.z, good ? "" : "  WRONG");
    failures += good ? 0 : 1;
}

ObjectHandle add_box(World& world, const glm::dvec3& center, const glm::vec3& half, std::uint32_t layers = kSolid,
                     const glm::dmat3& turn = glm::dmat3(1.0)) {
    const ObjectHandle object = world.add({.bound = Obb{center, glm::mat3(turn), half}, .layers = layers}).value();
    const convex::Shape shape = convex::Shape::box(half).value();
    (void)world.set_shape(object, &shape);
    return object;
}

void walk(sample::Character& character, const World& world, const glm::dvec3& velocity, int frames) {
    for (int i = 0; i < frames; ++i) character.move(world, (velocity + glm::dvec3(0, -3, 0)) / 60.0);
}

bool near(double a, double b, double tolerance = 0.03) {
    return std::abs(a - b) <= tolerance;
}

}  // namespace

int main() {
    World world;
    add_box(world, {0, -1, 0}, {50, 1, 50});   // the ground: y = 0
    add_box(world, {5, 2, 0}, {0.05f, 2, 8});  // a thin wall across x
    add_box(world, {0, 2, 8}, {5, 2, 0.05f});  // and one across z: they make a corner
    for (int i = 0; i < 4; ++i)                // stairs towards −x, 0.25 each
        add_box(world, {-6.0 - i, 0.125 * (i + 1), 0}, {0.5f, 0.125f * static_cast<float>(i + 1), 3});
    add_box(world, {-6, 0.5, -8}, {0.5f, 0.5f, 3});  // a block of 1 m: too high to climb
    add_box(world, {0, 1, -20}, {1, 1, 1}, kGhost);  // what the character does not meet
    const glm::dmat3 tilt = glm::mat3_cast(glm::angleAxis(0.4, glm::dvec3(0, 0, 1)));
    add_box(world, {20, 0, 20}, {6, 0.5f, 6}, kSolid, tilt);  // a slope of 23 degrees, towards +x
    const Obb door{{-20, 1, -1}, glm::mat3(1.0f), {1, 1, 0.1f}}, lift{{-30, -0.9, 0}, glm::mat3(1.0f), {1, 1, 1}};
    const ObjectHandle sliding = add_box(world, door.center, door.half_extents);
    const ObjectHandle rising = add_box(world, lift.center, lift.half_extents);
    if (!world.update()) return 1;
    const sample::CharacterOptions options{.layers = kSolid};

    sample::Character character({0, 2, 0}, options);
    walk(character, world, {}, 60);
    check(near(character.feet(), 0.0) && character.is_on_ground(), "falls, and stands", character);
    walk(character, world, {4, 0, 0}, 120);
    check(near(character.position().x, 5 - 0.05 - 0.4), "walks into a wall, and stops", character);
    walk(character, world, {4, 0, 4}, 60);
    check(near(character.position().z, 4.0, 0.1), "walks at a wall aslant, and slides along it", character);
    walk(character, world, {4, 0, 4}, 240);
    check(near(character.position().z, 8 - 0.05 - 0.4) && near(character.position().x, 4.55),
          "stops in the corner of two walls", character);
    for (int i = 0; i < 60; ++i) character.move(world, {100, 0, 0});
    check(character.position().x < 5, "moves 100 m in a frame: the thin wall still stops it", character);

    sample::Character climber({-3, 0.92, 0}, options);
    walk(climber, world, {}, 10);
    walk(climber, world, {-3, 0, 0}, 115);
    check(near(climber.feet(), 1.0), "climbs four steps", climber);
    walk(climber, world, {3, 0, 0}, 120);
    check(near(climber.feet(), 0.0), "and goes down again", climber);

    sample::Character stopped({-3, 0.92, -8}, options);
    walk(stopped, world, {}, 10);
    walk(stopped, world, {-3, 0, 0}, 120);
    check(near(stopped.position().x, -5.1) && near(stopped.feet(), 0.0), "does not climb a block of 1 m", stopped);

    sample::Character ghost({0, 0.92, -15}, options);
    walk(ghost, world, {}, 10);
    walk(ghost, world, {0, 0, -4}, 150);
    check(near(ghost.position().z, -25, 0.2), "walks through what its layers leave out", ghost);

    sample::Character hiker({12, 0.92, 20}, options);
    walk(hiker, world, {}, 10);
    walk(hiker, world, {4, 0, 0}, 120);
    check(near(hiker.position().x, 20, 0.4) && hiker.feet() > 0.3 && hiker.is_on_ground(), "walks up a slope", hiker);

    // Both move 0.05 a frame, into what is there.
    sample::Character pushed({-20, 0.92, 0}, options), lifted({-30, 1.02, 0}, options);
    for (int i = 1; i <= 40; ++i) {
        (void)world.set_bound(sliding, Obb{door.center + glm::dvec3(0, 0, 0.05 * i), door.axes, door.half_extents});
        (void)world.set_bound(rising, Obb{lift.center + glm::dvec3(0, 0.05 * i, 0), lift.axes, lift.half_extents});
        if (!world.update()) return 1;
        walk(pushed, world, {}, 1);
        walk(lifted, world, {}, 1);
    }
    check(near(pushed.position().z, 1 + 0.1 + 0.4) && near(pushed.feet(), 0.0), "is pushed along by a door", pushed);
    check(near(lifted.feet(), 2.1) && lifted.is_on_ground(), "rides up on a lift", lifted);
    return failures == 0 ? 0 : 1;
}
