// SPDX-License-Identifier: MIT
#include "draw_list.hpp"

#include <algorithm>
#include <bit>
#include <crofton/geometry/box.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace crofton::pipeline {
namespace {

// Beyond this the static buffer would be larger than what a game keeps resident: 8 million vertices are 288 MB.
constexpr std::size_t kMaxBakedVertices = 8'000'000;

constexpr glm::vec3 kPlainColor{0.62f, 0.60f, 0.57f};

struct MeshVertices {
    Vector<render::Vertex> vertices;
    Vector<std::uint32_t> indices;
};

std::uint8_t flag(std::span<const std::uint8_t> flags, scene::MeshId mesh) {
    return mesh < flags.size() ? flags[mesh] : std::uint8_t{0};
}

std::vector<MeshVertices> vertices_of_meshes(const scene::Scene& scene, std::span<const std::uint8_t> flat) {
    // No angle is below it, so that no faces share a normal.
    constexpr float kFlat = 0.0f;
    std::vector<MeshVertices> result(scene.mesh_count());
    for (scene::MeshId mesh = 0; mesh < scene.mesh_count(); ++mesh) {
        auto& [vertices, indices] = result[mesh];
        if (flag(flat, mesh) != 0)
            render::append_mesh(scene.mesh(mesh), kPlainColor, vertices, indices, kFlat);
        else
            render::append_mesh(scene.mesh(mesh), kPlainColor, vertices, indices);
    }
    return result;
}

glm::dvec3 middle_of(const scene::Scene& scene) {
    Aabb bounds;
    for (scene::InstanceId i = 0; i < scene.instance_count(); ++i)
        if (!scene.is_removed(i)) bounds.include(aabb_of(scene.world_boxes()[i]));
    return bounds.is_empty() ? glm::dvec3(0.0) : bounds.center();
}

// Inverse transpose up to scale, with the sign that keeps normals outward in mirrored placements.
glm::dmat3 normal_matrix(const glm::dmat3& linear) {
    const glm::dmat3 cofactor(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]),
                              glm::cross(linear[0], linear[1]));
    return glm::determinant(linear) < 0.0 ? -cofactor : cofactor;
}

}  // namespace

DrawList::DrawList(const scene::Scene& scene, std::span<const scene::InstanceId> order,
                   std::span<const std::uint8_t> is_mover, const Looks& looks)
    : scene_(scene), baked_origin_(middle_of(scene)), instances_(order.begin(), order.end()) {
    const std::vector<MeshVertices> meshes = vertices_of_meshes(scene, looks.flat);
    std::size_t baked_vertices = 0;
    for (const scene::InstanceId i : order)
        if (!is_mover[i]) baked_vertices += meshes[scene.mesh_of(i)].vertices.size();
    const bool bake = baked_vertices <= kMaxBakedVertices;

    ranks_.assign(scene.instance_count(), scene::kNone);
    std::vector<Part> shared(meshes.size());
    Vector<render::Vertex> placed;
    for (std::uint32_t rank = 0; rank < instances_.size(); ++rank) {
        const scene::InstanceId instance = instances_[rank];
        const scene::MeshId mesh = scene.mesh_of(instance);
        ranks_[instance] = rank;
        const bool baked = bake && !is_mover[instance];
        baked_.push_back(baked);
        unlit_.push_back(flag(looks.unlit, mesh));
        one_sided_.push_back(flag(looks.one_sided, mesh));
        if (!baked) {
            if (shared[mesh].index_count == 0) shared[mesh] = append(meshes[mesh].vertices, meshes[mesh].indices);
            parts_.push_back(shared[mesh]);
            continue;
        }
        const Transform& world = scene.world(scene.node_of(instance));
        const glm::dmat3 normals = normal_matrix(world.linear);
        const glm::dvec3 offset = world.translation - baked_origin_;
        placed.assign(meshes[mesh].vertices.begin(), meshes[mesh].vertices.end());
        for (render::Vertex& vertex : placed) {
            vertex.position = glm::vec3(world.linear * glm::dvec3(vertex.position) + offset);
            const glm::dvec3 normal = normals * glm::dvec3(vertex.normal);
            const double length = glm::length(normal);
            if (length > 0.0) vertex.normal = glm::vec3(normal / length);
        }
        parts_.push_back(append(placed, meshes[mesh].indices));
    }
}

