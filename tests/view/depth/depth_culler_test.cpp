// SPDX-License-Identifier: MIT
#include <crofton/depth/depth_culler.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <crofton/sampling/sampling.hpp>
#include <limits>
#include <set>

#include "owner_check.hpp"

namespace crofton::testing {
namespace {

using depth::DepthCuller;
using depth::DepthObject;
using depth::VisibleCluster;

TEST_CASE("no triangle that owns a sample is left out, however the renderer rounds") {
    Checked sum;
    DepthCuller culler;
    for (std::uint64_t seed = 1; seed <= 200; ++seed) {
        CAPTURE(seed);
        oracle::NearMisses random(seed);
        const Scene scene = random_scene(random);
        for (int view = 0; view < 3; ++view) {
            Camera camera = random_camera(random);
            const auto width = static_cast<std::uint32_t>(64 + random.index(200));
            const auto height = static_cast<std::uint32_t>(40 + random.index(120));
            camera.aspect = double(width) / height;
            const Checked c = check(scene, camera, width, height, seed, culler);
            CHECK(c.lost == 0);
            CHECK(c.too_near == 0);
            sum.owners += c.owners, sum.listed += c.listed, sum.total += c.total, sum.lost += c.lost,
                sum.too_near += c.too_near;
        }
    }
    MESSAGE("listed ", sum.listed, ", owners ", sum.owners, ", all ", sum.total, "; lost ", sum.lost, ", too near ",
            sum.too_near);
    CHECK(sum.listed < 4 * sum.owners);
}

TEST_CASE("every projection's depth range and far cameras lose nothing") {
    DepthCuller culler;
    std::uint64_t listed[3] = {};
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
        CAPTURE(seed);
        oracle::NearMisses random(1000 + seed);
        const Scene scene = random_scene(random);
        Camera camera = random_camera(random);
        camera.aspect = 1.5;
        if (camera.far_distance > 1e6) camera.far_distance = 500.0;
        oracle::OwnerPicture picture(150, 100);
        oracle::OwnerRenderer renderer(picture, {.wobble = 0.0005}, seed);
        for (std::uint32_t i = 0; i < scene.objects.size(); ++i) {
            const PlacedMesh& o = scene.objects[i];
            renderer.draw(
                {o.mesh->mesh.positions, o.mesh->mesh.indices, glm::mat4(world_to_clip(camera) * o.world), o.one_sided},
                i);
        }
        const DepthRange ranges[] = {DepthRange::reversed_zero_to_one, DepthRange::zero_to_one,
                                     DepthRange::minus_one_to_one};
        for (int r = 0; r < 3; ++r) {
            const glm::dmat4 to_clip = world_to_clip(camera, ranges[r]);
            std::vector<DepthObject> objects;
            for (const PlacedMesh& o : scene.objects)
                objects.push_back({&o.mesh->clusters, glm::mat4(to_clip * o.world), o.one_sided, o.hides});
            const auto found = culler.find_visible(objects, {150, 100, ranges[r]});
            REQUIRE(found);
            std::vector<std::uint64_t> all;
            for (const VisibleCluster& c : *found)
                for (std::uint32_t k = 0; k < 64; ++k)
                    if (c.triangles >> k & 1)
                        all.push_back(std::uint64_t{c.object} << 32 |
                                      (objects[c.object].mesh->clusters()[c.cluster].first_triangle + k));
            listed[r] += all.size();
            std::size_t lost = 0;
            for (const std::uint64_t owner : picture.owners)
                lost += owner != oracle::OwnerPicture::kNobody && !std::binary_search(all.begin(), all.end(), owner);
            CHECK(lost == 0);
        }
    }
    // Depth that is not reversed has fewer bits far away, and finds less.
    CHECK(listed[1] < 3 * listed[0]);
}

TEST_CASE("matrices and meshes that cannot be placed are listed whole, and spoil nothing else") {
    oracle::NearMisses random(3);
    const CutMesh cube(cube_mesh()), round(ball(12, random));
    const glm::mat4 good(world_to_clip(Camera{}) * glm::translate(glm::dmat4(1.0), {0, 0, -5}));
    const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
    DepthCuller culler;
    const std::vector<DepthObject> alone = {{&cube.clusters, good}};
    const auto before = culler.find_visible(alone, {320, 180});
    REQUIRE(before);
    const std::vector<VisibleCluster> expected(before->begin(), before->end());
    REQUIRE(expected.size() == 1);
    for (const float bad : {nan, infinity, -infinity, 1e38f, 3e30f})
        for (int column = 0; column < 4; ++column)
            for (int row = 0; row < 4; ++row) {
                glm::mat4 matrix = good;
                matrix[column][row] = bad;
                const std::vector<DepthObject> objects = {{&round.clusters, matrix}, {&cube.clusters, good}};
                const auto found = culler.find_visible(objects, {320, 180});
                REQUIRE(found);
                CHECK(found->back().object == 1);
                CHECK(found->back().triangles == expected[0].triangles);
                std::uint64_t listed = 0;
                for (const VisibleCluster& c : *found)
                    if (c.object == 0) listed += static_cast<std::uint64_t>(std::popcount(c.triangles));
                CHECK(listed == round.mesh.triangle_count());
            }
    // Nothing there, flat, all in one point, behind the eye, huge, tiny.
    for (const glm::dvec3& scale :
         {glm::dvec3(0.0), glm::dvec3(1, 0, 1), glm::dvec3(1e-30), glm::dvec3(1e9), glm::dvec3(-1, 1, 1)})
        for (const double z : {-5.0, 0.0, 5.0, -1e7}) {
            const glm::dmat4 place = glm::scale(glm::translate(glm::dmat4(1.0), {0, 0, z}), scale);
            const std::vector<DepthObject> objects = {
                {&round.clusters, glm::mat4(world_to_clip(Camera{}) * place), true}};
            CHECK(culler.find_visible(objects, {320, 180}));
        }
    const std::vector<DepthObject> none = {{&cube.clusters, good}, {}};
    CHECK(culler.find_visible(none, {320, 180}).error().item == 1);
    CHECK(culler.find_visible(alone, {0, 180}).error().code == ErrorCode::out_of_range);
    CHECK(culler.find_visible(alone, {320, 20000}).error().code == ErrorCode::out_of_range);
    for (const std::uint32_t samples : {0u, 3u, 5u, 16u})
        CHECK(culler.find_visible(alone, {.samples = samples}).error().code == ErrorCode::out_of_range);
    CHECK(culler.find_visible({}, {1, 1})->empty());
    CHECK(culler.find_visible(alone, {1, 1}));
    DepthCuller moved = std::move(culler);
    CHECK(moved.find_visible(alone, {320, 180})->size() == 1);
}

TEST_CASE(
    "where nothing hides, every cluster of the objects that may be in the picture is asked and drawn, and of others "
    "none") {
    oracle::NearMisses random(19);
    const CutMesh cube(cube_mesh()), round(ball(12, random), 16), fine(ball(20, random), 32);
    const CutMesh* const meshes[] = {&cube, &round, &fine};
    for (int trial = 0; trial < 20; ++trial) {
        std::vector<DepthObject> objects;
        std::uint64_t in_picture = 0, asked = 0, clusters = 0, triangles = 0;
        for (std::uint32_t i = 0; i < 30; ++i) {
            const CutMesh& mesh = *meshes[i % 3];
            const bool seen = (i + static_cast<std::uint32_t>(trial)) % 4 != 0;
            // In the middle of the picture; or far beside, above, behind or within no pixel.
            glm::dvec3 place(random.number(-1, 1), random.number(-1, 1), random.number(-9, -6)), scale(1.0);
            if (!seen && i % 8 < 2) place.x += 100.0;
            if (!seen && i % 8 >= 2 && i % 8 < 4) place.y -= 100.0;
            if (!seen && i % 8 >= 4 && i % 8 < 6) place.z = 30.0;
            if (!seen && i % 8 >= 6) place = {0.0, 0.0, -9.0}, scale = glm::dvec3(1e-6);  // at a corner of pixels
            objects.push_back(
                {&mesh.clusters,
                 glm::mat4(world_to_clip(Camera{}) * glm::scale(glm::translate(glm::dmat4(1.0), place), scale)), false,
                 false});
            if (!seen) continue;
            ++asked;
            in_picture += seen ? 1 : 0;
            clusters += mesh.clusters.clusters().size();
            triangles += mesh.mesh.triangle_count();
        }
        DepthCuller culler;
        const auto found = culler.find_visible(objects, {640, 360});
        REQUIRE(found);
        const depth::DepthStatistics& statistics = culler.statistics();
        CHECK(statistics.objects_asked == asked);
        CHECK(statistics.clusters_asked == clusters);
        CHECK(statistics.clusters_drawn == clusters);
        CHECK(statistics.triangles_drawn == triangles);
        std::uint64_t listed = 0;
        std::set<std::uint32_t> listed_objects;
        for (const VisibleCluster& c : *found) {
            listed += static_cast<std::uint64_t>(std::popcount(c.triangles));
            listed_objects.insert(c.object);
        }
        CHECK(statistics.triangles_listed == listed);
        CHECK(statistics.objects_listed == listed_objects.size());
        CHECK(listed_objects.size() == in_picture);
    }
}

TEST_CASE("an object behind a wall is dropped as a whole, and one that may not hide is only tested") {
    const CutMesh cube(cube_mesh());
    const auto placed_at = [](double z, const glm::dvec3& scale) {
        return glm::mat4(world_to_clip(Camera{}) * glm::scale(glm::translate(glm::dmat4(1.0), {0, 0, z}), scale));
    };
    std::vector<DepthObject> objects = {{&cube.clusters, placed_at(-10, {8, 8, 0.1})}};
    for (int i = 0; i < 50; ++i) objects.push_back({&cube.clusters, placed_at(-15.0 - i, glm::dvec3(1))});
    DepthCuller culler;
    const auto found = culler.find_visible(objects, {640, 360});
    REQUIRE(found->size() == 1);
    CHECK((*found)[0].object == 0);
    CHECK(culler.statistics().objects_listed == 1);
    CHECK(culler.statistics().objects_asked == 51);
    // The wall alone is looked into: one cluster of twelve triangles.
    CHECK(culler.statistics().clusters_asked == 1);
    CHECK(culler.statistics().clusters_drawn == 1);
    CHECK(culler.statistics().triangles_drawn == 12);
    CHECK(culler.statistics().triangles_listed == static_cast<std::uint64_t>(std::popcount((*found)[0].triangles)));
    // What is done for each of several samples is counted for each, and what is listed once.
    REQUIRE(culler.find_visible(objects, {.width = 640, .height = 360, .samples = 4})->size() == 1);
    CHECK(culler.statistics().objects_listed == 1);
    CHECK(culler.statistics().objects_asked == 4 * 51);
    CHECK(culler.statistics().clusters_asked == 4);
    CHECK(culler.statistics().clusters_drawn == 4);
    CHECK(culler.statistics().triangles_drawn == 4 * 12);
    CHECK(culler.statistics().triangles_listed <= 12);
    objects[0].hides = false;
    CHECK(culler.find_visible(objects, {640, 360})->size() > 1);
    CHECK(culler.nearness(320, 180) > 0.0f);
    CHECK(culler.nearness(0, 0) == -std::numeric_limits<float>::infinity());
}

TEST_CASE("walls seen edge-on are listed whichever side a renderer sees") {
    DepthCuller culler;
    std::uint64_t owners = 0;
    for (std::uint64_t seed = 1; seed <= 3000; ++seed) {
        CAPTURE(seed);
        oracle::NearMisses random(seed);
        Scene scene;
        scene.meshes.emplace_back(fins(1 + static_cast<std::uint32_t>(random.index(12)), random));
        const double turn = random.index(2) == 0 ? 0.0 : 1.5707963267948966;
        scene.objects.push_back({&scene.meshes[0], placed({0, 0, 0}, glm::dvec3(1), {0, 0, 1}, turn), true});
        Camera camera;
        camera.near_distance = 0.1;
        camera.aspect = 161.0 / 91.0;
        const Checked c = check(scene, camera, 161, 91, seed, culler);
        CHECK(c.lost == 0);
        CHECK(c.too_near == 0);
        owners += c.owners;
    }
    CHECK(owners > 1000);
}

TEST_CASE("fans of needles hide no more than they cover") {
    DepthCuller culler;
    for (std::uint64_t seed = 1; seed <= 300; ++seed) {
        CAPTURE(seed);
        oracle::NearMisses random(seed);
        Scene scene;
        for (int i = 0; i < 4; ++i) {
            const auto count = static_cast<std::uint32_t>(3 + random.index(300));
            scene.meshes.emplace_back(needles(count, random), static_cast<std::uint32_t>(1 + random.index(64)));
        }
        for (int i = 0; i < 12; ++i) {
            const glm::dvec3 at(random.number(-2, 2), random.number(-1, 1), random.number(-8, -1));
            const double size = std::exp(random.number(-1.5, 1.0));
            const glm::dvec3 axis = random.direction();
            const double angle = random.number(-0.7, 0.7);
            scene.objects.push_back({&scene.meshes[random.index(4)], placed(at, glm::dvec3(size), axis, angle)});
        }
        Camera camera;
        camera.near_distance = random.index(2) == 0 ? 0.1 : 1.5;
        camera.aspect = 160.0 / 90.0;
        const Checked c = check(scene, camera, 160, 90, seed, culler);
        CHECK(c.lost == 0);
        CHECK(c.too_near == 0);
    }
}

TEST_CASE("ground that reaches behind the eye hides no more than it covers") {
    DepthCuller culler;
    for (std::uint64_t seed = 1; seed <= 400; ++seed) {
        CAPTURE(seed);
        oracle::NearMisses random(seed);
        Scene scene;
        const auto squares = static_cast<std::uint32_t>(3 + random.index(30));
        TriangleMesh mesh = hills(squares, 30.0f, float(random.number(0.1, 4.0)), random);
        // Coordinates far from 0 are rounded to more of a pixel.
        const float reach = seed % 2 == 0 ? 0.0f : std::exp2(float(random.number(4.0, 13.0)));
        const glm::vec3 offset(reach, 0.0f, 0.5f * reach);
        for (glm::vec3& p : mesh.positions) p += offset;
        scene.meshes.emplace_back(std::move(mesh), static_cast<std::uint32_t>(1 + random.index(6)));
        const glm::dmat4 place = glm::translate(glm::dmat4(1.0), -glm::dvec3(offset));
        scene.objects.push_back({&scene.meshes[0], place, random.index(2) == 0});
        Camera camera;
        camera.position = {random.number(-20, 20), random.number(-1.0, 4.0), random.number(-20, 20)};
        camera.forward = glm::dvec3(random.number(-1, 1), random.number(-0.9, 0.1), random.number(-1, 1));
        camera.near_distance = random.index(2) == 0 ? 0.1 : 2.0;
        camera.aspect = 160.0 / 90.0;
        const Checked c = check(scene, camera, 160, 90, seed, culler);
        CHECK(c.lost == 0);
        CHECK(c.too_near == 0);
    }
}

TEST_CASE("ground that reaches behind the eye hides what is below it") {
    const std::vector<glm::vec3> corners = {
        {-500, -1.7f, -500}, {500, -1.7f, -500}, {500, -1.7f, 500}, {-500, -1.7f, 500}};
    const std::vector<std::uint32_t> indices = {0, 2, 1, 0, 3, 2};
    const auto ground = depth::ClusteredMesh::cut(corners, indices).value();
    const glm::dmat4 to_clip = world_to_clip(Camera{.aspect = 16.0 / 9.0, .near_distance = 0.085});
    const DepthObject object{.mesh = &ground, .to_clip = glm::mat4(to_clip), .one_sided = true};
    DepthCuller culler;
    REQUIRE(culler.find_visible({&object, 1}, {1280, 720}).has_value());
    for (const double distance : {10.0, 20.0, 40.0, 80.0}) {
        const glm::dvec4 clip = to_clip * glm::dvec4(0.0, -1.7, -distance, 1.0);
        const double depth = clip.z / clip.w;
        const auto row = static_cast<std::uint32_t>(360.0 * (1.0 + clip.y / clip.w));
        CAPTURE(distance);
        // Half a row and the margin for the slope are an eighth of 13 rows to the horizon.
        CHECK(double(culler.nearness(640, row)) > 0.85 * depth);
        CHECK(double(culler.nearness(640, row)) < 1.05 * depth);
    }
}

TEST_CASE("an eye within closed meshes that lie about one another lists little more than shows") {
    DepthCuller culler;
    std::uint64_t listed = 0, owners = 0;
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
        CAPTURE(seed);
        oracle::NearMisses random(seed);
        Scene scene;
        scene.meshes.emplace_back(ball(static_cast<std::uint32_t>(6 + random.index(12)), random));
        // In any order: what is nearest may come last.
        for (int i = 0; i < 30; ++i) {
            const double size = random.number(2.0, 30.0);
            const glm::dvec3 middle(random.number(-0.2, 0.2), random.number(-0.2, 0.2), random.number(-0.2, 0.2));
            const glm::dvec3 axis(random.number(-1, 1), 1.0, random.number(-1, 1));
            scene.objects.push_back({&scene.meshes[0], placed(size * middle, glm::dvec3(size), axis, size), false});
        }
        Camera camera;
        camera.aspect = 160.0 / 90.0;
        camera.near_distance = 0.1;
        if (seed % 4 == 0) camera.projection = Projection::orthographic, camera.height = 6.0;
        const Checked c = check(scene, camera, 160, 90, seed, culler);
        CHECK(c.lost == 0);
        CHECK(c.too_near == 0);
        listed += c.listed, owners += c.owners;
    }
    MESSAGE("listed " << listed << ", owners " << owners);
    CHECK(listed < 2 * owners);
}

