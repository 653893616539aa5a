// SPDX-License-Identifier: MIT
#include "hit_order.hpp"

#include <algorithm>
#include <bit>
#include <utility>

namespace crofton::lines::detail {
namespace {

Hit unpacked(float t, std::uint32_t triangle) {
    return {t, triangle & ~kFront, (triangle & kFront) != 0};
}

// Where two faces back to back coincide, rounding must not put the back one in front. +0 for −0.
float place_along(float t, std::uint32_t triangle, float tie) {
    return t + ((triangle & kFront) ? 0.0f : tie);
}

// As the floats are ordered.
std::uint32_t ordered_bits(float x) {
    const auto bits = std::bit_cast<std::uint32_t>(x);
    return bits ^ (static_cast<std::uint32_t>(static_cast<std::int32_t>(bits) >> 31) | 0x80000000u);
}

struct Comparator {
    std::size_t low, high;
};

// A sorting network of n numbers: Batcher's merge exchange (Knuth, "The Art of Computer Programming", 5.2.2, M).
template <std::size_t n, class Visit>
constexpr void each_pair(Visit&& visit) {
    std::size_t most = 1;
    while (2 * most < n) most *= 2;
    for (std::size_t p = most; p > 0; p /= 2)
        for (std::size_t q = most, r = 0, d = p;; d = q - p, q /= 2, r = p) {
            for (std::size_t i = 0; i + d < n; ++i)
                if ((i & p) == r) visit(Comparator{i, i + d});
            if (q == p) break;
        }
}

template <std::size_t n>
struct Network {
    static constexpr std::size_t kPairs = [] {
        std::size_t count = 0;
        each_pair<n>([&](Comparator) { ++count; });
        return count;
    }();
    static constexpr std::array<Comparator, kPairs> pairs = [] {
        std::array<Comparator, kPairs> result{};
        std::size_t at = 0;
        each_pair<n>([&](Comparator pair) { result[at++] = pair; });
        return result;
    }();
};

template <std::size_t n, std::size_t... kPair>
void sort_network(std::uint64_t (&keys)[n], std::index_sequence<kPair...>) {
    [[maybe_unused]] const auto exchange = [&](const Comparator& pair) {
        const std::uint64_t a = keys[pair.low], b = keys[pair.high];
        keys[pair.low] = a < b ? a : b;
        keys[pair.high] = a < b ? b : a;
    };
    (exchange(Network<n>::pairs[kPair]), ...);
}

}  // namespace

void HitOrder::append(const StreamCrossings& found, std::size_t count, float tie, LineHits& result) {
    const std::size_t before = result.hits.size();
    place(found, count, result);
    result.hits.resize(before + found.count);
    Hit* const hits = result.hits.data() + before;
    sort_short(tie, hits, std::make_index_sequence<kShort>());
    for (std::size_t i = 0; i < sizes_[kShort + 1]; ++i) sort_long(lines_[kShort + 1][i], tie, hits);
}

void HitOrder::place(const StreamCrossings& found, std::size_t count, LineHits& result) {
    ends_.assign(count, 0);
    if (crossings_.size() < found.count) crossings_.resize(found.count);
    for (auto& lines : lines_)
        if (lines.size() < count) lines.resize(count);
    sizes_.fill(0);
    for (std::size_t h = 0; h < found.count; ++h) ++ends_[found.line[h]];
    const std::size_t before = result.hits.size(), lines_before = result.ends.size();
    result.ends.resize(lines_before + count);
    std::uint32_t* const result_ends = result.ends.data() + lines_before;
    std::uint32_t end = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t own = ends_[i];
        const std::size_t kind = std::min<std::size_t>(own, kShort + 1);
        lines_[kind][sizes_[kind]++] = static_cast<std::uint16_t>(i);
        ends_[i] = end;
        end += own;
        result_ends[i] = static_cast<std::uint32_t>(before + end);
    }
    for (std::size_t h = 0; h < found.count; ++h) crossings_[ends_[found.line[h]]++] = {found.t[h], found.triangle[h]};
}

template <std::size_t... kCounts>
void HitOrder::sort_short(float tie, Hit* hits, std::index_sequence<kCounts...>) {
    (sort_short<kCounts + 1>(tie, hits), ...);
}

template <std::size_t kCount>
void HitOrder::sort_short(float tie, Hit* hits) {
    const std::uint16_t* const lines = lines_[kCount].data();
    for (std::size_t l = 0; l < sizes_[kCount]; ++l) {
        const std::size_t begin = ends_[lines[l]] - kCount;
        const Crossing* const crossings = crossings_.data() + begin;
        // The place along the line in the upper half, the crossing's number in the lower one.
        std::uint64_t keys[kCount];
        for (std::size_t i = 0; i < kCount; ++i) {
            const Crossing& c = crossings[i];
            keys[i] = std::uint64_t{ordered_bits(place_along(c.t, c.triangle, tie))} << 32 | i;
        }
        sort_network(keys, std::make_index_sequence<Network<kCount>::kPairs>());
        bool tied = false;
        for (std::size_t i = 0; i + 1 < kCount; ++i) tied |= keys[i] >> 32 == keys[i + 1] >> 32;
        if (tied) {
            sort_long(lines[l], tie, hits);
            continue;
        }
        for (std::size_t i = 0; i < kCount; ++i) {
            const Crossing& c = crossings[static_cast<std::uint32_t>(keys[i])];
            hits[begin + i] = unpacked(c.t, c.triangle);
        }
    }
}

void HitOrder::sort_long(std::size_t line, float tie, Hit* hits) {
    const std::size_t begin = line == 0 ? 0 : ends_[line - 1], end = ends_[line];
    const auto before = [tie](const Crossing& a, const Crossing& b) {
        const float x = place_along(a.t, a.triangle, tie), y = place_along(b.t, b.triangle, tie);
        return x != y ? x < y : a.triangle < b.triangle;
    };
    std::sort(crossings_.data() + begin, crossings_.data() + end, before);
    for (std::size_t i = begin; i < end; ++i) hits[i] = unpacked(crossings_[i].t, crossings_[i].triangle);
}

}  // namespace crofton::lines::detail