DrawList::Part DrawList::append(std::span<const render::Vertex> vertices,
                                std::span<const std::uint32_t> local_indices) {
    Part part{static_cast<std::uint32_t>(vertices_.size()), static_cast<std::uint32_t>(vertices.size()),
              static_cast<std::uint32_t>(indices_.size()), static_cast<std::uint32_t>(local_indices.size()), Aabb{}};
    for (const render::Vertex& vertex : vertices) part.bounds.include(vertex.position);
    vertices_.insert(vertices_.end(), vertices.begin(), vertices.end());
    for (const render::Vertex& vertex : vertices) positions_.push_back(vertex.position);
    for (const std::uint32_t index : local_indices) indices_.push_back(part.first_vertex + index);
    local_indices_.insert(local_indices_.end(), local_indices.begin(), local_indices.end());
    return part;
}

void DrawList::select(std::span<const scene::InstanceId> visible, const Camera& camera) {
    sort_front_to_back(visible, camera.position);
    const render::ModelToClip to_clip(camera);
    ranges_.clear();
    transforms_.clear();
    transforms_.push_back(render::draw_transform(to_clip(glm::dmat3(1.0), baked_origin_), glm::dmat3(1.0)));
    transforms_.push_back(transforms_[0]);
    transforms_[1].unlit = 1.0f;
    for (const std::uint32_t rank : selected_) {
        std::uint32_t transform = unlit_[rank];
        const Transform& world = scene_.world(scene_.node_of(instances_[rank]));
        if (!baked_[rank]) {
            transform = static_cast<std::uint32_t>(transforms_.size());
            transforms_.push_back(render::draw_transform(to_clip(world.linear, world.translation), world.linear));
            transforms_.back().unlit = unlit_[rank];
        }
        const Part& part = parts_[rank];
        // Mirrored, fronts and backs change places: such instances show both.
        const bool one_sided = one_sided_[rank] != 0 && glm::determinant(world.linear) > 0.0;
        ranges_.push_back({part.first_index, part.index_count, transform, one_sided,
                           render::inside_clip_planes(part.bounds, transforms_[transform].to_clip)});
    }
}

// By the farthest point of a ball around the part, so that the ground comes last. Bits of positive floats sort as they
// do.
void DrawList::sort_front_to_back(std::span<const scene::InstanceId> visible, const glm::dvec3& eye) {
    order_.clear();
    for (const scene::InstanceId instance : visible) {
        const std::uint32_t rank = ranks_[instance];
        const Aabb& bounds = parts_[rank].bounds;
        const Transform& world = scene_.world(scene_.node_of(instance));
        const glm::dvec3 middle = bounds.center(), half = bounds.half_extents();
        const glm::dvec3 center = baked_[rank] ? middle + baked_origin_ : world.linear * middle + world.translation;
        const double radius = baked_[rank] ? glm::length(half) : glm::length(world.linear * half);
        const auto distance = static_cast<float>(glm::length(center - eye) + radius);
        order_.push_back(std::uint64_t{std::bit_cast<std::uint32_t>(distance)} << 32 | rank);
    }
    std::sort(order_.begin(), order_.end());
    selected_.clear();
    for (const std::uint64_t entry : order_) selected_.push_back(static_cast<std::uint32_t>(entry));
}

std::uint64_t DrawList::predict_clipped() {
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < selected_.size(); ++i) {
        const Part& part = parts_[selected_[i]];
        if (ranges_[i].unclipped) {
            sum += part.index_count / 3;
            continue;
        }
        sum +=
            predictor_.count(std::span<const glm::vec3>(positions_).subspan(part.first_vertex, part.vertex_count),
                             std::span<const std::uint32_t>(local_indices_).subspan(part.first_index, part.index_count),
                             transforms_[ranges_[i].transform].to_clip, part.bounds);
    }
    return sum;
}

}  // namespace crofton::pipeline