// Hills whose coordinates lie far from 0 beside hills near 0, before the eye. What is drawn differs from what was cut
// by `move`.
template <class Move>
Checked check_moved_hills(std::uint64_t seed, DepthCuller& culler, float position_error, Move move) {
    oracle::NearMisses random(seed);
    Scene scene;
    for (int i = 0; i < 2; ++i) {
        const double reach = i == 0 ? 0.0 : std::exp2(random.number(4.0, 13.0));
        const glm::vec3 offset(reach * random.number(-1, 1), reach * random.number(-0.1, 0.1),
                               reach * random.number(-1, 1));
        const auto squares = static_cast<std::uint32_t>(3 + random.index(20));
        TriangleMesh mesh = hills(squares, 12.0f, float(random.number(0.5, 4.0)), random);
        for (glm::vec3& p : mesh.positions) p += offset;
        CutMesh& cut =
            scene.meshes.emplace_back(std::move(mesh), static_cast<std::uint32_t>(1 + random.index(16)), false);
        for (glm::vec3& p : cut.mesh.positions) move(p, random);
        scene.objects.push_back({&cut, glm::translate(glm::dmat4(1.0), -glm::dvec3(offset)), random.index(2) == 0});
        scene.objects.back().position_error = position_error;
    }
    Camera camera;
    camera.position = {random.number(-12, 12), random.number(0.0, 6.0), random.number(-12, 12)};
    camera.forward = glm::dvec3(random.number(-1, 1), random.number(-0.9, 0.1), random.number(-1, 1));
    camera.near_distance = 0.1;
    camera.aspect = 160.0 / 90.0;
    return check(scene, camera, 160, 90, seed, culler);
}

