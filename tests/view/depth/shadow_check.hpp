// SPDX-License-Identifier: MIT
// A light's map of all casters beside that of the listed ones, as a camera's picture looks it up.
#pragma once
#include <algorithm>
#include <bit>
#include <oracle/shadow_lookups.hpp>
#include <vector>

#include "depth_scenes.hpp"

namespace crofton::testing {

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

// What is drawn, and with which matrices.
struct DrawnPicture {
    depth::PictureView size;
    std::span<const depth::DepthObject> objects;
};

inline std::vector<std::vector<std::uint32_t>> triangles_of(std::span<const depth::VisibleCluster> clusters,
                                                            std::span<const depth::DepthObject> objects) {
    std::vector<std::vector<std::uint32_t>> triangles(objects.size());
    for (const depth::VisibleCluster& c : clusters)
        for (std::uint64_t left = c.triangles; left != 0; left &= left - 1)
            triangles[c.object].push_back(objects[c.object].mesh->clusters()[c.cluster].first_triangle +
                                          static_cast<std::uint32_t>(std::countr_zero(left)));
    return triangles;
}

// Draws objects of the scene, with all triangles or with these of each.
inline oracle::OwnerPicture rendered(const Scene& scene, std::span<const std::uint32_t> which,
                                     std::span<const depth::DepthObject> objects, const depth::PictureView& size,
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

// Counts lookups, those in shadow, and those that are wrong with the casters that were `found`.
inline void compare_shadows(const Scene& scene, const Roles& roles, const DrawnPicture& camera, const DrawnPicture& map,
                            const depth::DepthReceivers& receivers, std::span<const depth::VisibleCluster> found,
                            oracle::NearMisses& random, ShadowCheck& result) {
    const oracle::Rounding rounding{.wobble = random.index(2) == 0 ? 0.0 : 0.0006};
    const std::uint64_t seed = random.index(1000);
    const auto listed = triangles_of(found, map.objects);
    const auto all_map = rendered(scene, roles.casters, map.objects, map.size, rounding, seed);
    const auto listed_map = rendered(scene, roles.casters, map.objects, map.size, rounding, seed, &listed);
    const auto picture = rendered(scene, roles.drawn, camera.objects, camera.size, rounding, seed);
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
            const glm::dvec3 point = oracle::point_at(glm::dmat4(camera.objects[i].to_clip), corners, x + 0.5 + dx,
                                                      y + 0.5 + dy, camera.size.width, camera.size.height);
            const auto at =
                oracle::map_point(glm::dmat4(receivers.objects[i].to_map), point, map.size.width, map.size.height);
            if (!at) continue;
            oracle::for_texels(*at, double{receivers.radius}, map.size.width, map.size.height, [&](std::size_t t) {
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
}

}  // namespace crofton::testing
