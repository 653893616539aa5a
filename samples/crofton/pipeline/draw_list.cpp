// SPDX-License-Identifier: MIT
#include "draw_list.hpp"

#include <algorithm>
#include <bit>
#include <crofton/geometry/box.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <utility>

namespace crofton::pipeline {
namespace {

constexpr glm::vec3 kPlainColor{0.62f, 0.60f, 0.57f};

std::uint8_t flag(std::span<const std::uint8_t> flags, scene::MeshId mesh) {
    return mesh < flags.size() ? flags[mesh] : std::uint8_t{0};
}

Aabb bounds_of(const depth::ClusterBox& box) {
    const glm::dvec3 center(box.center);
    const glm::dvec3 half = glm::abs(glm::dvec3(box.half_edges[0])) + glm::abs(glm::dvec3(box.half_edges[1])) +
                            glm::abs(glm::dvec3(box.half_edges[2]));
    return {center - half, center + half};
}

}  // namespace

DrawList::DrawList(std::shared_ptr<const Drawables> drawables, const Looks& looks,
                   std::shared_ptr<const SceneClusters> clusters)
    : drawables_(std::move(drawables)), clusters_(std::move(clusters)) {
    for (scene::MeshId mesh = 0; mesh < drawables_->mesh_count(); ++mesh) {
        unlit_.push_back(flag(looks.unlit, mesh));
        one_sided_.push_back(flag(looks.one_sided, mesh));
        append(mesh, flag(looks.flat, mesh) != 0);
    }
}

void DrawList::append(scene::MeshId mesh, bool flat) {
    // No angle is below it, so that no faces share a normal.
    constexpr float kFlat = 0.0f;
    Vector<render::Vertex> vertices;
    Vector<std::uint32_t> indices;
    if (flat)
        render::append_mesh(drawables_->mesh(mesh), kPlainColor, vertices, indices, kFlat);
    else
        render::append_mesh(drawables_->mesh(mesh), kPlainColor, vertices, indices);
    if (clusters_ && !indices.empty()) {
        const Vector<std::uint32_t> in_order = indices;
        clusters_->meshes[mesh]->permute(in_order, indices);
    }
    Part part{static_cast<std::uint32_t>(vertices_.size()), static_cast<std::uint32_t>(vertices.size()),
              static_cast<std::uint32_t>(indices_.size()), static_cast<std::uint32_t>(indices.size()), Aabb{}};
    for (const render::Vertex& vertex : vertices) part.bounds.include(vertex.position);
    vertices_.insert(vertices_.end(), vertices.begin(), vertices.end());
    for (const render::Vertex& vertex : vertices) positions_.push_back(vertex.position);
    for (const std::uint32_t index : indices) indices_.push_back(part.first_vertex + index);
    local_indices_.insert(local_indices_.end(), indices.begin(), indices.end());
    parts_.push_back(part);
}

void DrawList::select(std::span<const scene::InstanceId> visible, const Camera& camera) {
    unsorted_.clear();
    for (const scene::InstanceId instance : visible)
        unsorted_.push_back({instance, is_one_sided(*drawables_, one_sided_, instance)});
    place(camera);
    for (std::size_t i = 0; i < selected_.size(); ++i) {
        const Part& part = parts_[drawables_->mesh_of(selected_[i].instance)];
        add_range(i, part.first_index, part.index_count, is_unclipped(i, part.bounds));
    }
}

void DrawList::select(std::span<const depth::VisibleCluster> visible, const Camera& camera) {
    unsorted_.clear();
    for (std::size_t begin = 0, end = 0; begin < visible.size(); begin = end) {
        while (end < visible.size() && visible[end].object == visible[begin].object) ++end;
        unsorted_.push_back(
            {visible[begin].object, is_one_sided(*drawables_, one_sided_, visible[begin].object), begin, end});
    }
    place(camera);
    piece_of_range_.clear();
    for (std::size_t i = 0; i < selected_.size(); ++i) {
        const scene::MeshId mesh = drawables_->mesh_of(selected_[i].instance);
        for (std::size_t k = selected_[i].begin; k < selected_[i].end; ++k) {
            const depth::Cluster& cluster = clusters_->meshes[mesh]->clusters()[visible[k].cluster];
            const bool unclipped = is_unclipped(i, bounds_of(clusters_->meshes[mesh]->box_of(visible[k].cluster)));
            // Runs of triangles.
            std::uint64_t left = visible[k].triangles;
            for (std::uint32_t at = 0; left != 0;) {
                const auto skipped = static_cast<std::uint32_t>(std::countr_zero(left));
                const auto count = static_cast<std::uint32_t>(std::countr_one(left >> skipped));
                add_range(i, parts_[mesh].first_index + 3 * (cluster.first_triangle + at + skipped), 3 * count,
                          unclipped);
                piece_of_range_.push_back(k);
                at += skipped + count;
                left = skipped + count < 64 ? left >> (skipped + count) : 0;
            }
        }
    }
}

void DrawList::select(const OccludedFrame& frame, const Camera& camera) {
    if (frame.by_depth)
        select(frame.clusters, camera);
    else
        select(frame.visible_ids, camera);
}

// By the farthest point of a ball around the part, so that the ground comes last. Bits of positive floats sort as they
// do.
void DrawList::place(const Camera& camera) {
    order_.clear();
    for (std::uint32_t i = 0; i < unsorted_.size(); ++i) {
        const scene::InstanceId instance = unsorted_[i].instance;
        const Aabb& bounds = parts_[drawables_->mesh_of(instance)].bounds;
        const Transform world = drawables_->world_of(instance);
        const glm::dvec3 center = world.linear * bounds.center() + world.translation;
        const double radius = glm::length(world.linear * bounds.half_extents());
        const auto distance = static_cast<float>(glm::length(center - camera.position) + radius);
        order_.emplace_back(std::uint64_t{std::bit_cast<std::uint32_t>(distance)} << 32 | instance, i);
    }
    std::sort(order_.begin(), order_.end());
    selected_.clear();
    ranges_.clear();
    transforms_.clear();
    const render::ModelToClip to_clip(camera);
    for (const auto& [key, i] : order_) {
        selected_.push_back(unsorted_[i]);
        const Transform world = drawables_->world_of(unsorted_[i].instance);
        transforms_.push_back(render::draw_transform(to_clip(world.linear, world.translation), world.linear));
        transforms_.back().unlit = unlit_[drawables_->mesh_of(unsorted_[i].instance)];
    }
}

bool DrawList::is_unclipped(std::size_t selected, const Aabb& bounds) const {
    return render::inside_clip_planes(bounds, transforms_[selected].to_clip);
}

void DrawList::add_range(std::size_t selected, std::uint32_t first_index, std::uint32_t index_count, bool unclipped) {
    ranges_.push_back(
        {first_index, index_count, static_cast<std::uint32_t>(selected), selected_[selected].one_sided, unclipped});
}

std::uint64_t DrawList::predict_clipped() {
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < ranges_.size(); ++i) {
        const render::DrawRange& range = ranges_[i];
        if (range.unclipped) {
            sum += range.index_count / 3;
            continue;
        }
        const Part& part = parts_[drawables_->mesh_of(instance_of(i))];
        sum += predictor_.count(
            std::span<const glm::vec3>(positions_).subspan(part.first_vertex, part.vertex_count),
            std::span<const std::uint32_t>(local_indices_).subspan(range.first_index, range.index_count),
            transforms_[range.transform].to_clip, part.bounds);
    }
    return sum;
}

}  // namespace crofton::pipeline
