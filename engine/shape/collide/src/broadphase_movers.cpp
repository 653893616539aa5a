// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstddef>

#include "box_lanes.hpp"
#include "broadphase_state.hpp"

namespace crofton::collide {

// Of `moved`, each item once.
void Broadphase::State::gather_movers(std::size_t item_count, std::span<const std::uint32_t> moved) {
    movers.clear();
    mover_slots.clear();
    is_moved.resize(item_count, 0);
    for (const std::uint32_t item : moved) {
        if (is_moved[item] != 0) continue;
        is_moved[item] = 1;
        movers.push_back(item);
        mover_slots.push_back(order.slots()[item]);
    }
}

// Sixteen boxes at a time, then the bounds above each.
void Broadphase::State::move_bounds(std::span<const Obb> boxes) {
    std::erase_if(rejected, [&](std::uint32_t item) { return is_moved[item] != 0; });
    for (std::size_t begin = 0; begin < movers.size(); begin += kBoxBlock) {
        const std::size_t count = std::min(kBoxBlock, movers.size() - begin);
        BoxBlock block;
        BoundBlock bounds;
        for (std::size_t lane = 0; lane < kBoxBlock; ++lane) {
            const Obb& box = boxes[movers[begin + std::min(lane, count - 1)]];
            put_center(box.center - origin, lane, block);
            put_shape(box, lane, block);
        }
        const std::uint32_t suspect = bound_boxes(block, bounds);
        for (std::size_t lane = 0; lane < count; ++lane) {
            const std::uint32_t item = movers[begin + lane], slot = mover_slots[begin + lane];
            BoundBlock& leaf = levels[0][slot / kBoxBlock];
            for (int i = 0; i < 3; ++i) {
                leaf.low[i][slot % kBoxBlock] = bounds.low[i][lane];
                leaf.high[i][slot % kBoxBlock] = bounds.high[i][lane];
            }
            if ((suspect >> lane & 1u) == 0 || validate(boxes[item]).has_value()) continue;
            rejected.push_back(item);
            clear_lane(leaf, slot % kBoxBlock);
        }
    }
    std::sort(rejected.begin(), rejected.end());
    for (const std::uint32_t slot : mover_slots) {
        std::size_t block = slot / kBoxBlock;
        leaf_extent -= extent_of_lane(levels[1][block / kBoxBlock], block % kBoxBlock);
        for (std::size_t k = 0; k + 1 < tree.level_count; ++k, block /= kBoxBlock) {
            bound_blocks(levels[k].data(), block, block + 1, levels[k + 1].data());
            if (k == 0) leaf_extent += extent_of_lane(levels[1][block / kBoxBlock], block % kBoxBlock);
        }
    }
}

// All pairs of an item that moved whose bounds meet and whose filters pass, sorted; false when there are too many.
bool Broadphase::State::find_candidates(std::span<const CollisionFilter> filters) {
    BroadphaseWorker& worker = workers.front();
    worker.pairs = {worker.first.data(), worker.second.data(), 0, worker.first.size(), 0};
    bool too_many = false;
    find_partners(tree, mover_slots.data(), mover_slots.size(), worker.pairs, [&](SlotPairs& slots) {
        too_many = !grow(slots, worker);
        return !too_many;
    });
    statistics.nodes_tested = worker.pairs.leaf_pairs;
    if (too_many || worker.pairs.count > options.max_pairs) return false;
    found.clear();
    for (std::size_t i = 0; i < worker.pairs.count; ++i) {
        const std::uint32_t item = order.items()[worker.first[i]], other = order.items()[worker.second[i]];
        if (is_moved[other] != 0 && other < item) continue;  // its turn lists the pair
        if (!filters.empty() && !passes(filters[item], filters[other])) continue;
        found.push_back({std::min(item, other), std::max(item, other)});
    }
    std::sort(found.begin(), found.end());
    return true;
}

// The movers' pairs give way to those found; false when there are too many then.
bool Broadphase::State::replace_pairs() {
    kept.clear();
    lost.clear();
    for (const IdPair& pair : pairs) (is_moved[pair.first] | is_moved[pair.second] ? lost : kept).push_back(pair);
    if (kept.size() + found.size() > options.max_pairs) return false;
    compare_pairs(lost, found, began, still, ended);
    pairs.resize(kept.size() + found.size());
    std::merge(kept.begin(), kept.end(), found.begin(), found.end(), pairs.begin());
    stayed.resize(kept.size() + still.size());
    std::merge(kept.begin(), kept.end(), still.begin(), still.end(), stayed.begin());
    return true;
}

Result<void> Broadphase::State::update_few(std::span<const Obb> boxes, std::span<const CollisionFilter> filters,
                                           Executor& executor) {
    const bool nothing_to_do = movers.empty() && began.empty() && ended.empty();
    statistics = {};
    workers.resize(std::max<std::size_t>(workers.size(), executor.concurrency()));
    if (!nothing_to_do) {
        move_bounds(boxes);
        bool enough_room = find_candidates(filters);
        statistics.bound_pairs = found.size();
        if (enough_room) {
            keep_pairs_that_meet(boxes, found, executor);
            enough_room = replace_pairs();
        }
        for (const std::uint32_t item : movers) is_moved[item] = 0;
        if (!enough_room) {
            std::swap(pairs, previous);
            pairs.clear();
            return drop_pairs();
        }
    }
    statistics.box_pairs = pairs.size();
    statistics.rejected = static_cast<std::uint32_t>(rejected.size());
    current = true;
    return {};
}

}  // namespace crofton::collide
