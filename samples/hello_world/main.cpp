// SPDX-License-Identifier: MIT
// The README's program: a hundred spheres in rows, one that flies through them, and a camera.
#include <crofton/crofton.hpp>
#include <cstdio>

int main() {
    crofton::World world;
    for (int i = 0; i < 100; ++i)
        world.add({.bound = crofton::Sphere{{4.0 * (i % 10) - 18.0, 0.0, -4.0 * (i / 10) - 6.0}, 1.0}}).value();
    const auto sphere = world.add({.bound = crofton::Sphere{{-30.0, 0.0, -10.0}, 1.0}}).value();

    crofton::Camera camera;       // at the origin, looks along -z
    crofton::ViewResult visible;  // keeps its memory from frame to frame
    for (int frame = 0; frame < 60; ++frame) {
        world.set_bound(sphere, crofton::Sphere{{frame - 30.0, 0.0, -10.0}, 1.0}).value();
        world.update().value();                           // once a frame; the queries below are const
        world.view({.camera = camera}, visible).value();  // visible[i].object is what to draw
        for (const crofton::Contact& contact : world.contacts())
            if (contact.phase == crofton::ContactPhase::began)
                std::printf("frame %d: the sphere touches object %u\n", frame, contact.first.object.index);
    }
    const auto hit = world.raycast({camera.position, {2.0, 0.0, -6.0}});
    if (hit) std::printf("the ray hits object %u at %.2f\n", hit->object.index, hit->t);
    std::printf("%zu of %zu objects in view\n", visible.size(), world.object_count());
    return hit && visible.size() < world.object_count() ? 0 : 1;
}
