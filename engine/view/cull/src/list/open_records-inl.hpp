// SPDX-License-Identifier: MIT
// Decides by records what a chunk's rows leave open. Compiled once per instruction set (Highway).
#include <hwy/cache_control.h>
#include <algorithm>
#include <crofton/cull/list_layout.hpp>
#include <crofton/simd/deposit_bits-inl.hpp>
#include <type_traits>

#include "list/list_lanes-inl.hpp"
#include "list/own_planes-inl.hpp"

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
    std::uint32_t inside = 0, straddling = 0, needs_edge_test = 0, undecided = 0, false_positives = 0;

    HWY_INLINE void add(const BoxTest& test, std::size_t shift) {
        inside |= bits_of(test.inside) << shift;
        straddling |= bits_of(test.straddling) << shift;
        needs_edge_test |= bits_of(test.needs_edge_test) << shift;
        undecided |= bits_of(test.undecided) << shift;
        false_positives |= bits_of(test.false_positives) << shift;
    }
};

template <class Record>
HWY_INLINE void prefetch_record(const Record* records, std::uint32_t i) {
    hwy::Prefetch(records + i);
}

// Verdicts of a chunk's bounds as bits, some of them open. What comes in of these, in their order, is put in its place
// by finish().
class OpenBits {
  public:
    HWY_INLINE void sixteen(std::size_t at, std::uint32_t outside, std::uint32_t inside) {
        const std::size_t w = at / 64;
        if (at % 64 == 0) outside_[w] = inside_[w] = outside_[w + 1] = inside_[w + 1] = 0;
        outside_[w] |= std::uint64_t{outside} << (at % 64);
        inside_[w] |= std::uint64_t{inside} << (at % 64);
    }

    HWY_INLINE void finish(const std::uint64_t* open, std::size_t words, std::uint64_t* visible,
                           std::uint64_t* inside) const {
        std::size_t at = 0;
        for (std::size_t w = 0; w < words; ++w) {
            visible[w] &= ~simd::deposit_bits(simd::bits_from(outside_, at), open[w]);
            inside[w] |= simd::deposit_bits(simd::bits_from(inside_, at), open[w]);
            at += hwy::PopCount(open[w]);
        }
    }

  private:
    std::uint64_t outside_[kChunk / 64 + 1], inside_[kChunk / 64 + 1];
};

// How many of the records went which way.
struct OpenCounts {
    std::size_t resolved = 0, straddling = 0, undecided = 0, false_positives = 0;
};

// The records ahead of those in work that are asked for.
inline constexpr std::size_t kRecordsAhead = 32;

// One view's questions. What the records know of up to sixteen bounds, consecutive ones of those asked about, goes to
// sink.sixteen(place of the first, their indices, bits outside, bits inside). What the second stage says of single ones
// goes to sink.outside(i) and sink.undecided(i). The others are certainly straddling.
template <class Record, class Sink, class Records = const Record*>
class OpenRecords {
  public:
    HWY_INLINE OpenRecords(const KernelView& view, const ListChunk& chunk, Records records, std::uint32_t planes,
                           bool exact, Sink& sink)
        : view_(view), records_(records), planes_(planes), exact_(exact), sink_(sink) {
        const LocalOrigin at = local_origin(view, chunk.origin, chunk.l1_radius);
        for_each_bit(planes, [&](unsigned i) { local_[i] = local_plane(view.planes[i], at); });
    }

    // Planes that contain all of the chunk's bounds are not asked about them. |normal| is up to 1.0005.
    HWY_INLINE void drop_planes_around(const ListChunk& chunk) {
        if (chunk.largest_radius == kUnboundedRadius) return;
        const double extent =
            1.001 * (static_cast<double>(chunk.l1_radius) + static_cast<double>(chunk.largest_radius) * chunk.quantum);
        for_each_bit(planes_, [&](unsigned i) {
            const auto least = static_cast<double>(local_[i].offset) - static_cast<double>(local_[i].error_bound);
            planes_ &= ~(std::uint32_t{least >= extent} << i);
        });
    }

    // Oriented boxes look the planes up that they cross. Others need so little arithmetic a plane that all are tested.
    static constexpr bool kOwnPlanes =
        !std::is_same_v<Record, SphereRecord> && !std::is_same_v<Record, AabbRecord> && PlaneTable::kEntries >= 8;

    // Tests each of `indices`, which needs room for 16 more. `needs_edge_test` is scratch with room for all and 16
    // more.
    HWY_INLINE OpenCounts test(std::uint32_t* indices, std::size_t count, std::uint32_t* needs_edge_test) {
        if constexpr (kOwnPlanes)
            if (PlaneTable::takes(planes_)) return test_own(indices, count, needs_edge_test);
        for_each_sixteen(indices, count, [&](std::size_t at, const auto& lanes, std::uint32_t valid) HWY_ATTR {
            const std::uint32_t* which = indices + at;
            const Sixteen test = lanes([&](const auto& bounds, std::size_t)
                                           HWY_ATTR { return test_boxes(view_, bounds, planes_, local_, exact_); });
            note(at, which, valid, test);
            for_each_bit(test.needs_edge_test, [&](unsigned i) { needs_edge_test[counts_.resolved++] = which[i]; });
        });
        return resolve(needs_edge_test, counts_.resolved);
    }

