// SPDX-License-Identifier: MIT
// Updates of a Broadphase in which few items change: finds the pairs around these.
#include <hwy/cache_control.h>
#include <algorithm>
#include <crofton/geometry/finite.hpp>
#include <cstddef>

#include "box_lanes.hpp"
#include "broadphase_state.hpp"

namespace crofton::collide {
namespace {

bool is_valid(const Obb& box) {
    if (!(box.half_extents.x >= 0.0f) || !is_in_range(box.center)) return false;  // at once, without a message
    return validate(box).has_value();
}

}  // namespace

void Broadphase::State::note_count(std::size_t item_count) {
    if (item_count > is_moved.capacity()) is_moved.reserve(item_count + item_count / 16 + kBoxBlock);
    is_moved.resize(item_count, 0);
}

// Of `moved`, each item once, then what is new at the end, then what is dropped from it.
void Broadphase::State::gather_movers(std::size_t item_count, std::span<const std::uint32_t> moved) {
    const std::size_t before = tree.item_count();
    movers.clear();
    note_count(std::max(before, item_count));
    const auto add = [&](std::uint32_t item) {
        if (is_moved[item] != 0) return;
        is_moved[item] = 1;
        movers.push_back(item);
    };
    for (const std::uint32_t item : moved) add(item);
    for (std::size_t item = before; item < item_count; ++item) add(static_cast<std::uint32_t>(item));
    gone = movers.size();
    for (std::size_t item = item_count; item < before; ++item) add(static_cast<std::uint32_t>(item));
    gone = movers.size() - gone;
}

// The pairs that movers had. A pair of two movers is that of the lesser item.
void Broadphase::State::gather_partners() {
    partners.clear();
    partners_begin.clear();
    constexpr std::size_t kAhead = 16;
    for (std::size_t m = 0; m < movers.size(); ++m) {
        if (m + 2 * kAhead < movers.size()) table.fetch_first(movers[m + 2 * kAhead]);
        if (m + kAhead < movers.size()) table.fetch_entry(movers[m + kAhead]);
        const std::uint32_t item = movers[m];
        partners_begin.push_back(static_cast<std::uint32_t>(partners.size()));
        table.visit(item, [&](std::uint32_t partner, std::uint32_t entry) {
            if (is_moved[partner] == 0 || item < partner) partners.push_back({partner, entry});
        });
    }
    partners_begin.push_back(static_cast<std::uint32_t>(partners.size()));
}

// Where movers are in the tree now. Those with valid boxes become queries.
void Broadphase::State::place_movers(std::span<const Obb> boxes) {
    constexpr std::size_t kAhead = 2 * kBoxBlock;
    const std::size_t size_before = tree.size(), count_before = tree.item_count(), staying = movers.size() - gone;
    for (const std::uint32_t item : std::span(movers).subspan(staying))
        if (tree.contains(item)) tree.remove(item);
    tree.resize(boxes.size());
    came.clear();
    left.clear();
    queries.clear();
    query_movers.clear();
    query_bounds.clear();
    for (std::size_t begin = 0; begin < staying; begin += kBoxBlock) {
        const std::size_t size = std::min(kBoxBlock, staying - begin);
        BoxBlock block;
        BoundBlock bounds;
        for (std::size_t lane = 0; lane < kBoxBlock; ++lane) {
            const Obb& box = boxes[movers[begin + std::min(lane, size - 1)]];
            put_center(box.center - origin, lane, block);
            put_shape(box, lane, block);
            if (begin + lane + 2 * kAhead < staying) tree.fetch_place(movers[begin + lane + 2 * kAhead]);
            if (begin + lane + kAhead < staying) {
                const std::uint32_t later = movers[begin + lane + kAhead];
                tree.fetch_leaf(later);
                hwy::Prefetch(&boxes[later]);
                hwy::Prefetch(reinterpret_cast<const char*>(&boxes[later] + 1) - 1);
            }
        }
        const std::uint32_t suspect = bound_boxes(block, bounds);
        for (std::size_t lane = 0; lane < size; ++lane) {
            const std::uint32_t item = movers[begin + lane];
            if ((suspect >> lane & 1u) != 0 && !is_valid(boxes[item])) {
                if (tree.contains(item)) left.push_back(item);
                continue;
            }
            LaneBounds at;
            for (int i = 0; i < 3; ++i) {
                at.low[i] = bounds.low[i][lane];
                at.high[i] = bounds.high[i][lane];
            }
            if (tree.contains(item))
                tree.move(item, at);
            else
                came.push_back(static_cast<std::uint32_t>(queries.size()));
            queries.push_back(item);
            query_movers.push_back(static_cast<std::uint32_t>(begin + lane));
            query_bounds.push_back(at);
        }
    }
    tree.settle(queries);
    for (const std::uint32_t item : left) tree.remove(item);
    for (const std::uint32_t query : came) tree.insert(queries[query], query_bounds[query]);
    if (!came.empty() || tree.size() != size_before || tree.item_count() != count_before) rejected.forget();
}

// All pairs of a query whose bounds meet and whose filters pass, by query; false when there are too many. A pair of two
// movers is that of the lesser item.
bool Broadphase::State::find_candidates(std::span<const CollisionFilter> filters) {
    BroadphaseWorker& worker = workers.front();
    SlotPairs& slots = worker.pairs;
    slots = {worker.first.data(), worker.second.data(), 0, worker.first.size(), 0};
    bool too_many = false;
    find_partners(tree.view(), queries.data(), query_bounds.data(), queries.size(), slots, [&](SlotPairs& full) {
        too_many = !grow(full, worker);
        return !too_many;
    });
    statistics.nodes_tested = slots.leaf_pairs;
    if (too_many || slots.count > options.max_pairs) return false;
    found_begin.assign(queries.size() + 1, 0);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < slots.count; ++i) {
        const std::uint32_t query = slots.first[i], item = queries[query], other = slots.second[i];
        if (is_moved[other] != 0 && other < item) continue;
        if (!filters.empty() && !passes(filters[item], filters[other])) continue;
        slots.first[kept] = query;
        slots.second[kept] = other;
        ++kept;
        ++found_begin[query];
    }
    std::uint32_t total = 0;
    for (std::uint32_t& begin : found_begin) total += std::exchange(begin, total);
    found.resize(kept);
    for (std::size_t i = 0; i < kept; ++i) {
        const std::uint32_t item = queries[slots.first[i]], other = slots.second[i];
        found[found_begin[slots.first[i]]++] = {std::min(item, other), std::max(item, other)};
    }
    for (std::size_t query = queries.size(); query > 0; --query) found_begin[query] = found_begin[query - 1];
    found_begin[0] = 0;
    return true;
}

