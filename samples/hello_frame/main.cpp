// SPDX-License-Identifier: MIT
// A yard of crates, a sphere that rolls through it, and a camera: what is seen, what touches, what a ray hits.
#include <crofton/crofton.hpp>
#include <cstdint>
#include <cstdio>
#include <vector>

int main() {
    // Any layout of positions and indices will do; World copies what it needs.
    const std::vector<float> corners = {-1, 0, -1, 1, 0, -1, -1, 2, -1, 1, 2, -1, -1, 0, 1, 1, 0, 1, -1, 2, 1, 1, 2, 1};
    const std::vector<std::uint16_t> triangles = {0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                                                  2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6};
    crofton::World world;
    const auto mesh = world.add_mesh({.positions = {corners.data(), 8}, .indices = triangles});
    if (!mesh) return std::fprintf(stderr, "%s\n", mesh.error().message.c_str()), 1;

    std::vector<crofton::ObjectHandle> crates;
    for (int i = 0; i < 100; ++i) {
        const crofton::Transform place{glm::dmat3(1.0), {4.0 * (i % 10), 0.0, -4.0 * (i / 10)}};
        crates.push_back(world.add({.mesh = *mesh, .transform = place, .user = std::uint64_t(i)}).value());
    }
    // An object may be a bound alone: a box, an aligned box or a sphere.
    const auto sphere = world.add({.bound = crofton::Sphere{{-3.0, 1.0, -8.0}, 1.0}, .user = 100}).value();

    crofton::Camera camera;  // right-handed, reversed-Z; docs/conventions.md
    camera.position = {18.0, 1.8, 12.0};
    crofton::ViewResult visible;  // keeps its memory: no allocation once warm
    std::size_t seen = 0, touched = 0;
    for (int frame = 0; frame < 60; ++frame) {
        // World detects motion automatically. Changes take effect in update().
        const double x = -3.0 + 0.55 * frame;
        if (auto moved = world.set_bound(sphere, crofton::Sphere{{x, 1.0, -8.0}, 1.0}); !moved) return 1;
        if (frame == 30) world.remove(crates[25]).value();  // its handle is stale from now on
        world.update().value();                             // once a frame; takes the host's job system

        // Const from here on, from any thread.
        world.view({.camera = camera}, visible).value();
        seen = visible.size();
        for (std::size_t i = 0; i < visible.size(); ++i) {
            // draw(models[visible[i].user]);
        }
        for (const crofton::Contact& contact : world.contacts()) {
            if (contact.phase != crofton::ContactPhase::began) continue;
            std::printf("frame %2d: %llu touches %llu, %.2f deep\n", frame,
                        static_cast<unsigned long long>(contact.first.user),
                        static_cast<unsigned long long>(contact.second.user), contact.depth);
            ++touched;
        }
    }
    const auto hit = world.raycast({camera.position, {0.0, 0.0, -1.0}});
    if (hit) std::printf("ahead: crate %d at %.1f m\n", static_cast<int>(hit->user), hit->t);
    std::printf("%zu of %zu objects in view, %zu touched\n", seen, world.object_count(), touched);
    return seen > 0 && seen < world.object_count() && touched > 0 && !world.contains(crates[25]) ? 0 : 1;
}