    // The second stage alone, of bounds that no plane certainly rejects and that are not certainly inside.
    HWY_INLINE OpenCounts resolve(std::uint32_t* indices, std::size_t count) {
        resolve_all(indices, count, [&](const auto& bounds, std::size_t) HWY_ATTR {
            BoxTest result;
            result.inside = result.straddling = result.undecided = result.false_positives = hn::FirstN(DF(), 0);
            result.needs_edge_test = bounds.present;
            HWY_NAMESPACE::resolve(view_, bounds, planes_, local_, result);
            return result;
        });
        return counts_;
    }

    // The same, where PlaneTable takes the planes. `cuts` are those that each box is not certainly inside of, as
    // PlaneBits, with room for 16 more.
    HWY_INLINE OpenCounts resolve(std::uint32_t* indices, std::size_t count, std::uint32_t* cuts) {
        return resolve_own(PlaneTable(view_, planes_, local_), indices, count, cuts);
    }

  private:
    // Boxes that cross several planes are listed with them, so that the second stage's lanes are full.
    OpenCounts test_own(std::uint32_t* indices, std::size_t count, std::uint32_t* needs_edge_test) {
        const DU du;
        const PlaneTable table(view_, planes_, local_);
        std::uint32_t cuts[kChunk + 32];
        for_each_sixteen(indices, count, [&](std::size_t at, const auto& lanes, std::uint32_t valid) HWY_ATTR {
            const std::uint32_t* which = indices + at;
            const Sixteen test = lanes([&](const auto& bounds, std::size_t l) HWY_ATTR {
                VU cut;
                const BoxTest result = test_all_planes(table, bounds, exact_, cut);
                const auto needed = hn::RebindMask(du, result.needs_edge_test);
                simd::compress_store(du, hn::LoadU(du, which + l), needed, needs_edge_test + counts_.resolved);
                counts_.resolved += simd::compress_store(du, cut, needed, cuts + counts_.resolved);
                return result;
            });
            note(at, which, valid, test);
        });
        return resolve_own(table, needs_edge_test, counts_.resolved, cuts);
    }

    HWY_INLINE OpenCounts resolve_own(const PlaneTable& table, std::uint32_t* indices, std::size_t count,
                                      std::uint32_t* cuts) {
        std::fill_n(cuts + count, 16, 0);
        resolve_all(indices, count, [&](const auto& bounds, std::size_t at) HWY_ATTR {
            return resolve_own_planes(table, bounds, hn::LoadU(DU(), cuts + at));
        });
        return counts_;
    }

    // Hands sixteen at a time to `visit`: the place of the first, a function that applies a test to their lanes and the
    // place of the first of these, and a bit for each that there is.
    template <class Visit>
    HWY_INLINE void for_each_sixteen(std::uint32_t* indices, std::size_t count, const Visit& visit) {
        if (count == 0) return;
        std::fill_n(indices + count, 16, indices[count - 1]);  // for lanes beyond the last
        for (std::size_t at = 0; at < count; at += 16) {
            for (std::size_t i = at + kRecordsAhead; i < std::min(count, at + kRecordsAhead + 16); ++i)
                prefetch_record(records_, indices[i]);
            const std::size_t size = std::min<std::size_t>(16, count - at);
            visit(
                at,
                [&](const auto& test) HWY_ATTR {
                    Sixteen result;
                    for (std::size_t l = 0; l < size; l += hn::Lanes(DF()))
                        result.add(test(lanes_of(Picked<Records>{records_, indices + at + l}, size - l), l), l);
                    return result;
                },
                static_cast<std::uint32_t>((std::uint64_t{1} << size) - 1));
        }
    }

    HWY_INLINE void note(std::size_t at, const std::uint32_t* which, std::uint32_t valid, const Sixteen& test) {
        const std::uint32_t kept = test.inside | test.straddling | test.needs_edge_test | test.undecided;
        sink_.sixteen(at, which, valid & ~kept, test.inside);
        count_rest(test, which);
    }

    HWY_INLINE void count_rest(const Sixteen& test, const std::uint32_t* which) {
        for_each_bit(test.undecided, [&](unsigned i) { sink_.undecided(which[i]); });
        counts_.straddling += hwy::PopCount(test.straddling);
        counts_.undecided += hwy::PopCount(test.undecided);
        counts_.false_positives += hwy::PopCount(test.false_positives);
    }

    template <class Test>
    HWY_INLINE void resolve_all(std::uint32_t* needs_edge_test, std::size_t count, const Test& resolved) {
        for_each_sixteen(needs_edge_test, count, [&](std::size_t at, const auto& lanes, std::uint32_t valid) HWY_ATTR {
            const Sixteen test =
                lanes([&](const auto& bounds, std::size_t l) HWY_ATTR { return resolved(bounds, at + l); });
            const std::uint32_t* which = needs_edge_test + at;
            for_each_bit(valid & ~(test.straddling | test.undecided), [&](unsigned i) { sink_.outside(which[i]); });
            count_rest(test, which);
        });
    }

    const KernelView& view_;
    Records records_;  // records_[i] is bound i's
    std::uint32_t planes_;
    bool exact_;
    Sink& sink_;
    LocalPlane local_[KernelView::kMaxPlanes];
    OpenCounts counts_;
};

}  // namespace crofton::cull::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
