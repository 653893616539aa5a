// SPDX-License-Identifier: MIT
// Occluders that look large: walls of any height and width, floors, ceilings and tunnels hide what they hide.
#include <doctest/doctest.h>
#include <crofton/crofton.hpp>
#include <vector>

#include "box_at.hpp"
#include "occlusion_town.hpp"

using namespace crofton;
using namespace crofton::testing;

namespace {

// Slabs that only hide, and spheres. What should be hidden is what a buffer hides that all slabs are drawn into, chosen
// or not.
struct Slabs {
    World world;
    MeshHandle mesh = world.add_mesh(description_of(cuboid({1.0f, 1.0f, 1.0f}), true)).value();
    occlude::OccluderSet set;
    std::vector<occlude::OccluderId> ids;
    std::vector<Obb> boxes;

    void add_slab(const glm::dvec3& center, const glm::dvec3& half, double turn = 0.0) {
        const glm::dmat3 axes = glm::mat3_cast(glm::angleAxis(turn, glm::dvec3(0.0, 1.0, 0.0)));
        glm::dmat3 linear = axes;
        for (int k = 0; k < 3; ++k) linear[k] *= half[k];
        REQUIRE(world.add({.mesh = mesh, .transform = Transform{linear, center}, .only_occludes = true}).has_value());
        Obb box;
        box.center = center;
        box.axes = glm::mat3(axes);
        box.half_extents = glm::vec3(half);
        ids.push_back(set.place(box).value());
    }
    void add_sphere(const glm::dvec3& center, double radius = 1.0) {
        const Bound bound{Sphere{center, radius}};
        boxes.push_back(bound.box);
        REQUIRE(world.add({.bound = bound}).has_value());
    }
    // How many spheres are hidden, and how many the World finds hidden.
    struct Hidden {
        std::size_t expected, found;
    };
    [[nodiscard]] Hidden count(const Camera& camera, std::uint32_t max_occluders = 256) {
        REQUIRE(world.update().has_value());
        OcclusionOptions options{.max_occluders = max_occluders, .list_occluded = true};
        ViewResult visible;
        REQUIRE(world.view({.camera = camera, .occlusion = options}, visible).has_value());
        auto buffer = *occlude::OcclusionBuffer::create(options.size);
        buffer.draw(set, ids, *occlude::occlusion_view_of(camera));
        occlude::VisibleSet seen;
        occlude::find_visible(boxes, {}, buffer, seen);
        const std::size_t in_view = visible.size() + visible.occluded_ids().size();
        return {in_view - seen.size(), visible.occluded_ids().size()};
    }
};

void check(const Slabs::Hidden& hidden) {
    CHECK(hidden.expected > 0);
    CHECK(20 * hidden.found >= 19 * hidden.expected);  // edges are drawn a little otherwise
}

Camera standing(const glm::dvec3& forward = {0.0, 0.0, -1.0}) {
    Camera camera;
    camera.position = {0.0, 1.7, 0.0};
    camera.forward = forward;
    return camera;
}

Camera parallel() {
    Camera camera = standing();
    camera.projection = Projection::orthographic;
    camera.position = {0.0, 20.0, 0.0};
    camera.height = 90.0;
    camera.far_distance = 500.0;
    return camera;
}

void add_low_town(Slabs& slabs) {
    for (int i = 0; i < 300; ++i) slabs.add_sphere({i % 20 * 2.0 - 20.0, 1.0, -60.0 - i / 20 * 2.0});
}

}  // namespace

TEST_SUITE("world/large_occluders") {
    TEST_CASE("a wall before low objects hides them, whatever its height, width, place and turn") {
        for (const double half_height : {2.0, 4.0, 20.0, 100.0, 3000.0, 1e5})
            for (const double half_width : {0.6, 8.0, 60.0, 2000.0, 1e5})
                for (const double aside : {0.0, 0.9})
                    for (const double turn : {0.0, 0.6}) {
                        CAPTURE(half_height);
                        CAPTURE(half_width);
                        CAPTURE(aside);
                        CAPTURE(turn);
                        Slabs slabs;
                        add_low_town(slabs);
                        // Its edge, or its middle, is near the town's middle.
                        slabs.add_slab({aside * half_width, half_height - 1.0, -40.0}, {half_width, half_height, 0.2});
                        if (turn > 0.0 && half_width < 30.0)
                            slabs.add_slab({-aside * half_width, half_height - 1.0, -45.0},
                                           {half_width, half_height, 0.2}, turn);
                        const bool too_narrow = half_width < 1.0;
                        for (const Camera& camera : {standing(), parallel()}) {
                            const auto hidden = slabs.count(camera);
                            if (!too_narrow) check(hidden);
                            CHECK(20 * hidden.found >= 19 * hidden.expected);
                        }
                    }
    }

    TEST_CASE("floors hide what is below, ceilings what is above, and tunnels what is around") {
        for (const double half : {6.0, 50.0, 1000.0, 1e5})
            for (const double aside : {0.0, 0.9}) {
                CAPTURE(half);
                CAPTURE(aside);
                Slabs floor, ceiling, tunnel;
                for (int i = 0; i < 200; ++i) {
                    const glm::dvec3 place(i % 10 - 4.5, 0.0, -4.0 - i / 10);
                    floor.add_sphere(place - glm::dvec3(0.0, 3.0, 0.0), 0.2);
                    ceiling.add_sphere(place + glm::dvec3(0.0, 6.0, 0.0), 0.2);
                    tunnel.add_sphere({place.x * 4.0, 1.0, place.z}, 0.3);
                }
                floor.add_slab({aside * half, -0.1, -aside * half}, {half, 0.1, half});
                check(floor.count(standing({0.0, -0.5, -1.0})));
                ceiling.add_slab({aside * half, 3.0, -aside * half}, {half, 0.1, half});
                check(ceiling.count(standing({0.0, 0.5, -1.0})));
                for (const double side : {-2.0, 2.0}) tunnel.add_slab({side, 1.5, -aside * half}, {0.1, 3.0, half});
                tunnel.add_slab({0.0, -0.1, -aside * half}, {2.0, 0.1, half});
                tunnel.add_slab({0.0, 3.1, -aside * half}, {2.0, 0.1, half});
                check(tunnel.count(standing()));
                check(tunnel.count(standing({0.7, 0.0, -1.0})));
            }
    }

    TEST_CASE("a tall wall is worth more than many small occluders that hide less") {
        for (const double half_height : {3.0, 12.0, 300.0}) {
            Slabs slabs;
            add_low_town(slabs);
            for (int i = 0; i < 300; ++i)
                slabs.add_slab({i % 20 * 1.5 - 15.0, 0.6, -41.0 - i / 20 * 1.0}, {0.3, 0.3, 0.3});
            slabs.add_slab({0.0, half_height, -40.0}, {60.0, half_height, 0.2});
            check(slabs.count(standing(), 1));
        }
    }

    TEST_CASE("a large occluder with no object behind it is not drawn") {
        Slabs slabs;
        add_low_town(slabs);
        slabs.add_slab({0.0, -5.0, -70.0}, {500.0, 1.0, 500.0});    // ground below all
        slabs.add_slab({0.0, 50.0, -200.0}, {500.0, 50.0, 0.2});    // behind all
        slabs.add_slab({-500.0, 50.0, -60.0}, {400.0, 50.0, 1.0});  // beside
        REQUIRE(slabs.world.update().has_value());
        ViewResult visible;
        REQUIRE(slabs.world.view({.camera = standing(), .occlusion = OcclusionOptions{}}, visible).has_value());
        CHECK(visible.occlusion_statistics().occluders_drawn == 0);
    }
}
