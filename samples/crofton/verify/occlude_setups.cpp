// SPDX-License-Identifier: MIT
#include "occlude_setups.hpp"

#include <cmath>
#include <glm/geometric.hpp>

namespace crofton::cli {
namespace {

using sampling::Random;
using test::box_at, test::point_in_view;

constexpr occlude::BufferSize kSizes[] = {{64, 36}, {160, 90}, {333, 201}, {640, 360}};

Obb box_of(const glm::dvec3& center, double x, double y, double z) {
    Obb box;
    box.center = center;
    box.half_extents = {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
    return box;
}

OccludeSetup empty_setup(Random& random, double offset) {
    OccludeSetup setup;
    setup.size = kSizes[random.bits() % 4];
    setup.camera.position = offset * glm::dvec3(1.0, -0.75, 0.25) +
                            glm::dvec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    return setup;
}

// A small box behind `opening`, on the ray of the eye through it.
void add_behind(Random& random, const glm::dvec3& opening, OccludeSetup& setup) {
    const Camera& camera = setup.camera;
    const bool perspective = camera.projection == Projection::perspective;
    const glm::dvec3 along = perspective ? opening - camera.position : glm::normalize(camera.forward);
    const double beyond = random.uniform(0.01, 1.0) * (perspective ? 1.0 : 20.0);
    setup.objects.push_back(box_at(random, opening + beyond * along, 1e-3, 0.3));
}

// Two walls side by side, from 1e-6 to a tenth apart; or touching, with things before them too.
OccludeSetup gap(Random& random, double offset, bool touching) {
    OccludeSetup setup = empty_setup(random, offset);
    const glm::dvec3 middle = setup.camera.position + glm::dvec3(random.uniform(-2, 2), 0.0, -10.0);
    const double half_gap = touching ? 0.0 : 0.5e-6 * std::pow(1e5, random.uniform());
    setup.occluders = {box_of(middle - glm::dvec3(8.0 + half_gap, 0.0, 0.0), 8.0, 8.0, 0.1),
                       box_of(middle + glm::dvec3(8.0 + half_gap, 0.0, 0.0), 8.0, 8.0, 0.1)};
    for (int i = 0; i < 64; ++i) {
        const glm::dvec3 opening =
            middle + glm::dvec3(0.9 * half_gap * random.uniform(-1, 1), random.uniform(-4, 4), 0.0);
        if (touching && i % 4 == 0)  // nothing is seen behind them
            setup.objects.push_back(box_at(random, glm::mix(opening, setup.camera.position, 0.2), 1e-3, 0.3));
        else
            add_behind(random, opening, setup);
    }
    return setup;
}
OccludeSetup narrow_gap(Random& random, double offset) {
    return gap(random, offset, false);
}
OccludeSetup touching_walls(Random& random, double offset) {
    return gap(random, offset, true);
}

// The wall ends just before the picture does.
OccludeSetup open_edge(Random& random, double offset) {
    OccludeSetup setup = empty_setup(random, offset);
    const double opening = 1e-6 * std::pow(1e5, random.uniform());
    const double edge = 10.0 * std::tan(0.5 * setup.camera.fov_y) * setup.camera.aspect;
    setup.occluders = {box_of(setup.camera.position + glm::dvec3(edge - opening - 50.0, 0.0, -10.1), 50.0, 50.0, 0.1)};
    for (int i = 0; i < 64; ++i)
        add_behind(random,
                   setup.camera.position + glm::dvec3(edge - random.uniform() * opening, random.uniform(-5, 5), -10.0),
                   setup);
    return setup;
}

// Seen from above in parallel, edge to edge, some missing.
OccludeSetup parallel_tiles(Random& random, double offset) {
    OccludeSetup setup = empty_setup(random, offset);
    Camera& camera = setup.camera;
    camera.forward = {0.0, -1.0, 0.0};
    camera.up = {0.0, 0.0, -1.0};
    camera.projection = Projection::orthographic;
    camera.height = 16.0;
    camera.aspect = 1.0;
    for (int x = -8; x < 8; ++x)
        for (int z = -8; z < 8; ++z) {
            const glm::dvec3 center = camera.position + glm::dvec3(x + 0.5, -40.0, z + 0.5);
            if (random.uniform() < 0.8)
                setup.occluders.push_back(box_of(center, 0.5, 0.1, 0.5));
            else
                add_behind(random, center + glm::dvec3(random.uniform(-0.5, 0.5), 0.0, random.uniform(-0.5, 0.5)),
                           setup);
        }
    return setup;
}

OccludeSetup eye_inside(Random& random, double offset) {
    OccludeSetup setup = random_setup(random, offset);
    setup.occluders.push_back(box_at(random, setup.camera.position, 0.5, 20.0));
    return setup;
}

OccludeSetup through_near_plane(Random& random, double offset) {
    OccludeSetup setup = random_setup(random, offset);
    const double close = setup.camera.near_distance;
    for (int i = 0; i < 6; ++i)
        setup.occluders.push_back(box_at(random, point_in_view(random, setup.camera, close * random.uniform(0.5, 1.5)),
                                         0.1 * close, 4.0 * close));
    return setup;
}

OccludeSetup slivers(Random& random, double offset) {
    OccludeSetup setup = random_setup(random, offset);
    setup.occluders.resize(2);
    for (int i = 0; i < 20'000; ++i) {
        Obb box = box_at(random, point_in_view(random, setup.camera, random.uniform(2.0, 40.0)), 0.01, 1.0);
        box.half_extents[static_cast<int>(random.bits() % 3)] = 1e-4f;
        setup.occluders.push_back(box);
    }
    return setup;
}

// Plates and needles, so small that together they leave many rays free; one plate in 1,000 is some pixels large. Specks
// lie just beyond the edges of these: who covers a pixel too much hides them.
OccludeSetup many_slivers(Random& random, double offset) {
    OccludeSetup setup = random_setup(random, offset);
    setup.size = {640, 360};
    setup.camera.projection = Projection::perspective;
    setup.camera.fov_y = random.uniform(0.5, 1.2);
    setup.occluders.resize(1);
    setup.objects.resize(16);
    setup.occluders.reserve(1'000'001);
    for (int i = 0; i < 1'000'000; ++i) {
        const bool is_large = i % 1000 == 0;
        const double distance = random.uniform(2.0, 40.0), size = is_large ? 0.05 : 0.002;
        const glm::dvec3 at = point_in_view(random, setup.camera, distance);
        Obb box = box_at(random, at, 0.4 * size * distance, size * distance);
        const auto k = static_cast<int>(random.bits() % 3), edge = (k + 1) % 3;
        box.half_extents[k] = 1e-5f;
        if (i % 2 == 1) box.half_extents[edge] = 1e-4f;
        setup.occluders.push_back(box);
        if (!is_large || setup.objects.size() >= 256) continue;
        const double half = 1.01 * static_cast<double>(box.half_extents[edge]);
        add_behind(random, at + half * glm::dvec3(box.axes[edge]), setup);
        setup.objects.back().half_extents = glm::vec3(1e-4f);
    }
    return setup;
}

}  // namespace

OccludeSetup random_setup(Random& random, double offset) {
    OccludeSetup setup = test::random_scene(random, offset, 256);
    setup.size = kSizes[test::pick(random, 4)];
    return setup;
}

std::vector<HardSetup> hard_setups() {
    return {{"a gap between two occluders", narrow_gap},
            {"two large boxes that touch", touching_walls},
            {"an opening at the picture's edge", open_edge},
            {"tiles seen in parallel", parallel_tiles},
            {"the eye inside an occluder", eye_inside},
            {"occluders through the near plane", through_near_plane},
            {"20,000 slivers", slivers, 100},
            {"a million slivers", many_slivers, 1000}};
}

}  // namespace crofton::cli
