// SPDX-License-Identifier: MIT
#include "list/list_views_kernel.hpp"

#include <hwy/cache_control.h>
#include <algorithm>
#include <cstring>

// Also compile for AVX-512 VNNI (`vpdpwssd`).
#define HWY_WANT_AVX3_DL 1
// clang-format off
#include <hwy/foreach_target.h>
// clang-format on
#include <hwy/highway.h>

#include "list/open_records-inl.hpp"
#include "list/row_tests-inl.hpp"

#if HWY_ONCE
namespace crofton::cull {

// Copies masks. Not inlined: where the compiler knows that `count` is small it would use `rep movs`, which is slow.
HWY_NOINLINE void copy_masks(const std::uint32_t* from, std::size_t count, std::uint32_t* to) {
    std::memcpy(to, from, count * sizeof(*to));
}

}  // namespace crofton::cull
#endif

HWY_BEFORE_NAMESPACE();
namespace crofton::cull::HWY_NAMESPACE {
namespace {

// A view that is tested against the rows, and the bounds that these leave open.
struct RowView {
    RowPlanes planes;
    std::uint32_t view, bit, layer_mask;
    std::uint64_t open[kChunk / 64];
};

// One chunk against many views. The rows of 64 bounds, and their masks, stay in registers from one view to the next.
// Then the records of the bounds that the rows left open are tested. These are few, and those that are outside lose
// their bit one by one.
template <class Record>
class ChunkViews {
  public:
    ChunkViews(const ListViewsInput<Record>& input, std::uint32_t* masks)
        : in_(input), masks_(masks), words_((input.count + 63) / 64) {}

    void run(ListViewCost* costs) {
        plan();
        for (std::size_t w = 0; w < words_; ++w) {
            const std::size_t left = in_.count - 64 * w;
            if (left >= 64) {
                if (in_.beyond_cache) prefetch(w + 16);
                if (in_.layers)
                    test_rows<true>(w, masks_ + 64 * w, in_.layers + 64 * w);
                else
                    test_rows<false>(w, masks_ + 64 * w, nullptr);
                continue;
            }
            alignas(64) std::uint32_t last[64], layers[64];
            std::fill_n(layers, 64, ~0u);
            if (in_.layers) copy_masks(in_.layers + 64 * w, left, layers);
            test_rows<true>(w, last, layers);
            copy_masks(last, left, masks_ + 64 * w);
            for (std::size_t n = 0; n < asked_count_; ++n) asked_[n].open[w] &= ~std::uint64_t{0} >> (64 - left);
        }
        // One view's records are prefetched while another's are tested.
        if (asked_count_ > 0) list_open(0);
        for (std::size_t n = 0; n < asked_count_; ++n) {
            if (n + 1 < asked_count_) list_open(n + 1);
            ask_records(asked_[n], indices_[n % 2], open_counts_[n % 2], costs[asked_[n].view]);
        }
    }

  private:
    struct Whole {
        std::uint32_t bit, layer_mask;
    };

    // Sorts the views. A view that the whole chunk is outside of is dropped. If rows cannot decide, or need not,
    // all bounds are seen at first (whole_). For the others the rows are tested (asked_).
    void plan() {
        std::uint32_t useless = 0;
        for_each_bit(in_.view_bits, [&](unsigned v) {
            const RowPlanes& planes = next(v).planes;
            if (planes.outside) return;
            if (planes.useless)
                useless |= 1u << v;
            else if (planes.planes != 0)
                ++asked_count_;
            if (planes.useless || planes.planes == 0) whole_[whole_count_++] = {1u << v, in_.views[v].layer_mask};
        });
        rows_count_ = asked_count_;
        for_each_bit(useless, [&](unsigned v) {
            std::fill_n(next(v).open, words_, ~std::uint64_t{0});
            ++asked_count_;
        });
    }

    // Fills the first free place with view v.
    RowView& next(unsigned v) {
        RowView& asked = asked_[asked_count_];
        set_row_planes(in_.views[v], *in_.chunk, asked.planes);
        asked.view = v;
        asked.bit = 1u << v;
        asked.layer_mask = in_.views[v].layer_mask;
        return asked;
    }

    // Prefetches rows, and masks for writing, some words ahead. They may lie beyond the end.
    HWY_INLINE void prefetch(std::size_t w) const {
        const auto rows = reinterpret_cast<std::uintptr_t>(in_.rows) + 4 * w * sizeof(RowBlock);
        const auto masks = reinterpret_cast<std::uintptr_t>(masks_) + 64 * w * sizeof(*masks_);
        for (std::uintptr_t at = 0; at < 512; at += 64) hwy::Prefetch(reinterpret_cast<const char*>(rows + at));
        for (std::uintptr_t at = 0; at < 256; at += 64) hwy::Prefetch(reinterpret_cast<const char*>(masks + at));
    }

