// SPDX-License-Identifier: MIT
// What a chunk's rows leave open, asked of the records. Compiled once per instruction set (Highway).
#include <algorithm>
#include <crofton/cull/list_layout.hpp>

#include "list/list_lanes-inl.hpp"

#if defined(CROFTON_CULL_OPEN_RECORDS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_CULL_OPEN_RECORDS_INL
#undef CROFTON_CULL_OPEN_RECORDS_INL
#else
#define CROFTON_CULL_OPEN_RECORDS_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace crofton::cull::HWY_NAMESPACE {

// Verdicts of up to 16 bounds, a bit each.
struct Sixteen {
    std::uint32_t inside = 0, straddling = 0, needs_edge_test = 0, undecided = 0, improper = 0;

    HWY_INLINE void add(const BoxTest& test, std::size_t shift) {
        inside |= bits_of(test.inside) << shift;
        straddling |= bits_of(test.straddling) << shift;
        needs_edge_test |= bits_of(test.needs_edge_test) << shift;
        undecided |= bits_of(test.undecided) << shift;
        improper |= bits_of(test.improper) << shift;
    }
};

template <class Visit>
HWY_INLINE void for_each_bit(std::uint32_t bits, const Visit& visit) {
    for (; bits; bits &= bits - 1) visit(static_cast<unsigned>(hwy::Num0BitsBelowLS1Bit_Nonzero32(bits)));
}

// How many of the records went which way.
struct OpenCounts {
    std::size_t resolved = 0, straddling = 0, undecided = 0, improper = 0;
};

// One view's questions. Tells `sink` by outside(i), inside(i) and undecided(i) what the records know; the others are
// certainly straddling.
template <class Record, class Sink, class Records = const Record*>
class OpenRecords {
  public:
    HWY_INLINE OpenRecords(const KernelView& view, const ListChunk& chunk, Records records, std::uint32_t planes,
                           bool exact, Sink& sink)
        : view_(view), records_(records), planes_(planes), exact_(exact), sink_(sink) {
        const LocalOrigin at = local_origin(view, chunk.origin, chunk.reach);
        for_each_bit(planes, [&](unsigned i) { local_[i] = local_plane(view.planes[i], at); });
    }

    // `needs_edge_test` is for its own use and has room for all.
    HWY_INLINE OpenCounts test(const std::uint32_t* indices, std::size_t count, std::uint32_t* needs_edge_test) {
        for_each_sixteen(indices, count, [&](const auto& lanes, const std::uint32_t* which) {
            const Sixteen test =
                lanes([&](const auto& boxes) HWY_ATTR { return test_boxes(view_, boxes, planes_, local_, exact_); });
            for_each_bit(test.needs_edge_test, [&](unsigned i) { needs_edge_test[counts_.resolved++] = which[i]; });
            apply(test, which);
        });
        resolve_all(needs_edge_test, counts_.resolved);
        return counts_;
    }

  private:
    // Hands sixteen at a time to `visit`: their indices, and a function that applies a test to their lanes.
    template <class Visit>
    HWY_INLINE void for_each_sixteen(const std::uint32_t* indices, std::size_t count, const Visit& visit) {
        Batch<Record> batch;
        for (std::size_t begin = 0; begin < count; begin += kBatch) {
            const std::size_t size = std::min(kBatch, count - begin);
            for (std::size_t i = 0; i < size; ++i) batch.copy(i, records_[indices[begin + i]]);
            for (std::size_t at = 0; at < size; at += 16) {
                valid_ = size - at >= 16 ? 0xffffu : (1u << (size - at)) - 1;
                visit(
                    [&](const auto& test) HWY_ATTR {
                        Sixteen result;
                        for (std::size_t l = 0; l < 16 && at + l < size; l += hn::Lanes(DF()))
                            result.add(test(lanes_of(batch, at + l, size - at - l)), l);
                        return result;
                    },
                    indices + begin + at);
            }
        }
    }

    HWY_INLINE void apply(const Sixteen& test, const std::uint32_t* which) {
        const std::uint32_t kept = test.inside | test.straddling | test.needs_edge_test | test.undecided;
        for_each_bit(valid_ & ~kept, [&](unsigned i) { sink_.outside(which[i]); });
        for_each_bit(test.inside, [&](unsigned i) { sink_.inside(which[i]); });
        for_each_bit(test.undecided, [&](unsigned i) { sink_.undecided(which[i]); });
        counts_.straddling += hwy::PopCount(test.straddling);
        counts_.undecided += hwy::PopCount(test.undecided);
        counts_.improper += hwy::PopCount(test.improper);
    }

    HWY_INLINE void resolve_all(const std::uint32_t* needs_edge_test, std::size_t count) {
        for_each_sixteen(needs_edge_test, count, [&](const auto& lanes, const std::uint32_t* which) {
            Sixteen test = lanes([&](const auto& bounds) HWY_ATTR {
                BoxTest result;
                result.inside = result.straddling = result.undecided = result.improper = hn::FirstN(DF(), 0);
                result.needs_edge_test = bounds.present;
                resolve(view_, bounds, planes_, local_, result);
                return result;
            });
            test.needs_edge_test = 0;
            apply(test, which);
        });
    }

    const KernelView& view_;
    Records records_;  // records_[i] is bound i's
    std::uint32_t planes_;
    bool exact_;
    Sink& sink_;
    LocalPlane local_[KernelView::kMaxPlanes];
    std::uint32_t valid_ = 0;
    OpenCounts counts_;
};

}  // namespace crofton::cull::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
