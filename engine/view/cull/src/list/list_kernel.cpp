// SPDX-License-Identifier: MIT
#include "list/list_kernel.hpp"

#include <algorithm>
#include <crofton/cull/classify.hpp>

// Also compile for AVX-512 VNNI (`vpdpwssd`).
#define HWY_WANT_AVX3_DL 1
// clang-format off
#include <hwy/foreach_target.h>
// clang-format on
#include <hwy/highway.h>

#include "list/open_records-inl.hpp"
#include "list/row_tests-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::cull::HWY_NAMESPACE {
namespace {

// One chunk against one view: rows first, then the records of what they leave open.
template <class Record>
class ChunkQuery {
  public:
    ChunkQuery(const ListKernelInput<Record>& input, ListKernelOutput& output)
        : in_(input), out_(output), words_((input.count + 63) / 64) {
        if (!is_few()) set_row_planes(*input.view, *input.chunk, rows_);
    }

    void run() {
        out_.undecided_count = out_.resolved_count = 0;
        out_.false_positives = out_.open = 0;
        const std::uint64_t last = ~std::uint64_t{0} >> (64 * words_ - in_.count);
        if (is_few()) return test_few(last);
        if (rows_.outside || rows_.planes == 0) {
            std::fill_n(out_.visible, words_, rows_.outside ? 0 : ~std::uint64_t{0});
            std::fill_n(out_.inside, words_, rows_.outside ? 0 : ~std::uint64_t{0});
            out_.visible[words_ - 1] &= last;
            out_.inside[words_ - 1] &= last;
            return;
        }
        std::uint64_t open[kChunk / 64];
        for (std::size_t w = 0; w < words_; ++w) {
            std::uint64_t outside = 0, inside = 0;
            for (std::size_t l = 0; l < 16 && !rows_.useless; l += hn::Lanes(DI())) {
                const RowTest test(RowLanes(in_.rows + 4 * w, l), rows_);
                outside |= bits_of_blocks(test.outside, l);
                inside |= bits_of_blocks(test.inside, l);
            }
            const std::uint64_t valid = w + 1 == words_ ? last : ~std::uint64_t{0};
            out_.visible[w] = ~outside & valid;
            out_.inside[w] = inside & valid;
            open[w] = ~(outside | inside) & valid;
        }
        std::uint32_t indices[kChunk + 16], needs_edge_test[kChunk + 16];
        const std::size_t count = list_sparse_bits(open, words_, indices);
        OpenRecords<Record, ChunkQuery> records(*in_.view, *in_.chunk, in_.records, rows_.planes, in_.exact, *this);
        const OpenCounts counts = records.test(indices, count, needs_edge_test);
        if (count > 0) bits_.finish(open, words_, out_.visible, out_.inside);
        count_open(counts);
    }

    HWY_INLINE void outside(std::uint32_t i) { out_.visible[i / 64] &= ~bit(i); }
    HWY_INLINE void sixteen(std::size_t at, const std::uint32_t*, std::uint32_t outside_bits,
                            std::uint32_t inside_bits) {
        bits_.sixteen(at, outside_bits, inside_bits);
    }
    HWY_INLINE void undecided(std::uint32_t i) { out_.undecided[out_.undecided_count++] = i; }

  private:
    static HWY_INLINE std::uint64_t bit(std::uint32_t i) { return std::uint64_t{1} << (i % 64); }

    // Most of so few bounds are near the view's surface. Rows would decide few, for the cost of planes in their units.
    [[nodiscard]] HWY_INLINE bool is_few() const { return in_.count <= kFew; }

    HWY_INLINE void test_few(std::uint64_t present) {
        std::uint32_t indices[kFew + 16], needs_edge_test[kFew + 16];
        for (std::uint32_t i = 0; i < kFew; i += static_cast<std::uint32_t>(hn::Lanes(DU())))
            hn::StoreU(hn::Iota(DU(), i), DU(), indices + i);
        out_.visible[0] = present;
        out_.inside[0] = 0;
        OpenRecords<Record, ChunkQuery> records(*in_.view, *in_.chunk, in_.records, (1u << in_.view->plane_count) - 1,
                                                in_.exact, *this);
        records.drop_planes_around(*in_.chunk);
        const OpenCounts counts = records.test(indices, in_.count, needs_edge_test);
        bits_.finish(&present, 1, out_.visible, out_.inside);
        count_open(counts);
    }

    HWY_INLINE void count_open(const OpenCounts& counts) {
        out_.resolved_count = counts.resolved;
        out_.false_positives = counts.false_positives;
        out_.open = counts.straddling + counts.undecided;
    }

    static constexpr std::size_t kFew = 64;

    const ListKernelInput<Record>& in_;
    ListKernelOutput& out_;
    std::size_t words_;
    RowPlanes rows_;
    OpenBits bits_;
};

void run_boxes(const ListKernelInput<BoxRecord>& input, ListKernelOutput& output) {
    ChunkQuery<BoxRecord>(input, output).run();
}
void run_aabbs(const ListKernelInput<AabbRecord>& input, ListKernelOutput& output) {
    ChunkQuery<AabbRecord>(input, output).run();
}
void run_spheres(const ListKernelInput<SphereRecord>& input, ListKernelOutput& output) {
    ChunkQuery<SphereRecord>(input, output).run();
}

}  // namespace
}  // namespace crofton::cull::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::cull {

HWY_EXPORT(run_boxes);
HWY_EXPORT(run_aabbs);
HWY_EXPORT(run_spheres);

void run_list_kernel(const ListKernelInput<BoxRecord>& input, ListKernelOutput& output) {
    HWY_DYNAMIC_DISPATCH(run_boxes)(input, output);
}
void run_list_kernel(const ListKernelInput<AabbRecord>& input, ListKernelOutput& output) {
    HWY_DYNAMIC_DISPATCH(run_aabbs)(input, output);
}
void run_list_kernel(const ListKernelInput<SphereRecord>& input, ListKernelOutput& output) {
    HWY_DYNAMIC_DISPATCH(run_spheres)(input, output);
}

}  // namespace crofton::cull
#endif
