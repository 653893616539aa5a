#include "pair_list.hpp"

#include <algorithm>
#include <utility>

namespace crofton::collide {

void PairList::begin(std::size_t item_count) {
    place_.assign(item_count + 1, 0);
}

void PairList::count(std::span<Pair> pairs, std::span<const std::uint32_t> items, std::span<const Filter> filters) {
    for (Pair& pair : pairs) {
        const std::uint32_t a = items[pair.first], b = items[pair.second];
        if (!filters.empty() && !passes(filters[a], filters[b])) {
            pair = {0, 0};
            continue;
        }
        pair = {std::min(a, b), std::max(a, b)};
        ++place_[pair.first];
    }
}

void PairList::place() {
    total_ = 0;
    for (std::uint64_t& place : place_) total_ += std::exchange(place, total_);
    partners_.resize(total_);
}

void PairList::add(std::span<const Pair> pairs) {
    for (const Pair& pair : pairs)
        if (pair.first != pair.second) partners_[place_[pair.first]++] = pair.second;
}

void PairList::sort(Vector<Pair>& sorted) {
    sorted.resize(total_);
    std::size_t begin = 0;
    for (std::uint32_t item = 0; begin < total_; ++item) {
        const auto end = static_cast<std::size_t>(place_[item]);
        if (end - begin > 1)
            std::sort(partners_.begin() + static_cast<std::ptrdiff_t>(begin),
                      partners_.begin() + static_cast<std::ptrdiff_t>(end));
        for (; begin < end; ++begin) sorted[begin] = {item, partners_[begin]};
    }
}

void compare_pairs(std::span<const Pair> before, std::span<const Pair> now, Vector<Pair>& began, Vector<Pair>& stayed,
                   Vector<Pair>& ended) {
    began.clear();
    stayed.clear();
    ended.clear();
    std::size_t i = 0, j = 0;
    while (i < now.size() && j < before.size()) {
        if (now[i] == before[j]) {
            stayed.push_back(now[i++]);
            ++j;
        } else if (now[i] < before[j]) {
            began.push_back(now[i++]);
        } else {
            ended.push_back(before[j++]);
        }
    }
    began.insert(began.end(), now.begin() + static_cast<std::ptrdiff_t>(i), now.end());
    ended.insert(ended.end(), before.begin() + static_cast<std::ptrdiff_t>(j), before.end());
}

}  // namespace crofton::collide
