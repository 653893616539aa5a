// SPDX-License-Identifier: MIT
#include <hwy/cache_control.h>
#include <algorithm>
#include <crofton/core/error.hpp>
#include <crofton/geometry/same_bits.hpp>
#include <crofton/scene/transformed_box.hpp>
#include <cstring>
#include <string>
#include <utility>

#include "scene_state.hpp"

namespace crofton::scene {
namespace {

constexpr std::size_t kGrain = 256;

// Returns whether that is another transform.
inline bool assign(const glm::dvec3& x, const glm::dvec3& y, const glm::dvec3& z, const glm::dvec3& translation,
                   Transform& result) {
    // Number by number: a whole Transform would be put together on the stack, and its copy wait for that.
    const bool differs =
        result.linear[0] != x || result.linear[1] != y || result.linear[2] != z || result.translation != translation;
    result.linear[0] = x;
    result.linear[1] = y;
    result.linear[2] = z;
    result.translation = translation;
    return differs;
}

// outer ∘ inner, as operator* computes it.
inline bool compose(const Transform& outer, const Transform& inner, Transform& result) {
    const auto image = [&](const glm::dvec3& v) {
        return outer.linear[0] * v.x + outer.linear[1] * v.y + outer.linear[2] * v.z;
    };
    const glm::dvec3 x = image(inner.linear[0]), y = image(inner.linear[1]), z = image(inner.linear[2]);
    return assign(x, y, z, image(inner.translation) + outer.translation, result);
}

// A lane of the kernel's input, and its output as a box.
inline void put(const Transform& world, const Obb& box, std::size_t lane, BoxBlock& block) {
    static_assert(sizeof(Transform) == 96 && sizeof(Obb) == 72);
    const auto* from = reinterpret_cast<const std::byte*>(&world);
    for (std::size_t part = 0; part < 3; ++part) std::memcpy(block.world[part][lane], from + 32 * part, 32);
    const auto* shape = reinterpret_cast<const std::byte*>(&box);
    std::memcpy(block.center[lane], shape, 32);  // the fourth number is not read
    for (std::size_t part = 0; part < 3; ++part) std::memcpy(block.shape[part][lane], shape + 24 + 16 * part, 16);
}
inline Obb take(const BoxBlock& block, std::size_t lane) {
    Obb box;
    auto* to = reinterpret_cast<std::byte*>(&box);
    std::memcpy(to, block.image_center[lane], 24);
    for (std::size_t part = 0; part < 3; ++part) std::memcpy(to + 24 + 16 * part, block.image_shape[part][lane], 16);
    return box;
}

template <class T>
void prefetch(const T& object) {
    const auto* bytes = reinterpret_cast<const std::byte*>(&object);
    hwy::Prefetch(bytes);
    hwy::Prefetch(bytes + sizeof object - 1);
}

}  // namespace

UpdateStatistics Scene::update(Executor& executor) {
    State& s = *state_;
    if (s.is_at_rest()) return {};
    s.workers.resize(std::max<std::size_t>(s.workers.size(), executor.concurrency()));
    UpdateStatistics statistics;
    s.update_nodes(executor, statistics);
    s.update_touched(executor);
    s.gather(statistics);
    s.removed.swap(s.removed_since_update);
    s.removed_since_update.clear();
    std::sort(s.removed.begin(), s.removed.end());
    if (statistics.instances_invalid > 0)
        log(LogLevel::warning, "scene: " + std::to_string(statistics.instances_invalid) +
                                   " instances are out of the range of coordinates and are hidden until they return");
    return statistics;
}

// visit(id) for dirty nodes and all below them, in topological order. Few: each makes its children dirty, which come
// later. Many: one pass over all nodes, each of which looks whether its parent was visited. This spares the walk along
// lists of children, whose every step waits for memory.
template <class Visit>
void Scene::State::for_each_updated_node(Visit visit) {
    if (dirty.count() < order.size() / 4) {
        dirty.drain([&](std::size_t position) {
            const NodeId id = order.node_at(position);
            visit(id);
            for (NodeId child = nodes[id].first_child; child != kNone; child = nodes[child].next_sibling)
                dirty.insert(nodes[child].position);
        });
        return;
    }
    updated.resize(order.size());
    constexpr std::size_t kAhead = 16;
    for (std::size_t position = 0; position < order.size(); ++position) {
        if (const NodeId later = order.node_at(std::min(position + kAhead, order.size() - 1)); later != kNone)
            hwy::Prefetch(&nodes[later]);
        const NodeId id = order.node_at(position);
        if (id == kNone) continue;
        const NodeId parent = nodes[id].parent;
        if (!dirty.contains(position) && (parent == kNone || !updated.contains(nodes[parent].position))) continue;
        updated.insert(position);
        visit(id);
    }
    dirty.clear();
    updated.clear();
}

// One thread computes nodes as they come, a few hundred at a time, so that boxes find their transforms in the cache.
void Scene::State::update_nodes(Executor& executor, UpdateStatistics& statistics) {
    const bool parallel = executor.concurrency() > 1;
    nodes_scratch.clear();
    level.resize(nodes.size(), 0);
    for_each_updated_node([&](NodeId id) {
        ++statistics.nodes_updated;
        nodes_scratch.push_back(id);
        if (touched.may_hold_any())
            for (InstanceId i = nodes[id].first_instance; i != kNone; i = instances[i].next_on_node) touched.erase(i);
        if (parallel || nodes_scratch.size() < kGrain) return;
        update_nodes(nodes_scratch, workers[0]);
        nodes_scratch.clear();
    });
    if (parallel)
        update_levels(executor);
    else
        update_nodes(nodes_scratch, workers[0]);
}

// A node's level is one more than its parent's if that is updated too, else 1; level[] is 0 for others. The nodes of a
// level depend on those of the levels before, not on each other.
void Scene::State::update_levels(Executor& executor) {
    level_begin.assign(3, 0);
    for (const NodeId id : nodes_scratch) {
        const std::uint32_t own = nodes[id].parent == kNone ? 1 : level[nodes[id].parent] + 1;
        level[id] = own;
        if (own + 2 > level_begin.size()) level_begin.resize(own + 2, 0);
        ++level_begin[own + 1];
    }
    for (std::size_t l = 2; l < level_begin.size(); ++l) level_begin[l] += level_begin[l - 1];
    by_level.resize(nodes_scratch.size());
    for (const NodeId id : nodes_scratch) {
        by_level[level_begin[level[id]]++] = id;
    }
    for (const NodeId id : nodes_scratch) level[id] = 0;
    for (std::size_t l = 1; l + 1 < level_begin.size(); ++l) {  // filling has moved each begin to its level's end
        const std::span<const NodeId> peers =
            std::span<const NodeId>(by_level).subspan(level_begin[l - 1], level_begin[l] - level_begin[l - 1]);
        if (peers.size() <= kGrain)
            update_nodes(peers, workers[0]);
        else
            executor.parallel_for(peers.size(), kGrain, [&](std::size_t begin, std::size_t end, unsigned worker) {
                update_nodes(peers.subspan(begin, end - begin), workers[worker]);
            });
    }
}

// Instances that changed on nodes that did not.
void Scene::State::update_touched(Executor& executor) {
    instances_scratch.clear();
    touched.drain([&](std::size_t i) { instances_scratch.push_back(static_cast<InstanceId>(i)); });
    const std::span<const InstanceId> ids = instances_scratch;
    executor.parallel_for(ids.size(), kGrain, [&](std::size_t begin, std::size_t end, unsigned worker) {
        for (const InstanceId id : ids.subspan(begin, end - begin)) update_instance(id, workers[worker]);
        set_boxes(workers[worker]);
        set_sheared_boxes(workers[worker]);
    });
}

void Scene::State::update_nodes(std::span<const NodeId> ids, UpdateWorker& worker) {
    constexpr std::size_t kAhead = 8;
    for (std::size_t k = 0; k < ids.size(); ++k) {
        const NodeId id = ids[k], later = ids[std::min(k + kAhead, ids.size() - 1)];
        prefetch(locals[later]);
        prefetch(worlds[later]);
        Node& node = nodes[id];
        const Transform& local = locals[id];
        const bool carries = node.parent == kNone ? assign(local.linear[0], local.linear[1], local.linear[2],
                                                           local.translation, worlds[id])
                                                  : compose(worlds[node.parent], local, worlds[id]);
        const std::uint32_t mask = node.parent == kNone ? node.own_mask : nodes[node.parent].mask & node.own_mask;
        if (mask != node.mask) node.mask = mask;  // what is not written need not go back to memory; likewise below
        for (InstanceId i = node.first_instance; i != kNone; i = instances[i].next_on_node) {
            if (carries) instances[i].is_moved = true;
            update_instance(i, worker);
        }
    }
    set_boxes(worker);
    set_sheared_boxes(worker);
}

void Scene::State::update_instance(InstanceId id, UpdateWorker& worker) {
    prefetch(boxes[id]);
    enqueue(id, worker.queue);
    if (worker.queue.count == kBoxesAtOnce) set_boxes(worker);
}

void Scene::State::enqueue(InstanceId id, BoxQueue& queue) const {
    put(worlds[instances[id].node], meshes[instances[id].mesh].box, queue.count, queue.block);
    queue.instances[queue.count++] = id;
}

// Of the instances in the queue; those that the kernel leaves go to the second queue.
void Scene::State::set_boxes(UpdateWorker& worker) {
    BoxQueue& queue = worker.queue;
    if (queue.count == 0) return;
    transform_boxes(queue.block, queue.count);
    for (std::size_t k = 0; k < queue.count; ++k) {
        if (queue.block.done[k] != 0.0) {
            set_box(queue.instances[k], take(queue.block, k), true, worker);
        } else {
            enqueue(queue.instances[k], worker.sheared);
            if (worker.sheared.count == kBoxesAtOnce) set_sheared_boxes(worker);
        }
    }
    worker.updated += static_cast<std::uint32_t>(queue.count);
    queue.count = 0;
}

void Scene::State::set_sheared_boxes(UpdateWorker& worker) {
    BoxQueue& queue = worker.sheared;
    if (queue.count == 0) return;
    const measure::Criterion& c = options.criterion;
    transform_sheared_boxes(queue.block, queue.count, {c.volume_weight, c.area_weight, c.mean_curvature_weight});
    for (std::size_t k = 0; k < queue.count; ++k) {
        if (queue.block.done[k] != 0.0)
            set_box(queue.instances[k], take(queue.block, k), true, worker);
        else
            set_careful_box(queue.instances[k], worker);
    }
    queue.count = 0;
}

// Where the kernels do not know: flat images, and numbers near the limits.
void Scene::State::set_careful_box(InstanceId id, UpdateWorker& worker) {
    const Instance& instance = instances[id];
    const Transform& world = worlds[instance.node];
    const auto box = transformed_box(world, meshes[instance.mesh].box, options.criterion);
    set_box(id, box ? *box : boxes[id], box && !maps_to_point(world), worker);
    if (!box) ++worker.invalid;
}

void Scene::State::set_box(InstanceId id, const Obb& box, bool shown, UpdateWorker& worker) {
    Instance& instance = instances[id];
    const std::uint32_t mask = shown ? nodes[instance.node].mask & instance.own_mask : 0;
    if (instance.is_new || instance.is_moved || !have_same_bits(box, boxes[id])) worker.moved.push_back(id);
    if (instance.is_moved) instance.is_moved = false;
    if (instance.is_new || mask != masks[id]) {
        worker.relayered.push_back(id);
        masks[id] = mask;
        instance.is_new = false;
    }
    boxes[id] = box;
}

// The workers' findings as one, ascending.
void Scene::State::gather(UpdateStatistics& statistics) {
    sorter.resize(instances.size());
    const auto collect = [&](Vector<InstanceId> UpdateWorker::*list, Vector<InstanceId>& all) {
        all.clear();
        all.swap(workers[0].*list);
        for (std::size_t w = 1; w < workers.size(); ++w) {
            all.insert(all.end(), (workers[w].*list).begin(), (workers[w].*list).end());
            (workers[w].*list).clear();
        }
        if (std::is_sorted(all.begin(), all.end())) return;
        for (const InstanceId id : all) sorter.insert(id);
        all.clear();
        sorter.drain([&](std::size_t id) { all.push_back(static_cast<InstanceId>(id)); });
    };
    collect(&UpdateWorker::moved, moved);
    collect(&UpdateWorker::relayered, relayered);
    for (UpdateWorker& worker : workers) {
        statistics.instances_updated += std::exchange(worker.updated, 0u);
        statistics.instances_invalid += std::exchange(worker.invalid, 0u);
    }
}

}  // namespace crofton::scene
