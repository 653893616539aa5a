// SPDX-License-Identifier: MIT
// The casters of a light that change a shadow on what a camera sees, against a map and a picture by brute force.
#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <oracle/shadow_lookups.hpp>
#include <vector>

#include "depth_scenes.hpp"
#include "hostile_scenes.hpp"

namespace crofton::testing {
namespace {

using depth::DepthCuller;
using depth::DepthObject;
using depth::DepthReceiver;
using depth::PictureView;
using depth::ShadowReceivers;
using depth::VisibleCluster;

struct View {
    glm::dmat4 to_clip;
    PictureView size;
};

struct Light {
    View map;
    float radius = 1.0f;
};

// Those that are drawn, and those that cast shadows: by object of the scene.
struct Roles {
    std::vector<std::uint32_t> drawn, casters;
};

struct ShadowCheck {
    std::uint64_t lookups = 0, shadows = 0;  // texels read; those nearer to the light than the point
    std::uint64_t wrong = 0;                 // texels whose depth differs and matters
    std::uint64_t listed = 0, by_light = 0;  // triangles; those that the map alone needs
    std::uint64_t needed = 0;                // that own a texel that is in shadow when it is read

    void add(const ShadowCheck& other) {
        lookups += other.lookups, shadows += other.shadows, wrong += other.wrong;
        listed += other.listed, by_light += other.by_light, needed += other.needed;
    }
};

std::vector<DepthObject> objects_of(const Scene& scene, std::span<const std::uint32_t> which, const View& view) {
    std::vector<DepthObject> objects;
    for (const std::uint32_t i : which) {
        const PlacedMesh& o = scene.objects[i];
        objects.push_back(
            {&o.mesh->clusters, glm::mat4(view.to_clip * o.world), o.one_sided, o.hides, o.position_error});
    }
    return objects;
}

std::vector<std::vector<std::uint32_t>> triangles_of(std::span<const VisibleCluster> clusters,
                                                     std::span<const DepthObject> objects) {
    std::vector<std::vector<std::uint32_t>> triangles(objects.size());
    for (const VisibleCluster& c : clusters)
        for (std::uint64_t left = c.triangles; left != 0; left &= left - 1)
            triangles[c.object].push_back(objects[c.object].mesh->clusters()[c.cluster].first_triangle +
                                          static_cast<std::uint32_t>(std::countr_zero(left)));
    return triangles;
}

// Draws objects of the scene, with all triangles or with these of each.
oracle::OwnerPicture rendered(const Scene& scene, std::span<const std::uint32_t> which,
                              std::span<const DepthObject> objects, const PictureView& size,
                              const oracle::Rounding& rounding, std::uint64_t seed,
                              const std::vector<std::vector<std::uint32_t>>* triangles = nullptr) {
    oracle::OwnerPicture picture(size.width, size.height);
    oracle::OwnerRenderer renderer(picture, rounding, seed);
    std::vector<std::uint32_t> indices;
    for (std::uint32_t i = 0; i < which.size(); ++i) {
        const TriangleMesh& mesh = scene.objects[which[i]].mesh->mesh;
        std::span<const std::uint32_t> drawn = mesh.indices;
        if (triangles != nullptr) {
            indices.clear();
            for (const std::uint32_t t : (*triangles)[i])
                for (std::size_t k = 0; k < 3; ++k) indices.push_back(mesh.indices[3 * std::size_t{t} + k]);
            drawn = indices;
        }
        renderer.draw({mesh.positions, drawn, objects[i].to_clip, objects[i].one_sided}, i);
    }
    return picture;
}

ShadowCheck check_shadows(const Scene& scene, const Roles& roles, const View& camera, const Light& light,
                          oracle::NearMisses& random, DepthCuller& camera_culler, DepthCuller& light_culler) {
    const std::vector<DepthObject> drawn = objects_of(scene, roles.drawn, camera);
    const std::vector<DepthObject> casters = objects_of(scene, roles.casters, light.map);
    std::vector<DepthReceiver> receivers;
    for (const std::uint32_t i : roles.drawn)
        receivers.push_back({glm::mat4(light.map.to_clip * scene.objects[i].world)});
    REQUIRE(camera_culler.find_visible(drawn, camera.size));
    ShadowCheck result;
    REQUIRE(light_culler.find_visible(casters, light.map.size));
    result.by_light = light_culler.statistics().triangles_listed;
    const auto found = light_culler.find_casters(casters, light.map.size, {&camera_culler, receivers, light.radius});
    REQUIRE(found);
    result.listed = light_culler.statistics().triangles_listed;

    const oracle::Rounding rounding{.wobble = random.index(2) == 0 ? 0.0 : 0.0006};
    const std::uint64_t seed = random.index(1000);
    const auto listed = triangles_of(*found, casters);
    const auto all_map = rendered(scene, roles.casters, casters, light.map.size, rounding, seed);
    const auto listed_map = rendered(scene, roles.casters, casters, light.map.size, rounding, seed, &listed);
    const auto picture = rendered(scene, roles.drawn, drawn, camera.size, rounding, seed);
    std::vector<std::uint64_t> needed;
    for (std::uint32_t y = 0; y < camera.size.height; ++y)
        for (std::uint32_t x = 0; x < camera.size.width; ++x) {
            const std::uint64_t owner = picture.owners[std::size_t{y} * camera.size.width + x];
            if (owner == oracle::OwnerPicture::kNobody) continue;
            const auto i = static_cast<std::uint32_t>(owner >> 32);
            const TriangleMesh& mesh = scene.objects[roles.drawn[i]].mesh->mesh;
            std::array<glm::dvec3, 3> corners;
            for (std::size_t k = 0; k < 3; ++k)
                corners[k] = mesh.positions[mesh.indices[3 * (owner & 0xffffffffu) + k]];
            // By the place of the sample, or by weights of vertices that are snapped.
            const double dx = random.number(-0.0019, 0.0019), dy = random.number(-0.0019, 0.0019);
            const glm::dvec3 point = oracle::point_at(glm::dmat4(drawn[i].to_clip), corners, x + 0.5 + dx, y + 0.5 + dy,
                                                      camera.size.width, camera.size.height);
            const auto at =
                oracle::map_point(glm::dmat4(receivers[i].to_map), point, light.map.size.width, light.map.size.height);
            if (!at) continue;
            oracle::for_texels(*at, light.radius, light.map.size.width, light.map.size.height, [&](std::size_t t) {
                ++result.lookups;
                const double all = all_map.depths[t], some = listed_map.depths[t];
                result.wrong += all != some && !(all < at->depth && some < at->depth);
                if (all <= at->depth) return;
                ++result.shadows;
                needed.push_back(all_map.owners[t]);
            });
        }
    std::sort(needed.begin(), needed.end());
    result.needed = static_cast<std::uint64_t>(std::unique(needed.begin(), needed.end()) - needed.begin());
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
        for (std::uint64_t seed = 1; seed <= 300; ++seed) {
            CAPTURE(seed);
            oracle::NearMisses random(seed);
            const Scene scene = random_scene(random);
            const Roles roles = seed % 2 == 0 ? everything(scene) : random_roles(scene, random);
            const Camera camera = random_camera(random);
            const Light light = random_light(random, camera);
            const ShadowCheck c =
                check_shadows(scene, roles, view_of(camera, 120, 70), light, random, camera_culler, light_culler);
            CHECK(c.wrong == 0);
            sum.add(c);
        }
        MESSAGE(sum.lookups, " lookups, ", sum.shadows, " in shadow, ", sum.listed, " listed, ", sum.by_light,
                " by light, ", sum.needed, " needed");
        CHECK(sum.shadows > 100'000);
        CHECK(sum.listed < sum.by_light);
    }
}

}  // namespace crofton::testing
