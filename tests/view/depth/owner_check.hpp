// SPDX-License-Identifier: MIT
// A scene's picture by several renderers, each of which rounds in its own way, against what the culler lists.
#pragma once
#include <doctest/doctest.h>

#include <algorithm>

#include "depth_scenes.hpp"

namespace crofton::testing {

struct Checked {
    std::uint64_t lost = 0;    // samples whose owner is not listed
    std::uint64_t owners = 0;  // triangles that own a sample
    std::uint64_t listed = 0;
    std::uint64_t total = 0;
    std::uint64_t too_near = 0;  // samples where the culler says that the picture is nearer than it is
};

// Vulkan's standard sample locations ("Rasterization / Multisampling"), in sixteenths of a pixel, turned so that y
// points up.
inline std::vector<glm::ivec2> samples_of_pixel(std::uint32_t count) {
    switch (count) {
        case 1:
            return {{8, 8}};
        case 2:
            return {{12, 4}, {4, 12}};
        case 4:
            return {{6, 14}, {14, 10}, {2, 6}, {10, 2}};
        default:
            return {{9, 11}, {7, 5}, {13, 7}, {5, 13}, {3, 3}, {1, 9}, {11, 1}, {15, 15}};
    }
}

// What a renderer would draw is listed, in each of several ways to round, at each of the samples of a pixel.
inline Checked check(const Scene& scene, const glm::dmat4& to_clip, std::uint32_t width, std::uint32_t height,
                     std::uint64_t seed, depth::DepthCuller& culler, std::span<const oracle::Rounding> roundings,
                     std::uint32_t samples = 1) {
    std::vector<depth::DepthObject> objects;
    for (const PlacedMesh& o : scene.objects)
        objects.push_back({&o.mesh->clusters, glm::mat4(to_clip * o.world), o.one_sided, o.hides, o.position_error});
    const auto found = culler.find_visible(objects, {.width = width, .height = height, .samples = samples});
    REQUIRE(found);
    std::vector<std::vector<char>> listed;
    Checked result;
    for (const PlacedMesh& o : scene.objects) {
        listed.emplace_back(o.mesh->mesh.indices.size() / 3, 0);
        result.total += o.mesh->mesh.indices.size() / 3;
    }
    for (const depth::VisibleCluster& c : *found)
        for (std::uint32_t k = 0; k < 64; ++k)
            if (c.triangles >> k & 1)
                listed[c.object][scene.objects[c.object].mesh->clusters.clusters()[c.cluster].first_triangle + k] = 1;
    for (const auto& l : listed) result.listed += static_cast<std::uint64_t>(std::count(l.begin(), l.end(), 1));
    const std::vector<glm::ivec2> places = samples_of_pixel(samples);
    for (const oracle::Rounding& rounding : roundings) {
        std::vector<std::uint64_t> owners;
        for (std::size_t sample = 0; sample < places.size(); ++sample) {
            oracle::OwnerPicture picture(width, height), hiding(width, height);
            oracle::OwnerRenderer renderer(picture, rounding, seed, places[sample]);
            oracle::OwnerRenderer hiding_renderer(hiding, rounding, seed, places[sample]);
            for (std::uint32_t i = 0; i < objects.size(); ++i) {
                const PlacedMesh& o = scene.objects[i];
                const oracle::DrawnMesh drawn{o.mesh->mesh.positions, o.mesh->mesh.indices, objects[i].to_clip,
                                              o.one_sided};
                renderer.draw(drawn, i);
                if (o.hides) hiding_renderer.draw(drawn, i);
            }
            for (std::uint32_t y = 0; y < height; ++y)
                for (std::uint32_t x = 0; x < width; ++x) {
                    const std::size_t at = std::size_t{y} * width + x;
                    // Below 0 lies beyond the far plane.
                    if (sample == 0 && culler.nearness(x, y) > std::max(hiding.depths[at], 0.0)) ++result.too_near;
                    const std::uint64_t owner = picture.owners[at];
                    if (owner == oracle::OwnerPicture::kNobody) continue;
                    owners.push_back(owner);
                    if (listed[owner >> 32][owner & 0xffffffff] == 0) ++result.lost;
                }
        }
        std::sort(owners.begin(), owners.end());
        result.owners = static_cast<std::uint64_t>(std::unique(owners.begin(), owners.end()) - owners.begin());
    }
    return result;
}

// It moves vertices by up to `most_wobble` pixels before it snaps them.
inline Checked check(const Scene& scene, const Camera& camera, std::uint32_t width, std::uint32_t height,
                     std::uint64_t seed, depth::DepthCuller& culler, double most_wobble = 0.0006) {
    const oracle::Rounding roundings[] = {{}, {.wobble = most_wobble}, {.wobble = most_wobble, .bias = 1.0 / 256.0}};
    return check(scene, world_to_clip(camera), width, height, seed, culler, roundings);
}

}  // namespace crofton::testing
