#include <algorithm>
#include <crofton/core/log.hpp>
#include <string>

#include "scene_state.hpp"

namespace crofton::scene {
namespace {

constexpr std::size_t kNodeGrain = 512, kInstanceGrain = 256;
constexpr std::uint8_t kMoved = 1, kRelayered = 2, kInvalid = 4;

bool same(const Obb& a, const Obb& b) {
    return a.center == b.center && a.axes == b.axes && a.half_extents == b.half_extents;
}

}  // namespace

UpdateStatistics Scene::update(Executor& executor) {
    State& s = *state_;
    UpdateStatistics statistics;
    s.update_nodes(executor, statistics);
    s.update_instances(executor, statistics);
    s.removed.swap(s.removed_since_update);
    s.removed_since_update.clear();
    std::sort(s.removed.begin(), s.removed.end());
    if (statistics.instances_invalid > 0)
        log(LogLevel::warning, "scene: " + std::to_string(statistics.instances_invalid) +
                                   " instances left the range of coordinates and are hidden until they return");
    return statistics;
}

void Scene::State::update_node(NodeId id) {
    Node& node = nodes[id];
    if (node.parent == kNone) {
        worlds[id] = locals[id];
        node.mask = node.own_mask;
    } else {
        worlds[id] = worlds[node.parent] * locals[id];
        node.mask = nodes[node.parent].mask & node.own_mask;
    }
}

// Dirty nodes in topological order. Each makes its children dirty, which come later: all below it follow, each once.
void Scene::State::update_nodes(Executor& executor, UpdateStatistics& statistics) {
    const bool parallel = executor.concurrency() > 1;
    nodes_scratch.clear();
    level.resize(nodes.size(), 0);
    dirty.drain([&](std::size_t position) {
        const NodeId id = order.node_at(position);
        ++statistics.nodes_updated;
        if (parallel)
            nodes_scratch.push_back(id);
        else
            update_node(id);
        const Node& node = nodes[id];
        for (InstanceId i = node.first_instance; i != kNone; i = instances[i].next_on_node) touched.insert(i);
        for (NodeId child = node.first_child; child != kNone; child = nodes[child].next_sibling) {
            dirty.insert(nodes[child].position);
            if (parallel) level[child] = level[id] + 1;
        }
    });
    if (parallel) update_levels(executor);
}

// level[id] is the number of updated ancestors. A level's nodes depend on the one before, not on each other.
void Scene::State::update_levels(Executor& executor) {
    level_begin.assign(2, 0);
    for (const NodeId id : nodes_scratch) {
        if (level[id] + 2 > level_begin.size() - 1) level_begin.resize(level[id] + 3, 0);
        ++level_begin[level[id] + 2];
    }
    for (std::size_t l = 2; l < level_begin.size(); ++l) level_begin[l] += level_begin[l - 1];
    by_level.resize(nodes_scratch.size());
    for (const NodeId id : nodes_scratch) {
        by_level[level_begin[level[id] + 1]++] = id;
        level[id] = 0;
    }
    for (std::size_t l = 0; l + 2 < level_begin.size(); ++l) {
        const std::span<const NodeId> peers =
            std::span<const NodeId>(by_level).subspan(level_begin[l], level_begin[l + 1] - level_begin[l]);
        const auto update = [&](std::size_t begin, std::size_t end, unsigned) {
            for (const NodeId id : peers.subspan(begin, end - begin)) update_node(id);
        };
        if (peers.size() <= kNodeGrain)
            update(0, peers.size(), 0);
        else
            executor.parallel_for(peers.size(), kNodeGrain, update);
    }
}

void Scene::State::update_instances(Executor& executor, UpdateStatistics& statistics) {
    instances_scratch.clear();
    touched.drain([&](std::size_t i) { instances_scratch.push_back(static_cast<InstanceId>(i)); });
    const std::span<const InstanceId> ids = instances_scratch;
    changes.resize(ids.size());
    executor.parallel_for(ids.size(), kInstanceGrain, [&](std::size_t begin, std::size_t end, unsigned) {
        for (std::size_t k = begin; k < end; ++k) {
            const InstanceId id = ids[k];
            Instance& instance = instances[id];
            const Transform& world = worlds[instance.node];
            const auto box = transformed_box(world, meshes[instance.mesh].box, options.criterion);
            std::uint8_t change = instance.is_new ? kMoved | kRelayered : 0;
            const std::uint32_t mask = box && !maps_to_point(world) ? nodes[instance.node].mask & instance.own_mask : 0;
            if (!box) change |= kInvalid;
            if (box && !same(*box, boxes[id])) {
                boxes[id] = *box;
                change |= kMoved;
            }
            if (mask != masks[id]) {
                masks[id] = mask;
                change |= kRelayered;
            }
            instance.is_new = false;
            changes[k] = change;
        }
    });
    statistics.instances_updated = static_cast<std::uint32_t>(ids.size());
    moved.clear();
    relayered.clear();
    for (std::size_t k = 0; k < ids.size(); ++k) {
        if (changes[k] & kMoved) moved.push_back(ids[k]);
        if (changes[k] & kRelayered) relayered.push_back(ids[k]);
        statistics.instances_invalid += changes[k] & kInvalid ? 1u : 0u;
    }
}

}  // namespace crofton::scene
