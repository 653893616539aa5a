// SPDX-License-Identifier: MIT
// The builder's work before the subtrees on several threads: keys, their order, the clusters' bounds.
#include <algorithm>
#include <crofton/core/recovery.hpp>
#include <utility>

#include "builder.hpp"

namespace crofton::boxtree {
namespace {

constexpr std::size_t kItemsAtOnce = 16384;

}  // namespace

void Builder::prepare_all(std::span<const Obb> boxes, const Movers& movers, detail::StopSignal& stop,
                          Executor& executor) {
    keys_.resize(boxes.size());
    detail::recoverable_for(executor, boxes.size(), kItemsAtOnce, [&](std::size_t begin, std::size_t end, unsigned) {
        for (std::size_t i = begin; i < end; ++i) keys_[i] = key_of(static_cast<ItemId>(i), boxes[i]);
    });
    if (boxes.size() <= small_crowd_) {
        place_all();
    } else {
        if (stop.is_raised(0.0)) return;
        sort_keys(executor);
        phase_ = Phase::crowding;
    }
    while (phase_ != Phase::label && phase_ != Phase::ready) {
        if (stop.is_raised(0.1)) return;
        prepare_on(kItemsAtOnce, boxes, movers);
    }
    if (phase_ == Phase::ready) return;
    label_items(executor);
    if (stop.is_raised(0.2)) return;
    bound_clusters(boxes, executor);
    if (stop.is_raised(0.2)) return;
    (void)place_clusters(~std::size_t{0});
}

// A radix sort, the least significant digit first. Each part of the keys knows how many of each digit the parts before
// it have: so equal digits keep their order.
void Builder::sort_keys(Executor& executor) {
    using Counts = std::array<std::uint32_t, kDigits>;
    Vector<Counts> parts((keys_.size() + kItemsAtOnce - 1) / kItemsAtOnce);
    keys_next_.resize(keys_.size());
    for (unsigned pass = 0; pass < kPasses; ++pass) {
        const unsigned shift = kItemBits + pass * kDigitBits;
        const auto digit = [&](std::size_t i) { return keys_[i] >> shift & (kDigits - 1); };
        detail::recoverable_for(executor, keys_.size(), kItemsAtOnce,
                                [&](std::size_t begin, std::size_t end, unsigned) {
                                    Counts& counts = parts[begin / kItemsAtOnce];
                                    counts.fill(0);
                                    for (std::size_t i = begin; i < end; ++i) ++counts[digit(i)];
                                });
        std::uint32_t sum = 0;
        for (std::size_t d = 0; d < kDigits; ++d)
            for (Counts& counts : parts) sum += std::exchange(counts[d], sum);
        detail::recoverable_for(executor, keys_.size(), kItemsAtOnce,
                                [&](std::size_t begin, std::size_t end, unsigned) {
                                    Counts& places = parts[begin / kItemsAtOnce];
                                    for (std::size_t i = begin; i < end; ++i) keys_next_[places[digit(i)]++] = keys_[i];
                                });
        keys_.swap(keys_next_);
    }
}

void Builder::label_items(Executor& executor) {
    detail::recoverable_for(executor, cluster_ranges_.size(), 4, [&](std::size_t begin, std::size_t end, unsigned) {
        for (std::size_t c = begin; c < end; ++c)
            for (std::uint32_t i = cluster_ranges_[c].begin; i < cluster_ranges_[c].end; ++i)
                cluster_of_[result_.order[i]] = static_cast<std::uint32_t>(c);
    });
}

// Computes the clusters' bounds. These are maxima, so the order of the items does not matter.
void Builder::bound_clusters(std::span<const Obb> boxes, Executor& executor) {
    Vector<Vector<BuildItem>> found(executor.concurrency());
    for (auto& bounds : found) bounds.assign(clusters_.size(), kNothing);
    detail::recoverable_for(executor, cluster_of_.size(), kItemsAtOnce,
                            [&](std::size_t begin, std::size_t end, unsigned worker) {
                                for (std::size_t i = begin; i < end; ++i)
                                    if (cluster_of_[i] != kNone)
                                        found[worker][cluster_of_[i]].include(build_item(0, boxes[i], middle_));
                            });
    for (std::uint32_t c = 0; c < clusters_.size(); ++c) {
        for (const auto& bounds : found) clusters_[c].include(bounds[c]);
        clusters_[c].set_id(c);
    }
}

}  // namespace crofton::boxtree
