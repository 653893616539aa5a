// SPDX-License-Identifier: MIT
// Picking and contacts: what the viewer asks the World of the scene's meshes.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <crofton/mesh/mesh_query.hpp>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <random>

#include "viewer/mesh_world.hpp"
#include "viewer/picking.hpp"

using namespace crofton;
using namespace crofton::viewer;

namespace {

void place(scene::Scene& scene, scene::MeshId mesh, const scene::Transform& transform) {
    const auto node = scene.add_node(scene::kNone, transform);
    REQUIRE(node);
    REQUIRE(scene.add_instance(*node, mesh));
}

// Squares across the z axis at the given depths, one instance each.
scene::Scene squares(std::initializer_list<double> depths) {
    scene::Scene result;
    TriangleMesh mesh;
    mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    mesh.indices = {0, 1, 2, 0, 2, 3};
    const auto id = result.add_mesh(mesh);
    REQUIRE(id);
    for (const double z : depths) place(result, *id, {glm::dmat3(1.0), {0.0, 0.0, z}});
    result.update();
    return result;
}

// A unit cube, twelve triangles.
TriangleMesh cube() {
    TriangleMesh mesh;
    for (int i = 0; i < 8; ++i)
        mesh.positions.push_back(
            glm::vec3((i & 1) != 0 ? 0.5f : -0.5f, (i & 2) != 0 ? 0.5f : -0.5f, (i & 4) != 0 ? 0.5f : -0.5f));
    mesh.indices = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                    2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
    return mesh;
}

MeshWorld world_of(const scene::Scene& scene, std::vector<scene::InstanceId> movers = {}) {
    auto made = MeshWorld::create(scene, std::move(movers));
    REQUIRE(made);
    return std::move(*made);
}

// The nearest of all candidates' triangles, one after another; infinite where there is none.
double nearest_triangle(const scene::Scene& scene, std::span<const scene::InstanceId> candidates, const Ray& ray) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const scene::InstanceId i : candidates) {
        const TriangleMesh& mesh = scene.mesh(scene.mesh_of(i));
        const scene::Transform& world = scene.world(scene.node_of(i));
        const auto point = [&](std::size_t k) {
            return world.linear * glm::dvec3(mesh.positions[mesh.indices[k]]) + world.translation;
        };
        for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3)
            if (const auto hit = mesh::raycast(ray, Triangle{point(t), point(t + 1), point(t + 2)}))
                nearest = std::min(nearest, *hit);
    }
    return nearest;
}

}  // namespace

