// SPDX-License-Identifier: MIT
#include "pair_list.hpp"

#include <algorithm>
#include <utility>

namespace crofton::collide {

void PairList::begin(std::size_t item_count) {
    place_.assign(item_count + 1, 0);
}

void PairList::count(std::span<const std::uint32_t> first) {
    for (const std::uint32_t item : first) ++place_[item];
}

void PairList::place(Vector<IdPair>& sorted) {
    std::uint32_t total = 0;
    for (std::uint32_t& place : place_) total += std::exchange(place, total);
    sorted.resize(total);
}

void PairList::add(std::span<const std::uint32_t> first, std::span<const std::uint32_t> second,
                   Vector<IdPair>& sorted) {
    for (std::size_t i = 0; i < first.size(); ++i) sorted[place_[first[i]]++] = {first[i], second[i]};
}

// Partners of one item stand together but in any order: most have none or few, and insertion mends those in one pass.
// One number a pair: whether items or only partners differ is not worth a branch.
void PairList::finish(Vector<IdPair>& sorted) const {
    constexpr std::size_t kFew = 12;
    std::size_t begin = 0;
    for (const std::uint32_t end : place_) {
        if (end - begin > kFew)
            std::sort(sorted.begin() + static_cast<std::ptrdiff_t>(begin),
                      sorted.begin() + static_cast<std::ptrdiff_t>(end));
        begin = end;
    }
    const auto key = [](const IdPair& pair) { return std::uint64_t{pair.first} << 32 | pair.second; };
    std::uint64_t before = 0;
    for (std::size_t i = 0; i < sorted.size(); ++i) {
        const IdPair pair = sorted[i];
        if (key(pair) >= before) {
            before = key(pair);
            continue;
        }
        std::size_t j = i;
        for (; j > 0 && key(pair) < key(sorted[j - 1]); --j) sorted[j] = sorted[j - 1];
        sorted[j] = pair;
    }
}

void compare_pairs(std::span<const IdPair> before, std::span<const IdPair> now, Vector<IdPair>& began,
                   Vector<IdPair>& ended) {
    began.clear();
    ended.clear();
    std::size_t i = 0, j = 0;
    while (i < now.size() && j < before.size()) {
        if (now[i] == before[j]) {
            ++i;
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
