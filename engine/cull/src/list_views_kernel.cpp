#include "list_views_kernel.hpp"

#include <algorithm>

// Vectors of unknown size cannot be members.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "list_views_kernel.cpp"
// clang-format off
#include <hwy/foreach_target.h>
// clang-format on
#include <hwy/highway.h>

#include "open_records-inl.hpp"
#include "row_tests-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::cull::HWY_NAMESPACE {
namespace {

// A view that the rows are asked for, and what they leave open of it.
struct RowView {
    RowPlanes planes;
    std::uint32_t view, bit, layer_mask;
    std::uint64_t open[kChunk / 64];
};

// The rows of 64 bounds stay in registers from one view to the next, and so do the masks. What the records then know
// better is few bounds, and is taken back one by one.
template <class Record>
class ChunkViews {
  public:
    ChunkViews(const ListViewsInput<Record>& input, std::uint32_t* masks)
        : in_(input), masks_(masks), words_((input.count + 63) / 64) {}

    void run(ListViewCost* costs) {
        for_each_bit(in_.view_bits, [&](unsigned v) {
            RowView& asked = asked_[asked_count_];
            asked.planes = row_planes(in_.views[v], *in_.chunk);
            if (asked.planes.outside) return;
            asked.view = v;
            asked.bit = 1u << v;
            asked.layer_mask = in_.views[v].layer_mask;
            if (asked.planes.planes != 0)
                ++asked_count_;
            else
                whole_[whole_count_++] = {asked.bit, asked.layer_mask};
        });
        for (std::size_t w = 0; w < words_; ++w) {
            alignas(64) std::uint32_t last[64];
            const std::size_t left = in_.count - 64 * w;
            if (left >= 64) {
                test_rows(w, masks_ + 64 * w, in_.layers ? in_.layers + 64 * w : nullptr);
                continue;
            }
            alignas(64) std::uint32_t layers[64] = {};
            if (in_.layers) std::copy_n(in_.layers + 64 * w, left, layers);
            test_rows(w, last, in_.layers ? layers : nullptr);
            std::copy_n(last, left, masks_ + 64 * w);
            for (std::size_t n = 0; n < asked_count_; ++n) asked_[n].open[w] &= ~std::uint64_t{0} >> (64 - left);
        }
        for (std::size_t n = 0; n < asked_count_; ++n) ask_records(asked_[n], costs[asked_[n].view]);
    }

  private:
    struct Whole {
        std::uint32_t bit, layer_mask;
    };

    static HWY_INLINE VU in_layers(VU layers, std::uint32_t mask, VU bit) {
        const DU du;
        return hn::IfThenElseZero(hn::Ne(hn::And(layers, hn::Set(du, mask)), hn::Zero(du)), bit);
    }

    HWY_INLINE void test_rows(std::size_t w, std::uint32_t* masks, const std::uint32_t* layers) {
        const DU du;
        for (std::size_t n = 0; n < asked_count_; ++n) asked_[n].open[w] = 0;
        for (std::size_t l = 0; l < 16; l += hn::Lanes(du)) {
            const RowLanes rows(in_.rows + 4 * w, l);
            VU seen[4] = {hn::Zero(du), hn::Zero(du), hn::Zero(du), hn::Zero(du)};
            const auto add = [&](std::size_t b, VU bits, std::uint32_t layer_mask) HWY_ATTR {
                if (layers) bits = in_layers(hn::LoadU(du, layers + 16 * b + l), layer_mask, bits);
                seen[b] = hn::Or(seen[b], bits);
            };
            for (std::size_t n = 0; n < whole_count_; ++n)
                for (std::size_t b = 0; b < 4; ++b) add(b, hn::Set(du, whole_[n].bit), whole_[n].layer_mask);
            for (std::size_t n = 0; n < asked_count_; ++n) {
                RowView& asked = asked_[n];
                const VU bit = hn::Set(du, asked.bit);
                if (HWY_UNLIKELY(asked.planes.useless)) {
                    asked.open[w] = ~std::uint64_t{0};
                    for (std::size_t b = 0; b < 4; ++b) add(b, bit, asked.layer_mask);
                    continue;
                }
                RowTest test(rows, asked.planes);
                for (std::size_t b = 0; b < 4; ++b) {
                    add(b, hn::IfThenZeroElse(hn::RebindMask(du, test.outside[b]), bit), asked.layer_mask);
                    test.inside[b] = hn::Or(test.inside[b], test.outside[b]);
                }
                asked.open[w] |= ~bits_of_blocks(test.inside, l) & lanes_from(l);
            }
            for (std::size_t b = 0; b < 4; ++b) hn::StoreU(seen[b], du, masks + 16 * b + l);
        }
    }

