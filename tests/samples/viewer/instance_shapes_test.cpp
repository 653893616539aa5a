// SPDX-License-Identifier: MIT
// Picking and contacts: what the viewer asks of instances' triangles and hulls.
#include <doctest/doctest.h>
#include <box_mesh.hpp>
#include <region_folder.hpp>

#include <algorithm>
#include <cmath>
#include <crofton/mesh/mesh_query.hpp>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <random>

#include "pipeline/pipeline.hpp"
#include "viewer/found_contacts.hpp"
#include "viewer/picking.hpp"

using namespace crofton;
using namespace crofton::viewer;

namespace {

void place(scene::Scene& scene, scene::MeshId mesh, const Transform& transform) {
    const auto node = scene.add_node(scene::kNone, transform).value();
    REQUIRE(scene.add_instance(node, mesh));
}

// Squares across the z axis at the given depths, one instance each.
scene::Scene squares(std::initializer_list<double> depths) {
    scene::Scene result;
    TriangleMesh mesh;
    mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    mesh.indices = {0, 1, 2, 0, 2, 3};
    const auto id = result.add_mesh(mesh).value();
    for (const double z : depths) place(result, id, {glm::dmat3(1.0), {0.0, 0.0, z}});
    result.update();
    return result;
}

// A World of the instances' bounds, as the viewer has it, and their triangles.
struct Picker {
    pipeline::Pipeline pipeline;
    InstanceShapes shapes;

    explicit Picker(const scene::Scene& scene, std::vector<scene::InstanceId> movers = {})
        : pipeline(make(scene, std::move(movers))), shapes(scene) {}
    static pipeline::Pipeline make(const scene::Scene& scene, std::vector<scene::InstanceId> movers) {
        return pipeline::Pipeline::create(scene, std::move(movers), {}, serial_executor()).value();
    }
    std::optional<Pick> operator()(std::span<const scene::InstanceId> candidates, const Camera& camera,
                                   const glm::dvec2& cursor) {
        return pick(pipeline.world(), shapes, candidates, camera, cursor);
    }
};

// The nearest of all candidates' triangles, one after another; infinite where there is none.
double nearest_triangle(const scene::Scene& scene, std::span<const scene::InstanceId> candidates, const Ray& ray) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const scene::InstanceId i : candidates) {
        const TriangleMesh& mesh = scene.mesh(scene.mesh_of(i));
        const Transform& world = scene.world(scene.node_of(i));
        const auto point = [&](std::size_t k) {
            return world.linear * glm::dvec3(mesh.positions[mesh.indices[k]]) + world.translation;
        };
        for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3)
            if (const auto hit = mesh::raycast(ray, Triangle{point(t), point(t + 1), point(t + 2)}))
                nearest = std::min(nearest, *hit);
    }
    return nearest;
}

struct Uniform {
    std::mt19937 random;
    double operator()(double low, double high) {
        return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
    }
};

// Cubes that are turned, scaled and sheared, with their middles in the box.
std::vector<scene::InstanceId> scatter_cubes(scene::Scene& scene, Uniform& uniform, scene::InstanceId count,
                                             const Aabb& box) {
    const auto mesh = scene.add_mesh(testing::cube_mesh(0.5f)).value();
    std::vector<scene::InstanceId> all;
    for (scene::InstanceId i = 0; i < count; ++i) {
        Transform transform;
        for (int k = 0; k < 9; ++k) transform.linear[k / 3][k % 3] = uniform(-1.5, 1.5);
        for (int k = 0; k < 3; ++k) transform.translation[k] = uniform(box.min[k], box.max[k]);
        place(scene, mesh, transform);
        all.push_back(i);
    }
    scene.update();
    return all;
}

}  // namespace

