// SPDX-License-Identifier: MIT
#include "pair_sort.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <limits>
#include <utility>

namespace crofton::mesh {
namespace {

using Key = std::uint64_t;

constexpr std::size_t kFew = 24, kMost = 2048;  // fewer and more than these go to std::sort
constexpr int kBucketBits = 8;

Key key_of(const IdPair& pair) {
    return Key{pair.first} << 32 | pair.second;
}

void insertion_sort(std::span<Key> keys) {
    for (std::size_t i = 1; i < keys.size(); ++i) {
        const Key key = keys[i];
        std::size_t j = i;
        for (; j > 0 && key < keys[j - 1]; --j) keys[j] = keys[j - 1];
        keys[j] = key;
    }
}

// By counting in buckets of equal width over the range of `first`, then within each bucket.
void sort_by_buckets(std::span<IdPair> pairs) {
    std::uint32_t low = std::numeric_limits<std::uint32_t>::max(), high = 0;
    for (const IdPair& pair : pairs) {
        low = std::min(low, pair.first);
        high = std::max(high, pair.first);
    }
    const int shift = std::max(0, static_cast<int>(std::bit_width(high - low)) - kBucketBits);
    std::uint32_t place[1u << kBucketBits] = {};
    for (const IdPair& pair : pairs) ++place[(pair.first - low) >> shift];
    std::uint32_t total = 0;
    for (std::uint32_t& p : place) total += std::exchange(p, total);
    Key keys[kMost];
    for (const IdPair& pair : pairs) keys[place[(pair.first - low) >> shift]++] = key_of(pair);
    std::uint32_t begin = 0;
    for (const std::uint32_t end : place) {
        if (end - begin > kFew) std::sort(keys + begin, keys + end);
        begin = end;
    }
    insertion_sort({keys, pairs.size()});
    for (std::size_t i = 0; i < pairs.size(); ++i)
        pairs[i] = {static_cast<std::uint32_t>(keys[i] >> 32), static_cast<std::uint32_t>(keys[i])};
}

}  // namespace

void sort_pairs(std::span<IdPair> pairs) {
    if (pairs.size() > kFew && pairs.size() <= kMost) return sort_by_buckets(pairs);
    std::sort(pairs.begin(), pairs.end(), [](const IdPair& x, const IdPair& y) { return key_of(x) < key_of(y); });
}

// Keys are sorted, and every contact is moved once: it is five times as large as its key and place.
void sort_by_triangles(std::span<MeshContact> contacts) {
    struct Place {
        Key key;
        std::uint32_t from;
    };
    if (contacts.size() > kMost) {
        std::sort(contacts.begin(), contacts.end(),
                  [](const MeshContact& x, const MeshContact& y) { return key_of(x.triangles) < key_of(y.triangles); });
        return;
    }
    Place places[kMost];
    const auto count = static_cast<std::uint32_t>(contacts.size());
    for (std::uint32_t i = 0; i < count; ++i) places[i] = {key_of(contacts[i].triangles), i};
    std::sort(places, places + count, [](const Place& x, const Place& y) { return x.key < y.key; });
    for (std::uint32_t i = 0; i < count; ++i) {  // by cycles
        if (places[i].from == i) continue;
        const MeshContact first = contacts[i];
        std::uint32_t to = i;
        for (std::uint32_t from; (from = std::exchange(places[to].from, to)) != i; to = from)
            contacts[to] = contacts[from];
        contacts[to] = first;
    }
}

}  // namespace crofton::mesh
