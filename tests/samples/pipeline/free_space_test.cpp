// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <crofton/mesh/mesh_query.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <filesystem>
#include <glm/geometric.hpp>

#include "assets/flat_scene.hpp"
#include "assets/scene_source.hpp"
#include "pipeline/camera_path.hpp"
#include "pipeline/free_space.hpp"

using namespace crofton;
using namespace crofton::pipeline;

namespace {

void add_quad(scene::Scene& scene, std::array<glm::vec3, 4> corners) {
    TriangleMesh mesh;
    mesh.positions.assign(corners.begin(), corners.end());
    mesh.indices = {0, 1, 2, 0, 2, 3};
    const auto node = scene.add_node(scene::kNone, {});
    REQUIRE(scene.add_instance(*node, *scene.add_mesh(std::move(mesh))).has_value());
}

// A horizontal square about the y axis that faces up.
void add_floor(scene::Scene& scene, float y, float half = 10.0f) {
    add_quad(scene, {{{-half, y, -half}, {-half, y, half}, {half, y, half}, {half, y, -half}}});
    scene.update();
}

// Across the x axis at x, from z to z, two-sided.
void add_wall(scene::Scene& scene, float x, float z_min, float z_max) {
    add_quad(scene, {{{x, 0, z_min}, {x, 3, z_min}, {x, 3, z_max}, {x, 0, z_max}}});
    add_quad(scene, {{{x, 0, z_min}, {x, 0, z_max}, {x, 3, z_max}, {x, 3, z_min}}});
}

// A room of 20 × 3 × 20 m whose faces look inward.
void add_room(scene::Scene& scene) {
    const float a = 10, h = 3;
    add_quad(scene, {{{-a, 0, -a}, {-a, 0, a}, {a, 0, a}, {a, 0, -a}}});
    add_quad(scene, {{{-a, h, -a}, {a, h, -a}, {a, h, a}, {-a, h, a}}});
    add_quad(scene, {{{-a, 0, -a}, {a, 0, -a}, {a, h, -a}, {-a, h, -a}}});
    add_quad(scene, {{{-a, 0, a}, {-a, h, a}, {a, h, a}, {a, 0, a}}});
    add_quad(scene, {{{-a, 0, -a}, {-a, h, -a}, {-a, h, a}, {-a, 0, a}}});
    add_quad(scene, {{{a, 0, -a}, {a, 0, a}, {a, h, a}, {a, h, -a}}});
}

double length_of(std::span<const glm::dvec3> walk) {
    double length = 0.0;
    for (std::size_t i = 1; i < walk.size(); ++i) length += glm::distance(walk[i - 1], walk[i]);
    return length;
}

// How many of a walk's pieces cross a triangle, each by an exact ray.
int crossings(const assets::SceneSource& source, std::span<const glm::dvec3> walk) {
    const auto flat = assets::flat_scene(source).value();
    const auto tree = mesh::MeshTree::build(flat.mesh).value();
    int count = 0;
    for (std::size_t i = 1; i < walk.size(); ++i)
        count += mesh::hits_any({walk[i - 1], walk[i] - walk[i - 1], 1.0}, tree);
    return count;
}

}  // namespace