TEST_SUITE("viewer/picking") {
    TEST_CASE("nothing is picked from an empty list, behind the camera or beside the square") {
        const scene::Scene scene = squares({-5.0, 5.0});
        const MeshWorld meshes = world_of(scene);
        const Camera camera;
        CHECK_FALSE(pick(meshes.world(), {}, camera, {0.0, 0.0}));
        const scene::InstanceId behind[] = {1}, ahead[] = {0};
        CHECK_FALSE(pick(meshes.world(), behind, camera, {0.0, 0.0}));
        CHECK_FALSE(pick(meshes.world(), ahead, camera, {0.9, 0.9}));
    }
    TEST_CASE("the nearest of several is picked, with its triangle, its distance and the place") {
        const scene::Scene scene = squares({-9.0, -4.0, -6.0});
        const MeshWorld meshes = world_of(scene);
        const Camera camera;
        const scene::InstanceId all[] = {0, 1, 2};
        const auto hit = pick(meshes.world(), all, camera, {0.01, -0.05});
        REQUIRE(hit);
        CHECK(hit->instance == 1);
        CHECK(hit->triangle == 0);  // below the diagonal
        CHECK(hit->at.z == doctest::Approx(-4.0));
        CHECK(hit->distance == doctest::Approx(glm::length(hit->at)));
        // The cursor's tangent, times the depth.
        CHECK(hit->at.y == doctest::Approx(-0.05 * std::tan(0.5 * camera.fov_y) * 4.0));
        // What is not drawn is not picked: the next one is.
        const scene::InstanceId without_nearest[] = {0, 2};
        CHECK(pick(meshes.world(), without_nearest, camera, {0.01, -0.05})->instance == 2);
    }
    TEST_CASE("2,000 clicks on scaled, sheared and moving bodies pick what testing every triangle picks") {
        std::mt19937 random(5);
        const auto uniform = [&](double low, double high) {
            return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
        };
        scene::Scene scene;
        const auto mesh = scene.add_mesh(cube());
        REQUIRE(mesh);
        std::vector<scene::InstanceId> all;
        for (scene::InstanceId i = 0; i < 60; ++i) {
            glm::dmat3 linear;
            for (int k = 0; k < 9; ++k) linear[k / 3][k % 3] = uniform(-1.5, 1.5);
            place(scene, *mesh, {linear, {uniform(-8, 8), uniform(-5, 5), uniform(-25, -4)}});
            all.push_back(i);
        }
        scene.update();
        MeshWorld meshes = world_of(scene, {3, 4, 5});
        int picked = 0;
        for (int click = 0; click < 2000; ++click) {
            if (click % 100 == 99) {
                for (const scene::InstanceId i : {3u, 4u, 5u}) {
                    scene::Transform moved = scene.world(scene.node_of(i));
                    moved.translation += glm::dvec3(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
                    REQUIRE(scene.set_local(scene.node_of(i), moved));
                }
                scene.update();
                REQUIRE(meshes.update(false));
            }
            std::vector<scene::InstanceId> candidates;
            for (const scene::InstanceId i : all)
                if (random() % 4 != 0) candidates.push_back(i);
            const Camera camera;
            const glm::dvec2 cursor(uniform(-1, 1), uniform(-1, 1));
            const auto hit = pick(meshes.world(), candidates, camera, cursor);
            const double half = std::tan(0.5 * camera.fov_y);
            const Ray ray{camera.position,
                          glm::normalize(glm::dvec3(cursor.x * half * camera.aspect, cursor.y * half, -1.0))};
            const double expected = nearest_triangle(scene, candidates, ray);
            REQUIRE(hit.has_value() == std::isfinite(expected));
            if (!hit) continue;
            ++picked;
            CHECK(hit->distance == doctest::Approx(expected).epsilon(1e-6));
        }
        CHECK(picked > 300);
    }
}

TEST_SUITE("viewer/mesh_world") {
    TEST_CASE("contacts of scaled, sheared and mirrored bodies lie on both surfaces, apart there are none") {
        const glm::dmat3 linears[] = {glm::dmat3(1.0), glm::dmat3(3, 0, 0, 0, 1, 0, 0, 0, 0.5),
                                      // Turned, stretched and sheared; then mirrored.
                                      glm::dmat3(0.8, 0.6, 0, -1.2, 1.6, 0, 0.3, 0.4, 1.5),
                                      glm::dmat3(-1, 0, 0, 0.2, 1, 0, 0, 0, 2)};
        for (const glm::dmat3& linear_a : linears)
            for (const glm::dmat3& linear_b : linears) {
                scene::Scene scene;
                const auto mesh = scene.add_mesh(cube());
                REQUIRE(mesh);
                const glm::dvec3 at(100.0, 5.0, -3.0);
                for (const auto& [linear, place] : {std::pair{linear_a, at},
                                                    {linear_b, at + glm::dvec3(0.3, 0.45, 0.1)},
                                                    {linear_b, at + glm::dvec3(9.0, 0.0, 0.0)}}) {
                    const auto node = scene.add_node(scene::kNone, {linear, place});
                    REQUIRE(node);
                    REQUIRE(scene.add_instance(*node, *mesh));
                }
                scene.update();
                MeshWorld meshes = world_of(scene, {0, 1, 2});
                REQUIRE(meshes.update(true));
                // The third is far away.
                REQUIRE(meshes.world().contacts().size() == 1);
                const Contact& contact = meshes.world().contacts()[0];
                CHECK(contact.first.user == 0);
                CHECK(contact.second.user == 1);
                CHECK(contact.triangles.size() > 2);
                for (const mesh::MeshContact& found : contact.triangles)
                    for (const glm::dvec3& p : {found.segment.begin, found.segment.end})
                        for (const scene::InstanceId i : {0u, 1u}) {
                            const scene::Transform& world = scene.world(scene.node_of(i));
                            const glm::dvec3 local = glm::abs(glm::inverse(world.linear) * (p - world.translation));
                            CHECK(std::max({local.x, local.y, local.z}) == doctest::Approx(0.5).epsilon(1e-5));
                        }
                REQUIRE(meshes.update(false));
                CHECK(meshes.world().pairs().empty());
            }
    }
    TEST_CASE("what rests meets nobody") {
        scene::Scene scene;
        const auto mesh = scene.add_mesh(cube());
        REQUIRE(mesh);
        for (const double x : {0.0, 0.5, 0.9}) place(scene, *mesh, {glm::dmat3(1.0), {x, 0.0, 0.0}});
        scene.update();
        MeshWorld meshes = world_of(scene, {0, 1});
        REQUIRE(meshes.update(true));
        CHECK(meshes.world().object_count() == 3);
        CHECK(meshes.world().pairs().size() == 1);  // 0 and 1, not 2
    }
}