TEST_SUITE("viewer/picking") {
    TEST_CASE("a click on an empty list, behind the camera or outside the square picks nothing") {
        const scene::Scene scene = squares({-5.0, 5.0});
        Picker pick_at(scene);
        const Camera camera;
        CHECK_FALSE(pick_at({}, camera, {0.0, 0.0}));
        const scene::InstanceId behind[] = {1}, ahead[] = {0};
        CHECK_FALSE(pick_at(behind, camera, {0.0, 0.0}));
        CHECK_FALSE(pick_at(ahead, camera, {0.9, 0.9}));
    }
    TEST_CASE("the nearest of several is picked, with its triangle, its distance and the place") {
        const scene::Scene scene = squares({-9.0, -4.0, -6.0});
        Picker pick_at(scene);
        const Camera camera;
        const scene::InstanceId all[] = {0, 1, 2};
        const auto hit = pick_at(all, camera, {0.01, -0.05}).value();
        CHECK(hit.instance == 1);
        CHECK(hit.triangle == 0);  // below the diagonal
        CHECK(hit.at.z == doctest::Approx(-4.0));
        CHECK(hit.distance == doctest::Approx(glm::length(hit.at)));
        // The cursor's tangent, times the depth.
        CHECK(hit.at.y == doctest::Approx(-0.05 * std::tan(0.5 * camera.fov_y) * 4.0));
        // What is not drawn is not picked: the next one is.
        const scene::InstanceId without_nearest[] = {0, 2};
        CHECK(pick_at(without_nearest, camera, {0.01, -0.05})->instance == 2);
    }
    TEST_CASE("2,000 clicks on scaled, sheared and moving shapes pick what testing every triangle picks") {
        Uniform uniform{std::mt19937(5)};
        scene::Scene scene;
        const auto all = scatter_cubes(scene, uniform, 60, {{-8, -5, -25}, {8, 5, -4}});
        Picker pick_at(scene, {3, 4, 5});
        int picked = 0;
        for (int click = 0; click < 2000; ++click) {
            if (click % 100 == 99) {
                for (const scene::InstanceId i : {3u, 4u, 5u}) {
                    Transform moved = scene.world(scene.node_of(i));
                    moved.translation += glm::dvec3(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
                    REQUIRE(scene.set_local(scene.node_of(i), moved));
                }
                scene.update();
                REQUIRE(pick_at.pipeline.run(Camera{}));
            }
            std::vector<scene::InstanceId> candidates;
            for (const scene::InstanceId i : all)
                if (uniform.random() % 4 != 0) candidates.push_back(i);
            const Camera camera;
            const glm::dvec2 cursor(uniform(-1, 1), uniform(-1, 1));
            const auto hit = pick_at(candidates, camera, cursor);
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
    TEST_CASE("1,000 clicks over regions pick what testing every triangle of the whole scene picks") {
        Uniform uniform{std::mt19937(8)};
        scene::Scene scene;
        const auto all = scatter_cubes(scene, uniform, 200, {{-30, -5, -30}, {30, 5, 30}});
        const testing::RegionFolder folder(scene, 4, 3);
        auto regions = pipeline::RegionPipeline::open(folder.path, {.stream = {.distance = 40.0}}).value();
        int picked = 0;
        for (int click = 0; click < 1000; ++click) {
            Camera camera;
            camera.position = {uniform(-10, 10), uniform(-2, 2), uniform(-10, 10)};
            camera.forward = {uniform(-1, 1), 0.0, uniform(-1, 1)};
            const auto frame = regions.run(camera, serial_executor()).value();
            const glm::dvec2 cursor(uniform(-1, 1), uniform(-1, 1));
            const auto hit = pick(regions, frame.visible_ids, camera, cursor);
            const double half = std::tan(0.5 * camera.fov_y);
            const glm::dvec3 back = -glm::normalize(camera.forward),
                             right = glm::normalize(glm::cross(camera.up, back)), up = glm::cross(back, right);
            const Ray ray{camera.position,
                          glm::normalize(cursor.x * half * camera.aspect * right + cursor.y * half * up - back)};
            const double expected = nearest_triangle(scene, all, ray);
            // Regions are attached as far as 40, in a view that ends within.
            if (!hit) CHECK(expected > frame.camera.far_distance);
            if (!hit) continue;
            ++picked;
            CHECK(hit->distance == doctest::Approx(expected).epsilon(1e-6));
            // The region and its object by name are the instance that was baked there.
            const std::uint32_t place = regions.place_of(hit->instance);
            CHECK(regions.instance_of(regions.object_of(hit->instance)) == hit->instance);
            CHECK(hit->instance - regions.first_of(place) < regions.stream().index()[place].objects);
            const auto at = regions.drawables()->world_of(hit->instance).translation;
            CHECK(glm::distance(at, hit->at) < 3.0);
        }
        CHECK(picked > 200);
        CHECK(regions.instance_of({}) == scene::kNone);
        CHECK(regions.object_of(scene::kNone).is_null());
    }
}

TEST_SUITE("viewer/instance_shapes") {
    // Turned; stretched; turned, stretched and sheared; mirrored.
    const glm::dmat3 kLinears[] = {
        glm::dmat3(1.0), glm::dmat3(0.8, 0.6, 0, -0.6, 0.8, 0, 0, 0, 1), glm::dmat3(3, 0, 0, 0, 1, 0, 0, 0, 0.5),
        glm::dmat3(0.8, 0.6, 0, -1.2, 1.6, 0, 0.3, 0.4, 1.5), glm::dmat3(-1, 0, 0, 0.2, 1, 0, 0, 0, 2)};
    // Two cubes that meet and a third far away.
    scene::Scene cubes(const glm::dmat3& linear_a, const glm::dmat3& linear_b) {
        scene::Scene scene;
        const auto mesh = scene.add_mesh(testing::cube_mesh(0.5f)).value();
        const glm::dvec3 at(100.0, 5.0, -3.0);
        place(scene, mesh, {linear_a, at});
        place(scene, mesh, {linear_b, at + glm::dvec3(0.3, 0.45, 0.1)});
        place(scene, mesh, {linear_b, at + glm::dvec3(9.0, 0.0, 0.0)});
        scene.update();
        return scene;
    }
    // How far from the cube's middle, as a share of the way to its surface.
    double depth_in(const scene::Scene& scene, scene::InstanceId i, const glm::dvec3& p) {
        const Transform& world = scene.world(scene.node_of(i));
        const glm::dvec3 local = glm::abs(glm::inverse(world.linear) * (p - world.translation));
        return 2.0 * std::max({local.x, local.y, local.z});
    }
    constexpr InstancePair kAllPairs[] = {{0, 1}, {0, 2}, {1, 2}};

    TEST_CASE("contacts of scaled, sheared and mirrored shapes lie on both surfaces, apart there are none") {
        for (const glm::dmat3& linear_a : kLinears)
            for (const glm::dmat3& linear_b : kLinears) {
                const scene::Scene scene = cubes(linear_a, linear_b);
                InstanceShapes shapes(scene);
                const auto contacts = shapes.triangle_contacts(kAllPairs);
                REQUIRE(contacts.size() == 1);
                CHECK(contacts[0].first == 0);
                CHECK(contacts[0].second == 1);
                CHECK(contacts[0].triangles.size() > 2);
                for (const mesh::MeshContact& found : contacts[0].triangles)
                    for (const glm::dvec3& p : {found.segment.begin, found.segment.end})
                        for (const scene::InstanceId i : {0u, 1u})
                            CHECK(depth_in(scene, i, p) == doctest::Approx(1.0).epsilon(1e-5));
            }
    }
    TEST_CASE("hulls are the cubes' own, and their manifolds push the shapes apart along the normal") {
        for (const glm::dmat3& linear_a : kLinears)
            for (const glm::dmat3& linear_b : kLinears) {
                scene::Scene scene = cubes(linear_a, linear_b);
                InstanceShapes shapes(scene);
                int edges = 0;
                REQUIRE(shapes.outline(0, [&](const glm::dvec3& from, const glm::dvec3& to) {
                    ++edges;
                    CHECK(depth_in(scene, 0, from) == doctest::Approx(1.0).epsilon(1e-5));
                    CHECK(depth_in(scene, 0, to) == doctest::Approx(1.0).epsilon(1e-5));
                    CHECK(depth_in(scene, 0, 0.5 * (from + to)) == doctest::Approx(1.0).epsilon(1e-5));
                }));
                CHECK(edges == 12);
                const auto contacts = shapes.hull_contacts(kAllPairs);
                REQUIRE(contacts.size() == 1);
                REQUIRE(!contacts[0].points.empty());
                const convex::TrackedPoint& point = contacts[0].points[0];
                CHECK(point.began);
                double depth = 0.0;
                for (const convex::TrackedPoint& each : contacts[0].points) depth = std::max(depth, each.contact.depth);
                CHECK(depth > 0.0);
                // The same again: nothing has just begun.
                CHECK_FALSE(shapes.hull_contacts(kAllPairs)[0].points[0].began);
                // Moved out by its depth and a little, the second one is free.
                for (const auto& [share, meets] : {std::pair{0.99, true}, {1.01, false}}) {
                    Transform apart = scene.world(scene.node_of(1));
                    const Transform old = apart;
                    apart.translation += share * depth * point.normal;
                    REQUIRE(scene.set_local(scene.node_of(1), apart));
                    scene.update();
                    CHECK(shapes.hull_contacts(kAllPairs).empty() == !meets);
                    REQUIRE(scene.set_local(scene.node_of(1), old));
                    scene.update();
                }
            }
    }
    TEST_CASE("a flat object has no hull and no contacts, and its triangles are hit all the same") {
        const scene::Scene scene = squares({-5.0, -5.0});
        InstanceShapes shapes(scene);
        CHECK_FALSE(shapes.outline(0, [](const glm::dvec3&, const glm::dvec3&) {}));
        CHECK(shapes.hull_contacts(std::span(kAllPairs, 1)).empty());
        CHECK(shapes.raycast({{0.1, 0.2, 0}, {0, 0, -1}}, 1)->t == doctest::Approx(5.0));
    }
    TEST_CASE("contacts are found again when the scene has moved or other pairs meet, and dropped when not wanted") {
        scene::Scene scene = cubes(glm::dmat3(1.0), glm::dmat3(1.0));
        InstanceShapes shapes(scene);
        FoundContacts contacts;
        contacts.update(shapes, 0, kAllPairs, true, false);
        CHECK(contacts.triangles().size() == 1);
        CHECK(contacts.hulls().empty());
        contacts.update(shapes, 0, kAllPairs, true, true);
        CHECK(contacts.hulls().size() == 1);
        CHECK(contacts.hulls()[0].points[0].began);
        contacts.update(shapes, 0, kAllPairs, true, true);
        CHECK(contacts.hulls()[0].points[0].began);  // nothing was asked again
        contacts.update(shapes, 1, kAllPairs, false, true);
        CHECK_FALSE(contacts.hulls()[0].points[0].began);
        CHECK(contacts.triangles().empty());
        contacts.update(shapes, 1, std::span(kAllPairs).subspan(1), false, true);
        CHECK(contacts.hulls().empty());
    }
}
