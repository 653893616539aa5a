// SPDX-License-Identifier: MIT
// Lists of what an update has found, made when someone asks for them: an update's cost follows what has changed.
#include <algorithm>
#include <iterator>

#include "broadphase_state.hpp"

namespace crofton::collide {
namespace {

// Beyond such a part of the pairs, they are sorted anew.
constexpr std::size_t kMostEdits = 8, kFewEdits = 1024;

}  // namespace

std::span<const IdPair> Broadphase::pairs() const {
    state_->update_lists(state_->pairs_are_old, &State::list_pairs);
    return state_->pairs;
}
std::span<const IdPair> Broadphase::began() const {
    return state_->began;
}
std::span<const IdPair> Broadphase::stayed() const {
    if (state_->began.empty()) return pairs();
    state_->update_lists(state_->stayed_is_old, &State::list_stayed);
    return state_->stayed;
}
std::span<const IdPair> Broadphase::ended() const {
    return state_->ended;
}
std::span<const std::uint32_t> Broadphase::rejected() const {
    state_->update_lists(state_->rejected_is_old, &State::list_rejected);
    return state_->rejected;
}
const BroadphaseStatistics& Broadphase::statistics() const {
    return state_->statistics;
}

// The first who asks makes the list.
void Broadphase::State::update_lists(std::atomic<bool>& is_old, void (State::*make)()) {
    if (!is_old.load(std::memory_order_acquire)) return;
    const std::lock_guard lock(mutex);
    if (!is_old.load(std::memory_order_relaxed)) return;
    (this->*make)();
    is_old.store(false, std::memory_order_release);
}

// Of the edits of one pair, which take turns, the first and the last tell what has come of it.
void Broadphase::State::list_pairs() {
    if (!edits_are_complete) {
        table.list(pairs);
        std::sort(pairs.begin(), pairs.end());
    } else {
        std::stable_sort(edits.begin(), edits.end(),
                         [](const PairEdit& a, const PairEdit& b) { return a.pair < b.pair; });
        added.clear();
        removed.clear();
        for (std::size_t begin = 0, end; begin < edits.size(); begin = end) {
            for (end = begin + 1; end < edits.size() && edits[end].pair == edits[begin].pair; ++end) {
            }
            if (edits[begin].is_added != edits[end - 1].is_added) continue;
            (edits[begin].is_added ? added : removed).push_back(edits[begin].pair);
        }
        sorted_edits.apply<IdPair>(removed, added, pairs, [](const IdPair& a, const IdPair& b) { return a < b; });
    }
    edits.clear();
    edits_are_complete = true;
}

void Broadphase::State::list_stayed() {
    if (pairs_are_old.load(std::memory_order_relaxed)) list_pairs();
    pairs_are_old.store(false, std::memory_order_release);
    stayed.clear();
    std::set_difference(pairs.begin(), pairs.end(), began.begin(), began.end(), std::back_inserter(stayed));
}

void Broadphase::State::list_rejected() {
    rejected.clear();
    for (std::uint32_t item = 0; item < tree.item_count(); ++item)
        if (!tree.contains(item)) rejected.push_back(item);
}

// What has begun and ended in this update is to be done to the list.
void Broadphase::State::note_edits() {
    stayed_is_old = true;
    if (began.empty() && ended.empty()) return;
    pairs_are_old = true;
    if (!edits_are_complete) return;
    for (const IdPair& pair : began) edits.push_back({pair, true});
    for (const IdPair& pair : ended) edits.push_back({pair, false});
    if (edits.size() <= kFewEdits + pairs.size() / kMostEdits) return;
    edits.clear();
    edits_are_complete = false;
}

void Broadphase::State::use_table(std::size_t item_count) {
    if (!table_is_current) table.assign(item_count, pairs);
    table_is_current = true;
}

}  // namespace crofton::collide
