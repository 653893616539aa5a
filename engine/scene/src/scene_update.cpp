#include <algorithm>
#include <crofton/core/log.hpp>

#include "scene_state.hpp"

namespace crofton::scene {
namespace {

bool same(const Obb& a, const Obb& b) {
    return a.center == b.center && a.axes == b.axes && a.half_extents == b.half_extents;
}

}  // namespace

// Dirty nodes ascending: an ancestor that is dirty too comes first and takes its whole subtree with it.
UpdateStatistics Scene::update(Executor& executor) {
    State& s = *state_;
    UpdateStatistics statistics;
    ++s.update_number;
    s.touched.clear();
    s.moved.clear();
    std::sort(s.dirty_nodes.begin(), s.dirty_nodes.end());
    for (const NodeId root : s.dirty_nodes) {
        s.nodes[root].dirty = false;
        if (s.nodes[root].visited == s.update_number) continue;
        s.stack.assign(1, root);
        while (!s.stack.empty()) {
            const NodeId id = s.stack.back();
            s.stack.pop_back();
            Node& node = s.nodes[id];
            const Node* parent = node.parent == kNone ? nullptr : &s.nodes[node.parent];
            node.world = parent ? parent->world * node.local : node.local;
            node.mask = parent ? parent->mask & node.own_mask : node.own_mask;
            node.visited = s.update_number;
            ++statistics.nodes_updated;
            for (InstanceId i = node.first_instance; i != kNone; i = s.instances[i].next_on_node)
                s.touched.push_back(i);
            for (NodeId child = node.first_child; child != kNone; child = s.nodes[child].next_sibling)
                s.stack.push_back(child);
        }
    }
    s.dirty_nodes.clear();
    for (const InstanceId i : s.added_instances)
        if (s.nodes[s.instances[i].node].visited != s.update_number) s.touched.push_back(i);
    s.added_instances.clear();
    std::erase_if(s.touched, [&](InstanceId i) { return s.instances[i].removed; });
    std::sort(s.touched.begin(), s.touched.end());

    s.changed.assign(s.touched.size(), 0);
    constexpr std::size_t kGrain = 256;
    executor.parallel_for(s.touched.size(), kGrain, [&](std::size_t begin, std::size_t end, unsigned) {
        for (std::size_t k = begin; k < end; ++k) {
            const InstanceId id = s.touched[k];
            Instance& instance = s.instances[id];
            const Node& node = s.nodes[instance.node];
            const auto box = transformed_box(node.world, s.meshes[instance.mesh].box, s.options.criterion);
            instance.invalid = !box;
            s.masks[id] = box ? node.mask : 0;
            s.changed[k] = box && !same(*box, s.boxes[id]) ? 1 : 0;
            if (box) s.boxes[id] = *box;
        }
    });
    statistics.instances_updated = static_cast<std::uint32_t>(s.touched.size());
    for (std::size_t k = 0; k < s.touched.size(); ++k) {
        if (s.changed[k]) s.moved.push_back(s.touched[k]);
        statistics.instances_invalid += s.instances[s.touched[k]].invalid ? 1u : 0u;
    }
    if (statistics.instances_invalid > 0)
        log(LogLevel::warning, "scene: " + std::to_string(statistics.instances_invalid) +
                                   " instances left the range of coordinates and are hidden until they return");
    return statistics;
}

}  // namespace crofton::scene