// What movers have gained and lost.
void Broadphase::State::compare_partners() {
    began.clear();
    ended.clear();
    ended_entries.clear();
    std::size_t query = 0;
    for (std::size_t m = 0; m < movers.size(); ++m) {
        const std::uint32_t item = movers[m];
        now.clear();
        if (query < queries.size() && query_movers[query] == m) {
            for (std::size_t i = found_begin[query]; i < found_begin[query + 1]; ++i)
                if (hits[i] != 0) now.push_back(found[i].first == item ? found[i].second : found[i].first);
            ++query;
        }
        const auto before = std::span(partners).subspan(partners_begin[m], partners_begin[m + 1] - partners_begin[m]);
        std::sort(now.begin(), now.end());
        std::sort(before.begin(), before.end(), [](const Partner& a, const Partner& b) { return a.item < b.item; });
        auto old = before.begin();
        const auto end = [&] {
            ended.push_back({std::min(item, old->item), std::max(item, old->item)});
            ended_entries.push_back(old->entry);
            ++old;
        };
        for (const std::uint32_t partner : now) {
            while (old != before.end() && old->item < partner) end();
            if (old != before.end() && old->item == partner)
                ++old;
            else
                began.push_back({std::min(item, partner), std::max(item, partner)});
        }
        while (old != before.end()) end();
    }
}

Result<void> Broadphase::State::update_few(std::span<const Obb> boxes, std::span<const std::uint32_t> moved,
                                           std::span<const CollisionFilter> filters, Executor& executor,
                                           const PairTest* test) {
    statistics = {};
    workers.resize(std::max<std::size_t>(workers.size(), executor.concurrency()));
    gather_movers(boxes.size(), moved);
    found.clear();
    tested.forget();
    stayed.forget();
    all_are_tested = false;
    if (movers.empty()) {
        began.clear();
        ended.clear();
    } else {
        begin_table();
        table.resize(std::max(tree.item_count(), boxes.size()));
        gather_partners();
        place_movers(boxes);
        bool enough_room = find_candidates(filters);
        if (enough_room) {
            statistics.bound_pairs = found.size();
            test_pairs(boxes, found, executor, test);
            compare_partners();
            enough_room = table.size() - ended.size() + began.size() <= options.max_pairs;
        }
        for (const std::uint32_t item : movers) is_moved[item] = 0;
        if (!enough_room) return drop_pairs();
        for (const std::uint32_t entry : ended_entries) table.remove(entry);
        for (const IdPair& pair : began) table.add(pair);
        table.resize(boxes.size());
        std::sort(began.begin(), began.end());
        std::sort(ended.begin(), ended.end());
        pairs.note(began, ended);
        table.settle();
    }
    statistics.box_pairs = table_is_current ? table.size() : pairs.get().size();
    statistics.rejected = static_cast<std::uint32_t>(tree.item_count() - tree.size());
    current = true;
    return {};
}

}  // namespace crofton::collide
