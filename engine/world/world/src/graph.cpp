// SPDX-License-Identifier: MIT
// World's nodes and meshes.
#include <algorithm>
#include <crofton/geometry/mesh_counts.hpp>
#include <cstring>
#include <string>

#include "for_each_pair.hpp"
#include "require_ok.hpp"
#include "world_state.hpp"

namespace crofton {
namespace {

Result<TriangleMesh> to_mesh(const MeshDescription& description) {
    const bool indexed = description.indices.size() > 0;
    const std::size_t vertices = description.positions.size(),
                      indices = indexed ? description.indices.size() : vertices;
    if (auto checked = detail::check_mesh_counts(vertices, indices); !checked) return checked.error();
    TriangleMesh mesh;
    mesh.positions.resize(vertices);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) mesh.positions[i] = description.positions[i];
    mesh.indices.resize(indices);
    for (std::size_t i = 0; i < mesh.indices.size(); ++i)
        mesh.indices[i] = indexed ? description.indices[i] : static_cast<std::uint32_t>(i);
    return mesh;
}

}  // namespace

glm::vec3 PointsView::operator[](std::size_t i) const {
    const std::byte* at = first_ + i * stride_;
    if (!is_double_) {
        float point[3];
        std::memcpy(point, at, sizeof point);
        return {point[0], point[1], point[2]};
    }
    double point[3];
    std::memcpy(point, at, sizeof point);
    return {static_cast<float>(point[0]), static_cast<float>(point[1]), static_cast<float>(point[2])};
}

Result<void> World::State::check(NodeHandle node, std::uint64_t item) const {
    return nodes.check("node", node, item);
}

Result<void> World::State::check(MeshHandle mesh, std::uint64_t item) const {
    return meshes.check("mesh", mesh, item);
}

Result<MeshHandle> World::add_mesh(const MeshDescription& description) {
    if (auto outside = state_->check_outside(); !outside) return outside.error();
    State& s = *state_;
    auto copy = to_mesh(description);
    if (!copy) return copy.error();
    const auto mesh = s.scene.add_mesh(std::move(*copy), {}, description.box);
    if (!mesh) return mesh.error();
    if (description.occluders)
        if (auto found = s.set_found_occluders(*mesh, {}); !found) {
            (void)s.scene.remove_mesh(*mesh);
            return found.error();
        }
    auto clusters = world::MeshClusters::cut(s.scene.mesh(*mesh), description);
    if (!clusters) {
        s.occluders.clear(*mesh);
        (void)s.scene.remove_mesh(*mesh);
        return clusters.error();
    }
    s.mesh_clusters.set(*mesh, std::move(*clusters), s.scene);
    s.shapes.set_mesh(*mesh, description.triangles);
    s.shapes.note(*mesh);
    s.meshes.add(*mesh);
    return MeshHandle{*mesh, s.meshes.generations[*mesh]};
}

Result<void> World::replace_mesh(MeshHandle mesh, const MeshDescription& description) {
    if (auto outside = state_->check_outside(); !outside) return outside.error();
    if (auto known = state_->check(mesh, mesh.index); !known) return known;
    auto copy = to_mesh(description);
    if (!copy) return copy.error();
    TriangleMesh& replacement = *copy;
    occlude::FoundOccluders found;
    if (description.occluders) {
        auto looked_for = occlude::find_occluders(replacement);
        if (!looked_for) return looked_for.error();
        found = std::move(*looked_for);
    }
    auto clusters = world::MeshClusters::cut(replacement, description);
    if (!clusters) return clusters.error();
    state_->shapes.note(mesh.index);
    auto replaced = state_->scene.replace_mesh(mesh.index, std::move(replacement), description.box);
    if (!replaced) return replaced;
    state_->note_removal();
    state_->mesh_clusters.set(mesh.index, std::move(*clusters), state_->scene);
    state_->shapes.set_mesh(mesh.index, description.triangles);
    return state_->occluders.set(mesh.index, found.occluders);
}

Result<void> World::set_vertices(MeshHandle mesh, PointsView positions) {
    if (auto outside = state_->check_outside(); !outside) return outside.error();
    State& s = *state_;
    if (auto known = s.check(mesh, mesh.index); !known) return known;
    // Before they are read: a wrong number leads beyond the caller's array.
    if (const std::size_t has = s.scene.mesh(mesh.index).positions.size(); positions.size() != has)
        return fail(ErrorCode::invalid_argument, positions.size(),
                    {"mesh ", mesh.index, " has ", has, " vertices, not ", positions.size(),
                     "; replace_mesh takes any number"});
    s.vertices.resize(positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i) s.vertices[i] = positions[i];
    s.mesh_clusters.keep_copy(mesh.index);
    s.shapes.note(mesh.index);
    auto set = s.scene.set_vertices(mesh.index, s.vertices);
    if (!set) return set;
    s.shapes.note_deformed(mesh.index);
    s.occluders.clear(mesh.index);
    return set;
}

Result<void> World::remove(MeshHandle mesh) {
    if (auto outside = state_->check_outside(); !outside) return outside.error();
    if (auto known = state_->check(mesh, mesh.index); !known) return known;
    state_->shapes.note(mesh.index);
    auto removed = state_->scene.remove_mesh(mesh.index);
    if (!removed) return removed;
    state_->note_removal();
    state_->meshes.remove(mesh.index);
    state_->occluders.clear(mesh.index);
    state_->mesh_clusters.clear(mesh.index);
    return removed;
}

