// SPDX-License-Identifier: MIT
// The casters of a light that change a shadow on what a camera sees, against a map and a picture by brute force.
#include <doctest/doctest.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "depth_scenes.hpp"
#include "hostile_scenes.hpp"
#include "shadow_check.hpp"

namespace crofton::testing {
namespace {

using depth::DepthCuller;
using depth::DepthObject;
using depth::DepthReceiver;
using depth::DepthReceivers;
using depth::PictureView;
using depth::VisibleCluster;

struct View {
    glm::dmat4 to_clip;
    PictureView size;
};

struct Light {
    View map;
    float radius = 1.0f;
};

// With depth of another range than reversed.
View in_range(View view, DepthRange range) {
    glm::dmat4& m = view.to_clip;
    for (glm::length_t c = 0; c < 4; ++c)
        if (range == DepthRange::zero_to_one)
            m[c][2] = m[c][3] - m[c][2];
        else if (range == DepthRange::minus_one_to_one)
            m[c][2] = m[c][3] - 2.0 * m[c][2];
    view.size.depth = range;
    return view;
}

std::vector<DepthObject> objects_of(const Scene& scene, std::span<const std::uint32_t> which, const View& view) {
    std::vector<DepthObject> objects;
    for (const std::uint32_t i : which) {
        const PlacedMesh& o = scene.objects[i];
        objects.push_back(
            {&o.mesh->clusters, glm::mat4(view.to_clip * o.world), o.one_sided, o.hides, o.position_error});
    }
    return objects;
}

std::vector<DepthReceiver> receivers_of(const Scene& scene, std::span<const std::uint32_t> which, const View& map) {
    std::vector<DepthReceiver> receivers;
    for (const std::uint32_t i : which)
        receivers.push_back({&scene.objects[i].mesh->clusters, glm::mat4(map.to_clip * scene.objects[i].world)});
    return receivers;
}

ShadowCheck check_shadows(const Scene& scene, const Roles& roles, const View& camera, const Light& light,
                          oracle::NearMisses& random, DepthCuller& camera_culler, DepthCuller& light_culler,
                          DepthRange range = DepthRange::reversed_zero_to_one) {
    const View asked_camera = in_range(camera, range), asked_map = in_range(light.map, range);
    const std::vector<DepthObject> drawn = objects_of(scene, roles.drawn, asked_camera);
    const std::vector<DepthObject> casters = objects_of(scene, roles.casters, asked_map);
    const std::vector<DepthReceiver> receivers = receivers_of(scene, roles.drawn, asked_map);
    REQUIRE(camera_culler.find_visible(drawn, asked_camera.size));
    ShadowCheck result;
    REQUIRE(light_culler.find_visible(casters, asked_map.size));
    result.by_light = light_culler.statistics().triangles_listed;
    const auto found = light_culler.find_casters(casters, asked_map.size, {&camera_culler, receivers, light.radius});
    REQUIRE(found);
    result.listed = light_culler.statistics().triangles_listed;
    // The oracle draws with reversed depth.
    const auto reversed = receivers_of(scene, roles.drawn, light.map);
    compare_shadows(scene, roles, {camera.size, objects_of(scene, roles.drawn, camera)},
                    {light.map.size, objects_of(scene, roles.casters, light.map)}, {nullptr, reversed, light.radius},
                    *found, random, result);
    return result;
}

Roles everything(const Scene& scene) {
    Roles roles;
    for (std::uint32_t i = 0; i < scene.objects.size(); ++i) roles.drawn.push_back(i), roles.casters.push_back(i);
    return roles;
}

// Some are drawn only, and some cast shadows only.
Roles random_roles(const Scene& scene, oracle::NearMisses& random) {
    Roles roles;
    for (std::uint32_t i = 0; i < scene.objects.size(); ++i) {
        const std::size_t role = random.index(8);
        if (role != 0) roles.drawn.push_back(i);
        if (role != 1) roles.casters.push_back(i);
    }
    return roles;
}

View view_of(Camera camera, std::uint32_t width, std::uint32_t height) {
    camera.aspect = double(width) / height;
    return {world_to_clip(camera), {width, height}};
}

// A sun, with a map over a part of the scene, or a lamp: above, among the objects, within them, or opposite the camera.
Light random_light(oracle::NearMisses& random, const Camera& eye) {
    Camera light;
    light.forward = glm::dvec3(random.number(-1, 1), random.number(-1.5, -0.1), random.number(-1, 1));
    light.up = {0.3, 1, 0.2};
    const glm::dvec3 toward(random.number(-15, 15), random.number(-3, 3), random.number(-15, 15));
    if (random.index(5) == 0) light.forward = -eye.forward;
    if (random.index(2) == 0) {
        light.projection = Projection::orthographic;
        light.height = std::exp(random.number(1.5, 4.2));
        light.position = toward - 60.0 * glm::normalize(light.forward);
        light.near_distance = 1.0;
        light.far_distance = 140.0;
    } else {
        light.fov_y = random.number(0.3, 2.2);
        light.position = toward - random.number(0, 20) * glm::normalize(light.forward);
        light.near_distance = random.index(2) == 0 ? 0.05 : 0.5;
        light.far_distance = random.index(2) == 0 ? 60.0 : std::numeric_limits<double>::infinity();
    }
    const std::uint32_t sizes[] = {33, 96, 128, 256};
    const std::uint32_t width = sizes[random.index(4)], height = random.index(3) == 0 ? 80 : width;
    const float radii[] = {0.5f, 1.0f, 2.0f, 4.5f};
    return {view_of(light, width, height), radii[random.index(4)]};
}

}  // namespace

TEST_SUITE("depth/shadow") {
    TEST_CASE("texels that seen points read have the depth of all casters, or are farther from the light in both") {
        DepthCuller camera_culler, light_culler;
        ShadowCheck sum;
        for (std::uint64_t seed = 1; seed <= 200; ++seed) {
            CAPTURE(seed);
            oracle::NearMisses random(seed);
            const Scene scene = random_scene(random);
            const Roles roles = seed % 2 == 0 ? everything(scene) : random_roles(scene, random);
            const Camera camera = random_camera(random);
            const Light light = random_light(random, camera);
            const DepthRange ranges[] = {DepthRange::reversed_zero_to_one, DepthRange::zero_to_one,
                                         DepthRange::minus_one_to_one};
            const DepthRange range = ranges[seed % 5 < 3 ? 0 : seed % 5 - 2];
            const ShadowCheck c = check_shadows(scene, roles, view_of(camera, 120, 70), light, random, camera_culler,
                                                light_culler, range);
            CHECK(c.wrong == 0);
            sum.add(c);
        }
        CHECK(sum.shadows > 100'000);
        CHECK(2 * sum.listed < sum.by_light);
        CHECK(sum.listed < 4 * sum.needed);
    }

    TEST_CASE("walls upon walls, slivers, triangles of no area, lights inside of things: no shadow changes") {
        DepthCuller camera_culler, light_culler;
        for (int kind = 0; kind < static_cast<int>(Hostile::count); ++kind) {
            CAPTURE(kind);
            ShadowCheck sum;
            for (std::uint64_t seed = 1; seed <= 16; ++seed) {
                CAPTURE(seed);
                oracle::NearMisses random(seed);
                const Scene scene = hostile_scene(static_cast<Hostile>(kind), random);
                const Camera camera = hostile_camera(random);
                Light light = random_light(random, camera);
                // At the eye, or near it.
                if (seed % 3 == 0) {
                    Camera lamp = hostile_camera(random);
                    lamp.position += 0.1 * double(random.index(3)) * random.direction();
                    light.map = view_of(lamp, 96, 64);
                }
                const ShadowCheck c = check_shadows(scene, everything(scene), view_of(camera, 80, 50), light, random,
                                                    camera_culler, light_culler);
                CHECK(c.wrong == 0);
                sum.add(c);
            }
            CHECK(sum.lookups > 0);
        }
    }

    TEST_CASE("a sun's map of a street and its roofs lists what throws a shadow into the street") {
        // Two rows of houses; behind each, more houses, whose shadows fall away from the street or on roofs.
        Scene scene;
        scene.meshes.emplace_back(cube_mesh());
        scene.objects.push_back({&scene.meshes[0], placed({0, -1, 0}, {200, 1, 200}, {0, 1, 0}, 0.0)});
        for (int row = -6; row <= 6; ++row)
            for (int i = 0; row != 0 && i < 20; ++i)
                scene.objects.push_back(
                    {&scene.meshes[0], placed({8.0 * row, 4, 10.0 * i - 150}, {3, 4, 4.9}, {0, 1, 0}, 0.0), true});
        Camera camera;
        camera.position = {0, 1.7, 30};
        Camera sun;
        sun.projection = Projection::orthographic;
        sun.forward = {0.6, -1, 0.1};
        sun.height = 260;
        sun.position = -200.0 * glm::normalize(sun.forward);
        sun.far_distance = 400;
        oracle::NearMisses random(1);
        DepthCuller camera_culler, light_culler;
        const ShadowCheck c = check_shadows(scene, everything(scene), view_of(camera, 320, 180),
                                            {view_of(sun, 512, 512)}, random, camera_culler, light_culler);
        CHECK(c.wrong == 0);
        CHECK(c.needed > 20);
        CHECK(c.by_light > 700);
        CHECK(c.listed < 5 * c.needed);
    }

    TEST_CASE("a caster in the last texel that a lookup reads is listed, and one in the next tile is not") {
        // A sun from above: a texel is a metre. Receivers begin right of a border between tiles, the caster ends there.
        Camera sun;
        sun.projection = Projection::orthographic;
        sun.forward = {0, -1, 0};
        sun.up = {0, 0, -1};
        sun.position = {0, 90, 0};
        sun.height = 128;
        const View map = view_of(sun, 128, 128);
        Camera camera;
        camera.near_distance = 0.05;
        DepthCuller camera_culler, light_culler;
        oracle::NearMisses random(3);
        for (const float radius : {0.5f, 1.0f, 2.0f, 5.5f})
            for (const double length : {0.3, 50.0})
                for (const double distance : {-0.4, -0.1, 0.3}) {
                    CAPTURE(radius);
                    CAPTURE(length);
                    CAPTURE(distance);
                    const double edge = -0.5 + double{radius} + distance;
                    Scene scene;
                    scene.meshes.emplace_back(cube_mesh());
                    scene.objects = {
                        {&scene.meshes[0], placed({edge + length, -0.1, 0}, {length, 0.1, 4}, {0, 1, 0}, 0)},
                        {&scene.meshes[0], placed({-0.5, 40, 0}, {0.4, 1, 60}, {0, 1, 0}, 0)}};
                    camera.position = {edge + 0.1, 1, 5};
                    camera.forward = {0, -0.3, -1};
                    const ShadowCheck c = check_shadows(scene, everything(scene), view_of(camera, 160, 90),
                                                        {map, radius}, random, camera_culler, light_culler);
                    CHECK(c.wrong == 0);
                    if (distance < 0.0) CHECK(c.shadows > 0);
                    const auto casters = objects_of(scene, std::vector<std::uint32_t>{1}, map);
                    const auto receivers = receivers_of(scene, everything(scene).drawn, map);
                    const auto drawn = objects_of(scene, everything(scene).drawn, view_of(camera, 160, 90));
                    REQUIRE(camera_culler.find_visible(drawn, {160, 90}));
                    const auto found =
                        light_culler.find_casters(casters, map.size, {&camera_culler, receivers, radius});
                    CHECK(found->empty() == (distance > 0.0));
                }
    }

    TEST_CASE("nothing casts a shadow that nobody sees") {
        Scene scene;
        scene.meshes.emplace_back(cube_mesh());
        // A wall before the camera; behind it a floor and a roof; a lamp above the roof.
        scene.objects = {{&scene.meshes[0], placed({0, 0, -5}, {20, 20, 0.5}, {0, 1, 0}, 0.0)},
                         {&scene.meshes[0], placed({0, -1, -20}, {5, 0.5, 5}, {0, 1, 0}, 0.0)},
                         {&scene.meshes[0], placed({0, 2, -20}, {3, 0.5, 3}, {0, 1, 0}, 0.0)}};
        Camera lamp;
        lamp.position = {0, 8, -20};
        lamp.forward = {0, -1, 0};
        lamp.up = {0, 0, -1};
        lamp.fov_y = 0.6;
        const View camera = view_of({}, 160, 90), light = view_of(lamp, 128, 128);
        DepthCuller camera_culler, light_culler;
        const Roles roles = everything(scene);
        const auto drawn = objects_of(scene, roles.drawn, camera), casters = objects_of(scene, roles.casters, light);
        std::vector<DepthReceiver> receivers = receivers_of(scene, roles.drawn, light);
        const auto listed = [&](const DepthReceivers& of) {
            return light_culler.find_casters(casters, light.size, of)->size();
        };
        REQUIRE(camera_culler.find_visible(drawn, camera.size));
        CHECK(listed({&camera_culler, receivers}) == 0);
        CHECK(light_culler.nearness(64, 64) == std::numeric_limits<float>::infinity());
        // Without the wall, the floor and the roof's sides are seen.
        REQUIRE(camera_culler.find_visible(std::span(drawn).subspan(1), camera.size));
        CHECK(listed({&camera_culler, std::span(receivers).subspan(1)}) > 0);
        // A solid receiver is seen anywhere within its bound, also behind what hides it.
        REQUIRE(camera_culler.find_visible(drawn, camera.size));
        receivers[0].to_map = receivers[1].to_map;
        receivers[0].solid = true;
        CHECK(listed({&camera_culler, receivers}) > 0);
        // Where a receiver lies is not known: everything may be looked up.
        receivers[0].to_map[1][2] = std::numeric_limits<float>::quiet_NaN();
        REQUIRE(light_culler.find_visible(casters, light.size));
        const std::uint64_t by_light = light_culler.statistics().triangles_listed;
        CHECK(listed({&camera_culler, receivers}) > 0);
        CHECK(light_culler.statistics().triangles_listed == by_light);
        receivers[0] = receivers[1];
        for (const float error : {-1.0f, std::numeric_limits<float>::quiet_NaN()}) {
            auto moved = drawn;
            moved[1].position_error = error;
            REQUIRE(camera_culler.find_visible(moved, camera.size));
            CHECK(listed({&camera_culler, receivers}) > 0);
            CHECK(light_culler.statistics().triangles_listed == by_light);
        }
        REQUIRE(camera_culler.find_visible(drawn, camera.size));

        const auto code_of = [&](const DepthReceivers& of, const PictureView& map) {
            return light_culler.find_casters(casters, map, of).error().code;
        };
        CHECK(code_of({}, light.size) == ErrorCode::invalid_argument);
        CHECK(code_of({&light_culler, receivers}, light.size) == ErrorCode::invalid_argument);
        CHECK(code_of({&camera_culler, std::span(receivers).first(2)}, light.size) == ErrorCode::invalid_argument);
        for (const float radius : {0.0f, 0.4f, 2000.0f, std::numeric_limits<float>::quiet_NaN()})
            CHECK(code_of({&camera_culler, receivers, radius}, light.size) == ErrorCode::out_of_range);
        CHECK(code_of({&camera_culler, receivers}, {.width = 0}) == ErrorCode::out_of_range);
        CHECK(code_of({&camera_culler, receivers}, {.samples = 4}) == ErrorCode::out_of_range);
        // A camera that has seen nothing, and one that has not been asked.
        REQUIRE(camera_culler.find_visible({}, camera.size));
        CHECK(light_culler.find_casters(casters, light.size, {&camera_culler, {}})->empty());
        camera_culler = {};
        CHECK(code_of({&camera_culler, {}}, light.size) == ErrorCode::invalid_argument);
    }

    TEST_CASE("receivers that are not those of the camera's picture are refused, and nothing that is gone is read") {
        const auto cube = [] {
            const TriangleMesh mesh = cube_mesh();
            return std::make_unique<depth::ClusteredMesh>(
                depth::ClusteredMesh::cut(mesh.positions, mesh.indices).value());
        };
        // A floor before the camera, an object behind it, and a roof.
        auto floor = cube(), behind = cube();
        const auto roof = cube();
        Camera lamp;
        lamp.position = {0, 8, -9};
        lamp.forward = {0, -1, 0};
        lamp.up = {0, 0, -1};
        const View camera = view_of({}, 160, 90), light = view_of(lamp, 128, 128);
        const glm::dmat4 below = placed({0, -2, -9}, {4, 0.1, 4}, {0, 1, 0}, 0.0),
                         away = placed({0, 0, 20}, {1, 1, 1}, {0, 1, 0}, 0.0),
                         above = placed({0, 2, -9}, {1, 0.1, 1}, {0, 1, 0}, 0.0);
        DepthCuller camera_culler, light_culler;
        {
            // The objects are gone after the call.
            const std::vector<DepthObject> drawn = {{floor.get(), glm::mat4(camera.to_clip * below)},
                                                    {behind.get(), glm::mat4(camera.to_clip * away)}};
            REQUIRE(camera_culler.find_visible(drawn, camera.size));
        }
        const std::vector<DepthObject> casters = {{roof.get(), glm::mat4(light.to_clip * above)}};
        std::vector<DepthReceiver> receivers = {{floor.get(), glm::mat4(light.to_clip * below)}, {}};
        const auto answer = [&] { return light_culler.find_casters(casters, light.size, {&camera_culler, receivers}); };
        const auto check_refused = [&] {
            const auto refused = answer();
            REQUIRE_FALSE(refused);
            CHECK(refused.error().code == ErrorCode::invalid_argument);
            CHECK(refused.error().item == 0);
            CHECK(refused.error().message.find("another mesh") != std::string::npos);
        };
        REQUIRE(answer());
        CHECK(answer()->size() == 1);
        // Of an object of which nothing is seen no mesh is read, though it is gone.
        behind.reset();
        CHECK(answer()->size() == 1);
        // A copy has the same clusters, and so has what moves.
        const depth::ClusteredMesh copy = *floor;
        receivers[0].mesh = &copy;
        CHECK(answer()->size() == 1);
        depth::ClusteredMesh moved = std::move(*floor);
        receivers[0].mesh = &moved;
        CHECK(answer()->size() == 1);
        receivers[0].mesh = floor.get();
        check_refused();
        receivers[0].mesh = nullptr;
        check_refused();
        receivers[0].mesh = roof.get();
        check_refused();
        // Another mesh at the same place in memory.
        *floor = *cube();
        receivers[0].mesh = floor.get();
        check_refused();
        const auto loaded = depth::ClusteredMesh::deserialise(moved.serialise()).value();
        receivers[0].mesh = &loaded;
        check_refused();
        // An answer that is not the camera's.
        receivers[0].mesh = &moved;
        DepthCuller other_light;
        REQUIRE(other_light.find_casters(casters, light.size, {&camera_culler, receivers}));
        const auto of_casters = light_culler.find_casters(casters, light.size, {&other_light, receivers});
        REQUIRE_FALSE(of_casters);
        CHECK(of_casters.error().code == ErrorCode::invalid_argument);
        // A call that fails leaves the camera's answer.
        CHECK_FALSE(camera_culler.find_visible({}, {.width = 0}));
        CHECK(answer()->size() == 1);
    }

    TEST_CASE("any number of threads lists the same casters") {
        ThreadPool three(3);
        DepthCuller cameras[2], lights[2];
        for (std::uint64_t seed = 1; seed <= 100; ++seed) {
            CAPTURE(seed);
            oracle::NearMisses random(seed);
            const Scene scene = random_scene(random);
            const Camera camera = random_camera(random);
            const View view = view_of(camera, 160, 90);
            const Light light = random_light(random, camera);
            const Roles roles = random_roles(scene, random);
            const auto drawn = objects_of(scene, roles.drawn, view);
            const auto casters = objects_of(scene, roles.casters, light.map);
            std::vector<DepthReceiver> receivers = receivers_of(scene, roles.drawn, light.map);
            for (DepthReceiver& receiver : receivers) receiver.solid = random.index(20) == 0;
            std::vector<VisibleCluster> answers[2];
            for (int i = 0; i < 2; ++i) {
                Executor& executor = i == 0 ? serial_executor() : static_cast<Executor&>(three);
                REQUIRE(cameras[i].find_visible(drawn, view.size, executor));
                const auto found =
                    lights[i].find_casters(casters, light.map.size, {&cameras[i], receivers, light.radius}, executor);
                REQUIRE(found);
                answers[i].assign(found->begin(), found->end());
            }
            CHECK(std::equal(answers[0].begin(), answers[0].end(), answers[1].begin(), answers[1].end(),
                             [](const VisibleCluster& a, const VisibleCluster& b) {
                                 return a.object == b.object && a.cluster == b.cluster && a.triangles == b.triangles;
                             }));
        }
    }
}

}  // namespace crofton::testing
