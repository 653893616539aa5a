// SPDX-License-Identifier: MIT
#include "cluster_coloring.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/mat4x4.hpp>

#include "instance_coloring.hpp"

namespace crofton::viewer {
namespace {

constexpr std::array<const char*, kFates> kNames{"drawn", "outside the frustum", "faces away", "between samples",
                                                 "hidden by depth"};
constexpr std::array<glm::vec3, kFates> kColors{
    {palette::kInside, palette::kOutside, palette::kFacesAway, palette::kStraddling, palette::kHiddenByDepth}};
constexpr std::array<float, 3> kShades{0.7f, 1.0f, 1.3f};

using Corners = std::array<glm::dvec4, 3>;  // in clip coordinates

bool is_outside(const Corners& c) {
    const auto all = [&](auto is) { return is(c[0]) && is(c[1]) && is(c[2]); };
    return all([](const glm::dvec4& p) { return p.x < -p.w; }) || all([](const glm::dvec4& p) { return p.x > p.w; }) ||
           all([](const glm::dvec4& p) { return p.y < -p.w; }) || all([](const glm::dvec4& p) { return p.y > p.w; }) ||
           all([](const glm::dvec4& p) { return p.z > p.w; }) || all([](const glm::dvec4& p) { return p.z < 0.0; });
}

bool faces_away(const Corners& c) {
    const auto minor = [](const glm::dvec4& a, const glm::dvec4& b) { return a.x * b.y - a.y * b.x; };
    return c[0].w * minor(c[1], c[2]) + c[1].w * minor(c[2], c[0]) + c[2].w * minor(c[0], c[1]) <= 0.0;
}

// Row by row: whether a sample lies between where the row enters the triangle and where it leaves.
bool covers_sample(const Corners& c, const depth::PictureView& picture) {
    std::array<glm::dvec2, 3> p;
    for (std::size_t k = 0; k < 3; ++k) {
        if (!(c[k].w > 0.0)) return true;
        p[k] = {(c[k].x / c[k].w * 0.5 + 0.5) * picture.width, (c[k].y / c[k].w * 0.5 + 0.5) * picture.height};
    }
    const double low = std::min({p[0].y, p[1].y, p[2].y}), high = std::max({p[0].y, p[1].y, p[2].y});
    const double first = std::ceil(std::max(low - 0.5, 0.0)),
                 last = std::floor(std::min(high, picture.height * 1.0) - 0.5);
    for (double row = first; row <= last; row += 1.0) {
        double enters = picture.width, leaves = 0.0;
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::dvec2 &a = p[k], &b = p[(k + 1) % 3];
            const double y = row + 0.5;
            if ((a.y > y) == (b.y > y)) continue;
            const double x = a.x + (b.x - a.x) * ((y - a.y) / (b.y - a.y));
            enters = std::min(enters, x), leaves = std::max(leaves, x);
        }
        if (std::ceil(std::max(enters, 0.0) - 0.5) <= std::floor(std::min(leaves, picture.width * 1.0) - 0.5))
            return true;
    }
    return false;
}

Fate fate_of(const Corners& corners, bool listed, bool one_sided, const depth::PictureView& picture) {
    if (listed) return Fate::drawn;
    if (is_outside(corners)) return Fate::outside;
    if (one_sided && faces_away(corners)) return Fate::faces_away;
    return covers_sample(corners, picture) ? Fate::hidden : Fate::between_samples;
}

}  // namespace