Result<NodeHandle> World::add_node(const NodeDescription& description) {
    if (auto outside = state_->check_outside(); !outside) return outside.error();
    State& s = *state_;
    scene::NodeId parent = scene::kNone;
    if (!description.parent.is_null()) {
        if (auto known = s.check(description.parent, kNoItem); !known) return known.error();
        parent = description.parent.index;
    }
    const auto node = s.scene.add_node(parent, description.transform, description.layers);
    if (!node) return node.error();
    s.nodes.add(*node);
    return NodeHandle{*node, s.nodes.generations[*node]};
}

Result<void> World::remove(NodeHandle node) {
    if (auto outside = state_->check_outside(); !outside) return outside.error();
    State& s = *state_;
    if (auto known = s.check(node, node.index); !known) return known;
    s.scene.visit_subtree(
        node.index, [&](scene::NodeId below) { s.nodes.remove(below); },
        [&](scene::InstanceId instance) { s.mark_removed(s.object_of_instance[instance]); });
    return s.scene.remove_node(node.index);
}

Result<void> World::State::set_transform(NodeHandle node, const Transform& transform, std::uint64_t item) {
    if (!nodes.contains(node)) return check(node, item);
    return set_local(node.index, transform, item);
}

// The scene checks the transform; an error names the caller's item.
Result<void> World::State::set_local(scene::NodeId node, const Transform& transform, std::uint64_t item) {
    const Transform before = mesh_shapes > 0 ? scene.local(node) : Transform();
    auto set = scene.set_local(node, transform);
    if (!set) {
        set.error().item = item;
        return set;
    }
    // What scales alike before and after leaves all shapes below as they are.
    if (mesh_shapes == 0 || (world::is_similarity(before.linear) && world::is_similarity(transform.linear))) return set;
    auto scales = check_shapes_below(node, item);
    if (!scales) world::require_ok(scene.set_local(node, before));
    return scales;
}

Transform World::State::world_to_be(scene::NodeId node) const {
    Transform world = scene.local(node);
    for (scene::NodeId above = scene.parent_of(node); above != scene::kNone; above = scene.parent_of(above))
        world = scene.local(above) * world;
    return world;
}

Result<void> World::State::check_shapes_below(scene::NodeId node, std::uint64_t item) const {
    Result<void> first;
    scene.visit_subtree(
        node, [](scene::NodeId) {},
        [&](scene::InstanceId instance) {
            const std::uint32_t object = object_of_instance[instance];
            if (!first || !object_shapes.has(object)) return;
            const glm::dmat3 linear = world_to_be(scene.node_of(instance)).linear;
            first = world::ObjectShapes::check(object_shapes.own_shape(object), linear, item);
        });
    return first;
}

Result<void> World::set_transform(NodeHandle node, const Transform& transform) {
    if (auto outside = state_->check_outside(); !outside) return outside.error();
    return state_->set_transform(node, transform, node.index);
}

Result<void> World::set_transforms(Strided<NodeHandle> nodes, Strided<Transform> transforms) {
    if (auto outside = state_->check_outside(); !outside) return outside.error();
    if (nodes.size() != transforms.size()) return fail_sizes();
    State& s = *state_;
    constexpr std::size_t kAtOnce = 64;
    const bool side_by_side = transforms.stride() == sizeof(Transform);
    Result<void> first;
    for (std::size_t begin = 0; begin < nodes.size(); begin += kAtOnce) {
        const std::size_t end = std::min(begin + kAtOnce, nodes.size());
        scene::NodeId ids[kAtOnce];
        std::size_t count = 0;
        while (begin + count < end && s.nodes.contains(nodes[begin + count])) {
            ids[count] = nodes[begin + count].index;
            ++count;
        }
        // All of them, or, where one is bad, none: then one by one. So are those that shapes may hang on.
        if (side_by_side && s.mesh_shapes == 0 && begin + count == end &&
            s.scene.set_local({ids, count}, {&transforms[begin], count}))
            continue;
        for (std::size_t i = begin; i < end; ++i) {
            auto set = s.set_transform(nodes[i], transforms[i], i);
            if (!set && first) first = std::move(set);
        }
    }
    return first;
}

Result<void> World::set_parent(NodeHandle node, NodeHandle parent) {
    if (auto outside = state_->check_outside(); !outside) return outside.error();
    if (auto known = state_->check(node, node.index); !known) return known;
    if (!parent.is_null())
        if (auto known = state_->check(parent, parent.index); !known) return known;
    State& s = *state_;
    const scene::NodeId before = s.scene.parent_of(node.index);
    auto set = s.scene.set_parent(node.index, parent.index);
    if (!set || s.mesh_shapes == 0) return set;
    auto scales = s.check_shapes_below(node.index, node.index);
    if (!scales) world::require_ok(s.scene.set_parent(node.index, before));
    return scales;
}

Result<void> World::set_layers(NodeHandle node, std::uint32_t layers) {
    if (auto outside = state_->check_outside(); !outside) return outside.error();
    if (auto known = state_->check(node, node.index); !known) return known;
    return state_->scene.set_layer_mask(node.index, layers);
}

}  // namespace crofton