    // The bits that lanes l on have in a word.
    static HWY_INLINE std::uint64_t lanes_from(std::size_t l) {
        const std::uint64_t lanes = ((std::uint64_t{1} << hn::Lanes(DU())) - 1) << l;
        return lanes * 0x0001000100010001u;
    }

    struct Sink {
        const ListViewsInput<Record>& in;
        std::uint32_t* masks;
        std::uint32_t view, bit;

        HWY_INLINE void outside(std::uint32_t i) { masks[i] &= ~bit; }
        HWY_INLINE void inside(std::uint32_t) {}
        HWY_INLINE void undecided(std::uint32_t i) {
            if (!in.decide(in.context, i, view)) masks[i] &= ~bit;
        }
    };

    void ask_records(const RowView& asked, ListViewCost& cost) {
        std::uint32_t indices[kChunk + 16], unsettled[kChunk + 16];
        const std::size_t count = list_sparse_bits(asked.open, words_, indices);
        Sink sink{in_, masks_, asked.view, asked.bit};
        OpenRecords<Record, Sink> records(in_.views[asked.view], *in_.chunk, in_.records, asked.planes.planes,
                                          in_.exact, sink);
        const OpenCounts counts = records.test(indices, count, unsettled);
        cost.settled += counts.settled;
        cost.improper += counts.improper;
        cost.straddling += counts.straddling;
        cost.undecided += counts.undecided;
    }

    const ListViewsInput<Record>& in_;
    std::uint32_t* masks_;
    std::size_t words_;
    RowView asked_[kMaxListViews];
    Whole whole_[kMaxListViews];
    std::size_t asked_count_ = 0, whole_count_ = 0;
};

void RunBoxes(const ListViewsInput<BoxRecord>& input, std::uint32_t* masks, ListViewCost* costs) {
    ChunkViews<BoxRecord>(input, masks).run(costs);
}
void RunAabbs(const ListViewsInput<AabbRecord>& input, std::uint32_t* masks, ListViewCost* costs) {
    ChunkViews<AabbRecord>(input, masks).run(costs);
}
void RunSpheres(const ListViewsInput<SphereRecord>& input, std::uint32_t* masks, ListViewCost* costs) {
    ChunkViews<SphereRecord>(input, masks).run(costs);
}

}  // namespace
}  // namespace crofton::cull::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::cull {

HWY_EXPORT(RunBoxes);
HWY_EXPORT(RunAabbs);
HWY_EXPORT(RunSpheres);

void run_list_views_kernel(const ListViewsInput<BoxRecord>& input, std::uint32_t* masks, ListViewCost* costs) {
    HWY_DYNAMIC_DISPATCH(RunBoxes)(input, masks, costs);
}
void run_list_views_kernel(const ListViewsInput<AabbRecord>& input, std::uint32_t* masks, ListViewCost* costs) {
    HWY_DYNAMIC_DISPATCH(RunAabbs)(input, masks, costs);
}
void run_list_views_kernel(const ListViewsInput<SphereRecord>& input, std::uint32_t* masks, ListViewCost* costs) {
    HWY_DYNAMIC_DISPATCH(RunSpheres)(input, masks, costs);
}

}  // namespace crofton::cull
#endif