Result<void> ClusterColoring::classify(const assets::SceneSource& source, const pipeline::SceneClusters& clusters,
                                       std::span<const scene::InstanceId> in_view, const Camera& camera,
                                       const depth::PictureView& picture) {
    const scene::Scene& scene = source.scene;
    for (std::size_t f = 0; f < kFates; ++f) counts_[f] = {kNames[f], kColors[f], 0, 0};
    colors_.clear();
    for (const glm::vec3& color : kColors)
        for (const float shade : kShades) colors_.push_back(color * shade);
    pieces_.clear();
    shades_.clear();
    objects_.clear();
    pipeline::append_depth_objects(scene, clusters, source.one_sided, in_view, camera, objects_);
    const auto found = culler_.find_visible(objects_, picture);
    if (!found) return found.error();
    std::size_t next_in_view = 0, next_found = 0;
    for (scene::InstanceId i = 0; i < scene.instance_count(); ++i) {
        if (scene.is_removed(i) || scene.layer_masks()[i] == 0) continue;
        const scene::MeshId mesh = scene.mesh_of(i);
        while (next_in_view < in_view.size() && in_view[next_in_view] < i) ++next_in_view;
        if (next_in_view == in_view.size() || in_view[next_in_view] != i) {
            add_outside(i, *clusters.meshes[mesh]);
            continue;
        }
        listed_.assign(clusters.meshes[mesh]->clusters().size(), 0);
        while (next_found < found->size() && (*found)[next_found].object < next_in_view) ++next_found;
        for (; next_found < found->size() && (*found)[next_found].object == next_in_view; ++next_found)
            listed_[(*found)[next_found].cluster] = (*found)[next_found].triangles;
        add_in_view(i, scene.mesh(mesh), objects_[next_in_view], picture);
    }
    return {};
}

void ClusterColoring::add_outside(scene::InstanceId instance, const depth::ClusteredMesh& mesh) {
    for (std::uint32_t c = 0; c < mesh.clusters().size(); ++c) {
        std::array<std::uint64_t, kFates> triangles{};
        triangles[static_cast<std::size_t>(Fate::outside)] =
            ~std::uint64_t{0} >> (64 - mesh.clusters()[c].triangle_count);
        add_cluster(instance, c, triangles);
    }
}

void ClusterColoring::add_in_view(scene::InstanceId instance, const TriangleMesh& mesh,
                                  const depth::DepthObject& object, const depth::PictureView& picture) {
    const glm::dmat4 to_clip(object.to_clip);
    const auto clusters = object.mesh->clusters();
    const auto order = object.mesh->triangle_order();
    for (std::uint32_t c = 0; c < clusters.size(); ++c) {
        std::array<std::uint64_t, kFates> triangles{};
        for (std::uint32_t k = 0; k < clusters[c].triangle_count; ++k) {
            const std::uint32_t* const v = mesh.indices.data() + std::size_t{3} * order[clusters[c].first_triangle + k];
            Corners corners;
            for (std::size_t i = 0; i < 3; ++i)
                corners[i] = to_clip * glm::dvec4(glm::dvec3(mesh.positions[v[i]]), 1.0);
            const Fate fate = fate_of(corners, (listed_[c] >> k & 1) != 0, object.one_sided, picture);
            triangles[static_cast<std::size_t>(fate)] |= std::uint64_t{1} << k;
        }
        add_cluster(instance, c, triangles);
    }
}

void ClusterColoring::add_cluster(scene::InstanceId instance, std::uint32_t cluster,
                                  const std::array<std::uint64_t, kFates>& triangles) {
    const std::uint32_t shade = (cluster + instance) % kShades.size();
    for (std::size_t f = 0; f < kFates; ++f) {
        if (triangles[f] == 0) continue;
        pieces_.push_back({instance, cluster, triangles[f]});
        shades_.push_back(static_cast<std::uint8_t>(f * kShades.size() + shade));
        counts_[f].triangles += static_cast<std::uint64_t>(std::popcount(triangles[f]));
    }
    constexpr std::array kLeast{Fate::drawn, Fate::hidden, Fate::between_samples, Fate::faces_away, Fate::outside};
    for (const Fate fate : kLeast)
        if (const auto f = static_cast<std::size_t>(fate); triangles[f] != 0) {
            ++counts_[f].clusters;
            return;
        }
}

}  // namespace crofton::viewer
