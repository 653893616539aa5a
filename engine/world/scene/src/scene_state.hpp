// SPDX-License-Identifier: MIT
// The state of a Scene.
#pragma once
#include <crofton/scene/scene.hpp>
#include <optional>
#include <string>

#include "bit_set.hpp"
#include "box_kernel.hpp"
#include "topological_order.hpp"

namespace crofton::scene {

using String = std::basic_string<char, std::char_traits<char>, Allocator<char>>;

inline constexpr std::uint32_t kRemoved = kNone;

// Links and masks of a node. Its transforms lie in arrays of their own.
struct Node {
    NodeId parent = kNone;
    NodeId first_child = kNone;
    NodeId next_sibling = kNone;
    NodeId previous_sibling = kNone;  // of the first child: the last one
    InstanceId first_instance = kNone;
    std::uint32_t own_mask = ~0u;
    std::uint32_t mask = 0;             // with the ancestors', as of the last update
    std::uint32_t position = kRemoved;  // in the topological order
};
static_assert(sizeof(Node) == 32);

// Instances form two lists: those of one node and those of one mesh.
struct Instance {
    NodeId node = kRemoved;
    MeshId mesh = kNone;
    InstanceId next_on_node = kNone, previous_on_node = kNone;
    InstanceId next_of_mesh = kNone, previous_of_mesh = kNone;
    std::uint32_t own_mask = ~0u;
    bool is_new = true;     // added since the last update
    bool is_moved = false;  // though its box may be the same: its node's transform or its mesh has changed
};
static_assert(sizeof(Instance) == 32);

struct MeshRecord {
    TriangleMesh mesh;
    std::optional<PlanarPolygon> polygon;
    Obb box;
    String name;
    std::uint64_t revision = 0;  // 0: removed
    InstanceId first_instance = kNone;
};

// With the known box, or one that fits the mesh; revision and instances are the caller's to set. Errors: as
// Scene::add_mesh.
[[nodiscard]] Result<MeshRecord> make_record(TriangleMesh mesh, std::string_view name, const Obb* known_box,
                                             const measure::Criterion& criterion);

// Instances that wait for the kernel, with what it needs of them.
struct BoxQueue {
    BoxBlock block;
    InstanceId instances[kBoxesAtOnce];
    std::size_t count = 0;
};

// What one thread of update() works with, and what it found.
struct UpdateWorker {
    BoxQueue queue, sheared;  // the second: those that transform_boxes() left
    Vector<InstanceId> moved, relayered;
    std::uint32_t updated = 0, invalid = 0;
};

struct Scene::State {
    SceneOptions options;
    Vector<MeshRecord> meshes;
    Vector<Node> nodes;
    Vector<Transform> locals, worlds;  // by NodeId
    Vector<String> node_names;
    Vector<Instance> instances;
    Vector<Obb> boxes;            // by InstanceId
    Vector<std::uint32_t> masks;  // likewise
    Vector<std::uint32_t> free_nodes, free_meshes, free_instances;
    std::uint64_t last_revision = 0;

    TopologicalOrder order;
    BitSet dirty;    // positions of nodes whose world transform or mask is to be computed anew
    BitSet touched;  // instances whose box or mask is
    Vector<InstanceId> removed_since_update;

    Vector<InstanceId> moved, relayered, removed;  // what the last update found

    // Scratch of update() and of what walks subtrees.
    Vector<NodeId> nodes_scratch, by_level;
    Vector<std::uint32_t> level, level_begin;
    BitSet updated;
    Vector<InstanceId> instances_scratch;
    Vector<UpdateWorker> workers;
    BitSet sorter;

    // Whether an update would find nothing, as the last one has.
    [[nodiscard]] bool is_at_rest() const {
        return !dirty.may_hold_any() && !touched.may_hold_any() && removed_since_update.empty() && moved.empty() &&
               relayered.empty() && removed.empty();
    }
    void mark_dirty(NodeId node) { dirty.insert(nodes[node].position); }
    void append_to_order(NodeId node);
    void compact_order();
    void link_to_parent(NodeId node, NodeId parent);
    void unlink_from_parent(NodeId node);
    void list_subtree(NodeId root, Vector<NodeId>& nodes) const;
    void link_to_mesh(InstanceId instance, MeshId mesh);
    void unlink_from_mesh(InstanceId instance);
    void touch_instances_of(MeshId mesh);
    void release_instance(InstanceId instance);
    void release_node(NodeId node);

    void update_nodes(Executor& executor, UpdateStatistics& statistics);
    template <class Visit>
    void for_each_updated_node(Visit visit);
    void update_levels(Executor& executor);
    void update_touched(Executor& executor);
    void update_nodes(std::span<const NodeId> nodes, UpdateWorker& worker);
    void update_instance(InstanceId instance, UpdateWorker& worker);
    void enqueue(InstanceId instance, BoxQueue& queue) const;
    void set_boxes(UpdateWorker& worker);
    void set_sheared_boxes(UpdateWorker& worker);
    void set_careful_box(InstanceId instance, UpdateWorker& worker);
    void set_box(InstanceId instance, const Obb& box, bool shown, UpdateWorker& worker);
    void gather(UpdateStatistics& statistics);
};

}  // namespace crofton::scene