    template <bool kLayers>
    HWY_INLINE void test_rows(std::size_t w, std::uint32_t* masks, const std::uint32_t* layers) {
        const DU du;
        for (std::size_t l = 0; l < 16; l += hn::Lanes(du)) {
            const RowLanes rows(in_.rows + 4 * w, l);
            VU seen[4] = {hn::Zero(du), hn::Zero(du), hn::Zero(du), hn::Zero(du)};
            const auto bit_of = [&](std::size_t b, VU bit, std::uint32_t layer_mask) HWY_ATTR {
                if (!kLayers) return bit;
                const VU common = hn::And(hn::LoadU(du, layers + 16 * b + l), hn::Set(du, layer_mask));
                return hn::IfThenElseZero(hn::Ne(common, hn::Zero(du)), bit);
            };
            for (std::size_t n = 0; n < whole_count_; ++n)
                for (std::size_t b = 0; b < 4; ++b)
                    seen[b] = hn::Or(seen[b], bit_of(b, hn::Set(du, whole_[n].bit), whole_[n].layer_mask));
            for (std::size_t n = 0; n < rows_count_; ++n) {
                RowView& asked = asked_[n];
                RowTest test(rows, asked.planes);
                for (std::size_t b = 0; b < 4; ++b) {
                    const VU with = hn::Or(seen[b], bit_of(b, hn::Set(du, asked.bit), asked.layer_mask));
                    seen[b] = hn::IfThenElse(hn::RebindMask(du, test.outside[b]), seen[b], with);
                    test.inside[b] = hn::Or(test.inside[b], test.outside[b]);
                }
                const std::uint64_t open = ~bits_of_blocks(test.inside, l) & lanes_from(l);
                asked.open[w] = l == 0 ? open : asked.open[w] | open;
            }
            for (std::size_t b = 0; b < 4; ++b) hn::StoreU(seen[b], du, masks + 16 * b + l);
        }
    }

    // The bits of a word that belong to the lanes from l on.
    static HWY_INLINE std::uint64_t lanes_from(std::size_t l) {
        const std::uint64_t lanes = ((std::uint64_t{1} << hn::Lanes(DU())) - 1) << l;
        return lanes * 0x0001000100010001u;
    }

    struct Sink {
        const ListViewsInput<Record>& in;
        std::uint32_t* masks;
        std::uint32_t view, bit;

        HWY_INLINE void sixteen(std::size_t, const std::uint32_t* which, std::uint32_t outside_bits, std::uint32_t) {
            for_each_bit(outside_bits, [&](unsigned i) { outside(which[i]); });
        }
        HWY_INLINE void outside(std::uint32_t i) { masks[i] &= ~bit; }
        HWY_INLINE void undecided(std::uint32_t i) {
            if (!in.decide(in.context, i, view)) masks[i] &= ~bit;
        }
    };

    HWY_INLINE void list_open(std::size_t n) {
        std::uint32_t* indices = indices_[n % 2];
        const std::size_t count = open_counts_[n % 2] = list_sparse_bits(asked_[n].open, words_, indices);
        if (!in_.beyond_cache) return;
        for (std::size_t i = 0; i < count; ++i) hwy::Prefetch(in_.records + indices[i]);
    }

    void ask_records(const RowView& asked, std::uint32_t* indices, std::size_t count, ListViewCost& cost) {
        std::uint32_t needs_edge_test[kChunk + 16];
        Sink sink{in_, masks_, asked.view, asked.bit};
        OpenRecords<Record, Sink> records(in_.views[asked.view], *in_.chunk, in_.records, asked.planes.planes,
                                          in_.exact, sink);
        const OpenCounts counts = records.test(indices, count, needs_edge_test);
        cost.resolved += counts.resolved;
        cost.false_positives += counts.false_positives;
        cost.straddling += counts.straddling;
        cost.undecided += counts.undecided;
    }

    const ListViewsInput<Record>& in_;
    std::uint32_t* masks_;
    std::size_t words_;
    RowView asked_[kMaxListViews];
    Whole whole_[kMaxListViews];
    std::size_t asked_count_ = 0, rows_count_ = 0, whole_count_ = 0;
    std::uint32_t indices_[2][kChunk + 16];  // what the rows leave open of two views
    std::size_t open_counts_[2];
};

void run_box_views(const ListViewsInput<BoxRecord>& input, std::uint32_t* masks, ListViewCost* costs) {
    ChunkViews<BoxRecord>(input, masks).run(costs);
}
void run_aabb_views(const ListViewsInput<AabbRecord>& input, std::uint32_t* masks, ListViewCost* costs) {
    ChunkViews<AabbRecord>(input, masks).run(costs);
}
void run_sphere_views(const ListViewsInput<SphereRecord>& input, std::uint32_t* masks, ListViewCost* costs) {
    ChunkViews<SphereRecord>(input, masks).run(costs);
}

}  // namespace
}  // namespace crofton::cull::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::cull {

HWY_EXPORT(run_box_views);
HWY_EXPORT(run_aabb_views);
HWY_EXPORT(run_sphere_views);

void run_list_views_kernel(const ListViewsInput<BoxRecord>& input, std::uint32_t* masks, ListViewCost* costs) {
    HWY_DYNAMIC_DISPATCH(run_box_views)(input, masks, costs);
}
void run_list_views_kernel(const ListViewsInput<AabbRecord>& input, std::uint32_t* masks, ListViewCost* costs) {
    HWY_DYNAMIC_DISPATCH(run_aabb_views)(input, masks, costs);
}
void run_list_views_kernel(const ListViewsInput<SphereRecord>& input, std::uint32_t* masks, ListViewCost* costs) {
    HWY_DYNAMIC_DISPATCH(run_sphere_views)(input, masks, costs);
}

}  // namespace crofton::cull
#endif
