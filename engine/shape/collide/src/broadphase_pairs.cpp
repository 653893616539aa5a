// SPDX-License-Identifier: MIT
// Lists of what an update found. They are made when they are read, so that an update's cost follows its changes.
#include <algorithm>
#include <iterator>

#include "broadphase_state.hpp"

namespace crofton::collide {

std::span<const IdPair> Broadphase::pairs() const {
    return state_->pairs.get();
}
std::span<const IdPair> Broadphase::began() const {
    return state_->began;
}
std::span<const IdPair> Broadphase::stayed() const {
    if (state_->began.empty()) return pairs();
    return state_->stayed.get([&](Vector<IdPair>& stayed) {
        const Vector<IdPair>& all = state_->pairs.get();
        stayed.clear();
        std::set_difference(all.begin(), all.end(), state_->began.begin(), state_->began.end(),
                            std::back_inserter(stayed));
    });
}
std::span<const IdPair> Broadphase::ended() const {
    return state_->ended;
}
std::span<const IdPair> Broadphase::tested() const {
    if (state_->all_are_tested) return pairs();
    return state_->tested.get([&](Vector<IdPair>& tested) {
        tested.clear();
        for (std::size_t i = 0; i < state_->found.size(); ++i)
            if (state_->hits[i] != 0) tested.push_back(state_->found[i]);
        std::sort(tested.begin(), tested.end());
    });
}
std::span<const std::uint32_t> Broadphase::rejected() const {
    return state_->rejected.get([&](Vector<std::uint32_t>& rejected) {
        const ItemTree& tree = state_->tree;
        rejected.clear();
        for (std::uint32_t item = 0; item < tree.item_count(); ++item)
            if (!tree.contains(item)) rejected.push_back(item);
    });
}
const BroadphaseStatistics& Broadphase::statistics() const {
    return state_->statistics;
}

}  // namespace crofton::collide