TEST_CASE("renderers that round products of large coordinates lose nothing") {
    DepthCuller culler;
    Checked sum;
    for (std::uint64_t seed = 1; seed <= 150; ++seed) {
        CAPTURE(seed);
        // Two units in the last place are at most 4 · 2^-24 of each product, which is what a renderer may be off by.
        const Checked c = check_moved_hills(seed, culler, 0.0f, [](glm::vec3& p, oracle::NearMisses& random) {
            for (glm::length_t k = 0; k < 3; ++k) {
                const float toward = random.index(2) == 0 ? HUGE_VALF : -HUGE_VALF;
                if (p[k] != 0.0f) p[k] = std::nextafter(std::nextafter(p[k], toward), toward);
            }
        });
        CHECK(c.lost == 0);
        CHECK(c.too_near == 0);
        sum.listed += c.listed, sum.owners += c.owners;
    }
    // And the bound is not so wide that everything is listed.
    CHECK(sum.listed < 3 * sum.owners);
}

TEST_CASE("vertices that are drawn elsewhere by no more than position_error lose nothing") {
    DepthCuller culler;
    for (std::uint64_t seed = 1; seed <= 150; ++seed) {
        CAPTURE(seed);
        const float error = 0.001f * static_cast<float>(1 + seed % 20);
        const Checked c = check_moved_hills(seed, culler, error, [&](glm::vec3& p, oracle::NearMisses& random) {
            const glm::dvec3 way(random.number(-1, 1), random.number(-1, 1), random.number(-1, 1));
            // The sum rounds, by less than a thousandth where coordinates are below 2^13.
            const double length = std::max(0.0, double{error} - 0.001);
            p = glm::vec3(glm::dvec3(p) + length / std::max(glm::length(way), 1e-3) * way);
        });
        CHECK(c.lost == 0);
        CHECK(c.too_near == 0);
    }
}

}  // namespace
}  // namespace crofton::testing
