// What a scene keeps. Children have greater ids than their parents, so ascending ids are a topological order.
#pragma once
#include <crofton/scene/scene.hpp>

namespace crofton::scene {

struct Node {
    Transform local;
    Transform world;
    NodeId parent = kNone;
    NodeId first_child = kNone;
    NodeId next_sibling = kNone;
    InstanceId first_instance = kNone;
    std::uint32_t own_mask = ~0u;
    std::uint32_t mask = 0;     // with the ancestors', as of the last update
    std::uint32_t visited = 0;  // the update that last computed it
    bool dirty = false;
};

struct Instance {
    NodeId node = kNone;
    MeshId mesh = kNone;
    InstanceId next_on_node = kNone;
    bool removed = false;
    bool invalid = false;
};

struct MeshRecord {
    TriangleMesh mesh;
    std::unique_ptr<PlanarPolygon> polygon;
    Obb box;
    std::string name;
};

struct Scene::State {
    SceneOptions options;
    Vector<MeshRecord> meshes;
    Vector<Node> nodes;
    Vector<std::string> node_names;
    Vector<Instance> instances;
    Vector<Obb> boxes;
    Vector<std::uint32_t> masks;

    Vector<NodeId> dirty_nodes;          // set since the last update, each once
    Vector<InstanceId> added_instances;  // likewise
    std::uint32_t update_number = 0;
    Vector<NodeId> stack;  // scratch of update()
    Vector<InstanceId> touched;
    Vector<std::uint8_t> changed;
    Vector<InstanceId> moved;

    void mark_dirty(NodeId node) {
        if (nodes[node].dirty) return;
        nodes[node].dirty = true;
        dirty_nodes.push_back(node);
    }
};

}  // namespace crofton::scene