TEST_SUITE("pipeline/free_space") {
    TEST_CASE("an empty scene has none, nor one whose only face looks down") {
        scene::Scene scene;
        CHECK_FALSE(FreeSpace::find(scene, focus_of(scene)));
        add_quad(scene, {{{-1, 0, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0, 1}}});
        scene.update();
        CHECK_FALSE(FreeSpace::find(scene, {{-1, -1, -1}, {1, 1, 1}}));
    }
    TEST_CASE("one walks on the lowest floor with room to stand, not in the crawl space below it") {
        scene::Scene scene;
        for (const float height : {0.0f, 0.01f, 6.0f}) add_floor(scene, height);
        const auto space = FreeSpace::find(scene, focus_of(scene)).value();
        CHECK(space.places().size() > 1000);
        for (const glm::dvec3& p : space.places()) {
            CHECK(p.y > 0.01);
            CHECK(p.y < 6.0);
        }
        CHECK(length_of(space.walk()) > 20.0);
    }
    TEST_CASE("without a floor there is no place to stand") {
        scene::Scene scene;
        add_floor(scene, 0.0, 1.0f);
        const auto space = FreeSpace::find(scene, Aabb{{-10, 0, -1}, {10, 3, 1}}).value();
        for (const glm::dvec3& p : space.places()) CHECK(std::abs(p.x) <= 1.0);
    }
    TEST_CASE("a wall with a door is passed by the door, one without parts the room, and the larger part is kept") {
        for (const bool door : {true, false}) {
            CAPTURE(door);
            assets::SceneSource source;
            add_room(source.scene);
            add_wall(source.scene, 4.0f, -10.0f, door ? 7.0f : 10.0f);
            source.scene.update();
            const auto space = FreeSpace::find(source.scene, focus_of(source.scene)).value();
            const auto walk = space.walk();
            CHECK(crossings(source, walk) == 0);
            bool left = false, right = false;
            for (const glm::dvec3& p : walk) (p.x < 4.0 ? left : right) = true;
            CHECK(left);
            CHECK(right == door);
            for (std::size_t i = 1; i < walk.size(); ++i) {
                if ((walk[i - 1].x < 4.0) == (walk[i].x < 4.0)) continue;
                const double share = (4.0 - walk[i - 1].x) / (walk[i].x - walk[i - 1].x);
                CHECK(walk[i - 1].z + share * (walk[i].z - walk[i - 1].z) > 7.0);
            }
        }
    }
    TEST_CASE("one stands inside a room, where the most objects are seen, and outside of a thing") {
        scene::Scene scene;
        add_room(scene);
        // Behind this wall there is nothing but the room's own walls; before it lie twelve things.
        add_wall(scene, 6.0f, -10.0f, 9.0f);
        for (int i = 0; i < 12; ++i) add_wall(scene, -8.0f + 0.9f * static_cast<float>(i), -9.5f, -8.0f);
        scene.update();
        const auto space = FreeSpace::find(scene, focus_of(scene)).value();
        const auto stand = space.best_stand().value();
        CHECK(std::abs(stand.eye.z) < 10.0);
        CHECK(stand.eye.x < 6.0);
        CHECK(stand.eye.y > 0.0);
        CHECK(stand.eye.y < 3.0);
        CHECK(stand.objects >= 8);
        CHECK(glm::length(stand.forward) == doctest::Approx(1.0));
        CHECK(stand.forward.y == 0.0);

        scene::Scene table;
        add_floor(table, 1.0f, 1.0f);
        const auto top = FreeSpace::find(table, {{-1, 0, -1}, {1, 2, 1}}).value();
        CHECK_FALSE(top.best_stand());
    }
    TEST_CASE("through real levels the street crosses no wall, and one stands inside") {
        for (const char* name : {"freedoom2_maps.wad", "recast_dungeon.obj", "stk_black_forest.glb"}) {
            const std::string path = std::string(CROFTON_SHARED_DATA) + "/scenes/" + name;
            if (!std::filesystem::exists(path)) continue;
            CAPTURE(name);
            auto source = assets::load_scene(path).value();
            source.scene.update();
            const Aabb focus = focus_of(source.scene);
            const auto space = FreeSpace::find(source.scene, focus).value();
            const auto walk = space.walk();
            const double size = std::hypot(focus.max.x - focus.min.x, focus.max.z - focus.min.z);
            MESSAGE(name << ": " << space.places().size() << " places, a walk of " << walk.size() << " points, "
                         << length_of(walk) / size << " of the size");
            CHECK(length_of(walk) > 0.25 * size);
            CHECK(crossings(source, walk) == 0);
            const auto path_made = make_camera_path({.kind = "street", .frames = 200}, focus, walk).value();
            // Cameras cut no corner: each is on the walk.
            for (const Camera& camera : path_made.cameras) {
                double nearest = 1e9;
                for (std::size_t i = 1; i < walk.size(); ++i) {
                    const glm::dvec3 along = walk[i] - walk[i - 1];
                    const double t =
                        std::clamp(glm::dot(camera.position - walk[i - 1], along) / glm::dot(along, along), 0.0, 1.0);
                    nearest = std::min(nearest, glm::distance(camera.position, walk[i - 1] + t * along));
                }
                CHECK(nearest < 1e-9 * size);
            }
            const auto stand = space.best_stand().value();
            CHECK(stand.objects >= 1);
        }
    }
    TEST_CASE("things are looked at from outside, also one that is inside out") {
        for (const char* name : {"bunny", "homer", "horse", "teapot", "fandisk", "suzanne"}) {
            const std::string path = std::string(CROFTON_SHARED_DATA) + "/meshes/" + name + ".obj";
            if (!std::filesystem::exists(path)) continue;
            CAPTURE(name);
            auto source = assets::load_scene(path).value();
            source.scene.update();
            const auto space = FreeSpace::find(source.scene, focus_of(source.scene));
            if (space) CHECK_FALSE(space->best_stand());
        }
    }
}
