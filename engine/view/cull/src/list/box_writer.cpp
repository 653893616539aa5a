// SPDX-License-Identifier: MIT
#include "list/box_writer.hpp"

#include <hwy/cache_control.h>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

// clang-format off
#include <hwy/foreach_target.h>
// clang-format on
#include <hwy/highway.h>

#include "lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::cull::HWY_NAMESPACE {
namespace {

constexpr std::size_t kSixteen = boxtree::kWidth;
using DD = hn::CappedTag<double, kSixteen>;

// The numbers of an Obb, in its order: a centre, three axes, three half extents.
constexpr std::size_t kBoxBytes = sizeof(Obb), kShapeBytes = 24;

// Boxes whose centre, or whose chunk's origin, is beyond this are rejected. So all centres here are below 1e30.
constexpr double kFarthest = 4e29;

// NaN if it is too far for any box.
HWY_INLINE double origin_of(const ListChunk& chunk, std::size_t j) {
    const bool far = !(std::abs(chunk.origin[j]) <= kFarthest);
    return far ? std::numeric_limits<double>::quiet_NaN() : chunk.origin[j];
}
HWY_INLINE float per_quantum_of(const ListChunk& chunk) {
    return static_cast<float>(1.0 / chunk.quantum);  // exact, a power of two
}

// Sixteen boxes side by side, and the frames that they are to be written in.
struct Boxes {
    alignas(64) double center[3][kSixteen];
    alignas(64) float shape[3][kSixteen][4];  // nine axes' components, three half extents: loaded interleaved
    alignas(64) double origin[3][kSixteen];
    alignas(64) float per_quantum[kSixteen];

    HWY_INLINE void put_center(std::size_t lane, const unsigned char* box) {
        for (std::size_t j = 0; j < 3; ++j) std::memcpy(&center[j][lane], box + 8 * j, 8);
    }
    HWY_INLINE void put_shape(std::size_t lane, const unsigned char* box) {
        for (std::size_t q = 0; q < 3; ++q) std::memcpy(shape[q][lane], box + kShapeBytes + 16 * q, 16);
    }
    HWY_INLINE void put(std::size_t lane, const unsigned char* box) {
        put_center(lane, box);
        put_shape(lane, box);
    }
    HWY_INLINE void put_frame(std::size_t lane, const ListChunk& chunk) {
        for (std::size_t j = 0; j < 3; ++j) origin[j][lane] = origin_of(chunk, j);
        per_quantum[lane] = per_quantum_of(chunk);
    }
    HWY_INLINE void put_frame(const ListChunk& chunk) {  // of all lanes
        put_frame(0, chunk);
        for (std::size_t j = 0; j < 3; ++j) std::fill_n(origin[j] + 1, kSixteen - 1, origin[j][0]);
        std::fill_n(per_quantum + 1, kSixteen - 1, per_quantum[0]);
    }
};

// Sixteen boxes as rows and records. Coordinates and radius are in quanta. An empty row has coordinates 0 and the
// radius kUnboundedRadius.
struct Written {
    alignas(64) float offset[3][kSixteen];
    alignas(64) std::int32_t at[3][kSixteen];
    alignas(64) std::uint32_t xy[kSixteen];
    alignas(64) std::uint32_t zr[kSixteen];
    alignas(64) std::uint32_t radius[kSixteen];
    alignas(64) float l1_radius[kSixteen];
    alignas(64) std::uint32_t record[2][kSixteen][4];
    std::uint32_t usable = 0, bounded = 0;  // a bit a lane

    HWY_INLINE void copy_record(std::size_t lane, BoxRecord& to) const {
        for (std::size_t q = 0; q < 2; ++q)
            std::memcpy(reinterpret_cast<unsigned char*>(&to) + 16 * q, record[q][lane], 16);
    }
    HWY_INLINE void grow(std::size_t lane, ListChunk& chunk) const {
        for (std::size_t j = 0; j < 3; ++j) chunk.extent[j] = std::max(chunk.extent[j], std::abs(at[j][lane]));
        chunk.largest_radius = std::max(chunk.largest_radius, radius[lane]);
        chunk.l1_radius = std::max(chunk.l1_radius, l1_radius[lane]);
    }
};

HWY_INLINE void write_offsets(const Boxes& boxes, Written& to) {
    const DD d;
    const hn::Rebind<float, DD> df;
    for (std::size_t l = 0; l < kSixteen; l += hn::Lanes(d))
        for (std::size_t j = 0; j < 3; ++j) {
            const auto offset = hn::Sub(hn::Load(d, boxes.center[j] + l), hn::Load(d, boxes.origin[j] + l));
            hn::Store(hn::DemoteTo(df, offset), df, to.offset[j] + l);
        }
}

HWY_INLINE VU pairs_of(VI lower, VI upper) {
    const VI low = hn::And(lower, hn::Set(DI(), 0xffff));
    return hn::BitCast(DU(), hn::Or(low, hn::ShiftLeft<16>(upper)));
}

// How far the axes are from orthonormal, Σ |axes[i] · axes[k] − δik|, within 30 · 2^-24; NaN if a component is.
HWY_INLINE VF deviation(const VF (&axes)[9]) {
    const DF d;
    VF sum = hn::Zero(d);
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t k = i; k < 3; ++k) {
            VF dot = hn::Mul(axes[3 * i], axes[3 * k]);
            for (std::size_t j = 1; j < 3; ++j) dot = hn::Add(dot, hn::Mul(axes[3 * i + j], axes[3 * k + j]));
            sum = hn::Add(sum, hn::Abs(i == k ? hn::Sub(dot, hn::Set(d, 1.0f)) : dot));
        }
    return sum;
}

// A box is taken if it certainly passes validate(Obb): its axes are orthonormal to 1e-4 even summed, no half extent is
// negative, none beyond 1e18, the centre below 1e30. With half extents h the farthest corner is within
// Σ h² · 1.0001 + 2 · 1e-4 · Σ h_i h_k ≤ 1.0003 · Σ h², squared. 1.0002 · √Σ h² covers that and the roundings; what
// underflows is far below 1e-15. So no edge has more than 32766 units, each within 3 · 2^-24 · 32767 + 1/2.
HWY_INLINE void write(const Boxes& boxes, Written& to) {
    const DF d;
    const DI di;
    const DU du;
    write_offsets(boxes, to);
    to.usable = to.bounded = 0;
    for (std::size_t l = 0; l < kSixteen; l += hn::Lanes(d)) {
        VF axes[9], half[3];
        hn::LoadInterleaved4(d, boxes.shape[0][l], axes[0], axes[1], axes[2], axes[3]);
        hn::LoadInterleaved4(d, boxes.shape[1][l], axes[4], axes[5], axes[6], axes[7]);
        hn::LoadInterleaved4(d, boxes.shape[2][l], axes[8], half[0], half[1], half[2]);
        const VF square =
            hn::Add(hn::Add(hn::Mul(half[0], half[0]), hn::Mul(half[1], half[1])), hn::Mul(half[2], half[2]));
        const VF radius = hn::Add(hn::Mul(hn::Sqrt(square), hn::Set(d, 1.0002f)), hn::Set(d, 1e-15f));
        const VF offset[3] = {hn::Load(d, to.offset[0] + l), hn::Load(d, to.offset[1] + l),
                              hn::Load(d, to.offset[2] + l)};
        const VF sum = hn::Add(hn::Add(hn::Abs(offset[0]), hn::Abs(offset[1])), hn::Abs(offset[2]));
        const VF l1_radius = hn::Mul(sum, hn::Set(d, 1.0f + 0x1p-20f));
        const auto usable =
            hn::And(hn::And(hn::Le(deviation(axes), hn::Set(d, 0.99e-4f)), hn::Le(square, hn::Set(d, 1e36f))),
                    hn::And(hn::Ge(hn::Min(hn::Min(half[0], half[1]), half[2]), hn::Zero(d)),
                            hn::Le(l1_radius, hn::Set(d, static_cast<float>(kFarthest)))));

        const VF per_quantum = hn::Load(d, boxes.per_quantum + l);
        const VF at[3] = {hn::Mul(offset[0], per_quantum), hn::Mul(offset[1], per_quantum),
                          hn::Mul(offset[2], per_quantum)};
        const VF farthest = hn::Max(hn::Max(hn::Abs(at[0]), hn::Abs(at[1])), hn::Abs(at[2]));
        const VF size = hn::Mul(radius, hn::Mul(per_quantum, hn::Set(d, 1.0f + 0x1p-9f + 0x1p-18f)));
        const auto bounded =
            hn::And(usable, hn::And(hn::Le(farthest, hn::Set(d, static_cast<float>(kMaxRowCoordinate))),
                                    hn::Le(size, hn::Set(d, 65530.0f))));
        VI whole[3];
        for (std::size_t j = 0; j < 3; ++j) {
            whole[j] = hn::NearestInt(hn::IfThenElseZero(bounded, at[j]));
            hn::Store(whole[j], di, to.at[j] + l);
        }
        const VI shown = hn::IfThenElse(hn::RebindMask(di, bounded),
                                        hn::Add(hn::ConvertTo(di, hn::IfThenElseZero(bounded, size)), hn::Set(di, 2)),
                                        hn::Set(di, std::int32_t{kUnboundedRadius}));
        hn::Store(pairs_of(whole[0], whole[1]), du, to.xy + l);
        hn::Store(pairs_of(whole[2], shown), du, to.zr + l);
        hn::Store(hn::BitCast(du, shown), du, to.radius + l);
        hn::Store(hn::IfThenElseZero(usable, l1_radius), d, to.l1_radius + l);

        const VU upper = hn::And(hn::Add(hn::BitCast(du, radius), hn::Set(du, 0xffffu)), hn::Set(du, 0xffff0000u));
        const VF per_unit = hn::Div(hn::Set(d, 0x1p15f), hn::BitCast(d, upper));
        VI units[9];
        for (std::size_t k = 0; k < 3; ++k) {
            const VF scale = hn::Mul(half[k], per_unit);
            for (std::size_t j = 0; j < 3; ++j) units[3 * k + j] = hn::NearestInt(hn::Mul(axes[3 * k + j], scale));
        }
        const VU first = hn::Or(hn::ShiftRight<16>(upper), hn::ShiftLeft<16>(hn::BitCast(du, units[0])));
        hn::StoreInterleaved4(hn::BitCast(du, offset[0]), hn::BitCast(du, offset[1]), hn::BitCast(du, offset[2]), first,
                              du, to.record[0][l]);
        hn::StoreInterleaved4(pairs_of(units[1], units[2]), pairs_of(units[3], units[4]), pairs_of(units[5], units[6]),
                              pairs_of(units[7], units[8]), du, to.record[1][l]);
        to.usable |= bits_of(usable) << l;
        to.bounded |= bits_of(bounded) << l;
    }
}

using DW = hn::CappedTag<std::uint64_t, 4>;
constexpr std::size_t kBoxWords = kBoxBytes / 8, kCenterWords = kShapeBytes / 8;

// Whether two boxes differ, bit for bit. Adds to `of_shapes` in which bits their axes and half extents do.
HWY_INLINE bool differ(const unsigned char* a, const unsigned char* b, hn::Vec<DW>& of_shapes) {
    static constexpr std::uint64_t kOfShape[2 * kCenterWords] = {0, 0, 0, ~0ull, ~0ull, ~0ull};
    const DW d;
    const auto load = [&](const unsigned char* from)
                          HWY_ATTR { return hn::LoadU(d, reinterpret_cast<const std::uint64_t*>(from)); };
    auto any = hn::Zero(d);
    for (std::size_t word = 0; word < kBoxWords; word += hn::Lanes(d)) {
        const std::size_t at = std::min(word, kBoxWords - hn::Lanes(d));
        const auto differing = hn::Xor(load(a + 8 * at), load(b + 8 * at));
        any = hn::Or(any, differing);
        of_shapes = hn::Or(of_shapes, at >= kCenterWords ? differing : hn::And(differing, hn::LoadU(d, kOfShape + at)));
    }
    return !hn::AllTrue(d, hn::Eq(any, hn::Zero(d)));
}

// Sixteen boxes beside those before: which differ, whether all have the same shapes, and centres from the origin.
struct Moved {
    alignas(64) float offset[kSixteen][4];  // loaded interleaved
    std::uint8_t differs[kSixteen];
    bool same_shapes;

    HWY_INLINE void compare(const unsigned char* boxes, std::size_t stride, const unsigned char* before) {
        auto of_shapes = hn::Zero(DW());
        for (std::size_t lane = 0; lane < kSixteen; ++lane)
            differs[lane] = differ(boxes + stride * lane, before + kBoxBytes * lane, of_shapes) ? 1 : 0;
        same_shapes = hn::AllTrue(DW(), hn::Eq(of_shapes, hn::Zero(DW())));
    }
    HWY_INLINE void put_offset(std::size_t lane, const unsigned char* box, const double (&origin)[4]) {
        const hn::CappedTag<double, 4> d;
        if (hn::Lanes(d) == 4) {
            const auto center =
                hn::IfThenElseZero(hn::FirstN(d, 3), hn::LoadU(d, reinterpret_cast<const double*>(box)));
            const hn::Rebind<float, decltype(d)> df;
            hn::Store(hn::DemoteTo(df, hn::Sub(center, hn::LoadU(d, origin))), df, offset[lane]);
            return;
        }
        double center[3];
        std::memcpy(center, box, sizeof center);
        for (std::size_t j = 0; j < 3; ++j) offset[lane][j] = static_cast<float>(center[j] - origin[j]);
    }
};

// As write(), of boxes with the shapes that the block of rows was written for, but for what shapes alone decide. False,
// and nothing is written but `to`, if one of the old rows is empty, or one of the new is to be.
HWY_INLINE bool write_moved(const Moved& moved, float per_quantum, const RowBlock& block, Written& to) {
    const DF d;
    const DI di;
    const DU du;
    bool good = true;
    for (std::size_t l = 0; l < kSixteen; l += hn::Lanes(d)) {
        VF offset[3], unused;
        hn::LoadInterleaved4(d, moved.offset[l], offset[0], offset[1], offset[2], unused);
        const VF sum = hn::Add(hn::Add(hn::Abs(offset[0]), hn::Abs(offset[1])), hn::Abs(offset[2]));
        const VF l1_radius = hn::Mul(sum, hn::Set(d, 1.0f + 0x1p-20f));
        const VU zr = hn::LoadU(du, block.zr + l), radius = hn::ShiftRight<16>(zr);
        auto bounded = hn::And(hn::Le(l1_radius, hn::Set(d, static_cast<float>(kFarthest))),
                               hn::RebindMask(d, hn::Ne(radius, hn::Set(du, kUnboundedRadius))));
        VI whole[3];
        for (std::size_t j = 0; j < 3; ++j) {
            const VF at = hn::Mul(offset[j], hn::Set(d, per_quantum));
            bounded = hn::And(bounded, hn::Le(hn::Abs(at), hn::Set(d, static_cast<float>(kMaxRowCoordinate))));
            whole[j] = hn::NearestInt(at);
            hn::Store(whole[j], di, to.at[j] + l);
        }
        hn::Store(pairs_of(whole[0], whole[1]), du, to.xy + l);
        hn::Store(pairs_of(whole[2], hn::BitCast(di, radius)), du, to.zr + l);
        hn::Store(radius, du, to.radius + l);
        hn::Store(l1_radius, d, to.l1_radius + l);
        good = good && hn::AllTrue(d, bounded);
    }
    return good;
}

// The largest of sixteen numbers.
template <class D>
HWY_INLINE hn::TFromD<D> largest(D d, const hn::TFromD<D>* numbers) {
    auto result = hn::Load(d, numbers);
    for (std::size_t l = hn::Lanes(d); l < kSixteen; l += hn::Lanes(d))
        result = hn::Max(result, hn::Load(d, numbers + l));
    return hn::GetLane(hn::MaxOfLanes(d, result));
}

// The largest of a chunk's rows and records, lane by lane.
struct Extremes {
    alignas(64) std::int32_t at[3][kSixteen] = {};
    alignas(64) std::uint32_t radius[kSixteen] = {};
    alignas(64) float l1_radius[kSixteen] = {};

    HWY_INLINE void include(const Written& written) {
        for (std::size_t l = 0; l < kSixteen; l += hn::Lanes(DF())) {
            for (std::size_t j = 0; j < 3; ++j)
                hn::Store(hn::Max(hn::Load(DI(), at[j] + l), hn::Abs(hn::Load(DI(), written.at[j] + l))), DI(),
                          at[j] + l);
            hn::Store(hn::Max(hn::Load(DU(), radius + l), hn::Load(DU(), written.radius + l)), DU(), radius + l);
            hn::Store(hn::Max(hn::Load(DF(), l1_radius + l), hn::Load(DF(), written.l1_radius + l)), DF(),
                      l1_radius + l);
        }
    }
    HWY_INLINE void grow(ListChunk& chunk) const {
        for (std::size_t j = 0; j < 3; ++j) chunk.extent[j] = std::max(chunk.extent[j], largest(DI(), at[j]));
        chunk.largest_radius = std::max(chunk.largest_radius, largest(DU(), radius));
        chunk.l1_radius = std::max(chunk.l1_radius, largest(DF(), l1_radius));
    }
};

// The extremes of the blocks of one chunk after another.
struct ChunkExtremes {
    static constexpr std::size_t kNone = ~std::size_t{0};
    ListChunk* chunks;
    std::size_t chunk = kNone;
    Extremes extremes = {};

    HWY_INLINE void include(std::size_t of, const Written& written) {
        if (of != chunk) {
            flush();
            chunk = of;
        }
        extremes.include(written);
    }
    HWY_INLINE void flush() {
        if (chunk != kNone) extremes.grow(chunks[chunk]);
        extremes = {};
    }
};

std::size_t write_chunk(const unsigned char* all_boxes, std::size_t count, ListChunk& chunk, RowBlock* rows,
                        BoxRecord* records, std::uint32_t* rejected) {
    Boxes boxes[2];  // in turn: a wide load right after narrow stores to the same bytes stalls
    const auto put = [&](Boxes& to, std::size_t first) HWY_ATTR {
        for (std::size_t lane = 0; lane < kSixteen; ++lane)
            to.put(lane, all_boxes + kBoxBytes * std::min(first + lane, count - 1));
    };
    for (Boxes& to : boxes) to.put_frame(chunk);
    Extremes extremes;
    Written written;
    std::size_t rejected_count = 0, bounded = 0;
    if (count > 0) put(boxes[0], 0);
    for (std::size_t first = 0, turn = 0; first < count; first += kSixteen, turn ^= 1) {
        if (first + kSixteen < count) put(boxes[turn ^ 1], first + kSixteen);
        write(boxes[turn], written);
        extremes.include(written);
        RowBlock& block = rows[first / kSixteen];
        std::memcpy(block.xy, written.xy, sizeof block.xy);
        std::memcpy(block.zr, written.zr, sizeof block.zr);
        const std::size_t used = std::min(kSixteen, count - first);
        for (std::size_t lane = 0; lane < used; ++lane) written.copy_record(lane, records[first + lane]);
        const std::uint32_t valid = (1u << used) - 1;
        bounded += hwy::PopCount(std::uint64_t{written.bounded & valid});
        for (std::uint32_t rest = ~written.usable & valid; rest; rest &= rest - 1)
            rejected[rejected_count++] = static_cast<std::uint32_t>(first + hwy::Num0BitsBelowLS1Bit_Nonzero32(rest));
    }
    for (std::int32_t& extent : chunk.extent) extent = 0;
    chunk.largest_radius = 0;
    chunk.l1_radius = 0.0f;
    extremes.grow(chunk);
    chunk.out_of_frame = static_cast<std::uint32_t>(count - bounded);
    return rejected_count;
}

std::size_t write_items(const unsigned char* all_boxes, const std::uint32_t* items, std::size_t count,
                        ListChunk* chunks, RowBlock* rows, BoxRecord* records, std::uint32_t* rejected) {
    Boxes boxes[2];
    const auto put = [&](Boxes& to, std::size_t first) HWY_ATTR {
        for (std::size_t lane = 0; lane < kSixteen; ++lane) {
            const std::uint32_t item = items[std::min(first + lane, count - 1)];
            to.put(lane, all_boxes + kBoxBytes * item);
            to.put_frame(lane, chunks[item / kChunk]);
        }
    };
    // Scattered items miss the cache, so this many are prefetched.
    constexpr std::size_t kAhead = 48;
    const auto prefetch = [&](std::size_t i) {
        const std::uint32_t item = items[i];
        hwy::Prefetch(all_boxes + kBoxBytes * item);
        hwy::Prefetch(all_boxes + kBoxBytes * item + kBoxBytes - 4);
        hwy::Prefetch(&rows[item / kSixteen].xy);
        hwy::Prefetch(&rows[item / kSixteen].zr);
        hwy::Prefetch(&records[item]);
    };
    for (std::size_t i = 0; i < std::min(kAhead, count); ++i) prefetch(i);
    Written written;
    std::size_t rejected_count = 0;
    if (count > 0) put(boxes[0], 0);
    for (std::size_t first = 0, turn = 0; first < count; first += kSixteen, turn ^= 1) {
        for (std::size_t i = first + kAhead; i < std::min(first + kAhead + kSixteen, count); ++i) prefetch(i);
        if (first + kSixteen < count) put(boxes[turn ^ 1], first + kSixteen);
        write(boxes[turn], written);
        for (std::size_t lane = 0; lane < std::min(kSixteen, count - first); ++lane) {
            const std::uint32_t item = items[first + lane];
            if (!(written.usable >> lane & 1)) {
                rejected[rejected_count++] = item;
                continue;
            }
            ListChunk& chunk = chunks[item / kChunk];
            RowBlock& block = rows[item / kSixteen];
            const std::uint32_t was_out_of_frame = block.zr[item % kSixteen] >> 16 == kUnboundedRadius;
            chunk.out_of_frame = chunk.out_of_frame - was_out_of_frame + (~written.bounded >> lane & 1);
            block.xy[item % kSixteen] = written.xy[lane];
            block.zr[item % kSixteen] = written.zr[lane];
            written.copy_record(lane, records[item]);
            written.grow(lane, chunk);
        }
    }
    return rejected_count;
}

// The items of sixteen lanes. Where there are fewer, the last one fills the rest.
struct Group {
    const std::uint32_t* items;
    std::size_t count;
    bool in_order;  // one after the other

    [[nodiscard]] std::uint32_t item(std::size_t lane) const { return items[std::min(lane, count - 1)]; }
    [[nodiscard]] bool in_one_chunk() const {
        if (in_order) return items[0] / kChunk == items[count - 1] / kChunk;
        std::uint32_t differing = 0;
        for (std::size_t lane = 1; lane < count; ++lane) differing |= items[lane] ^ items[0];
        return differing < kChunk;
    }
    // Whether the items are all those of a block of rows, in order.
    [[nodiscard]] bool is_block() const {
        if (count < kSixteen || items[0] % kSixteen != 0) return false;
        if (in_order) return true;
        std::uint32_t differing = 0;
        for (std::uint32_t lane = 0; lane < kSixteen; ++lane) differing |= items[lane] ^ (items[0] + lane);
        return differing == 0;
    }
};

// The boxes of items one after the other, and what they are compared with and written to.
struct Target {
    ListChunk* chunks;
    RowBlock* rows;
    BoxRecord* records;
    const unsigned char* before;  // may be null; then the next are not read
    std::uint8_t *shapes, *differs;
};

// The first whole blocks, while their rows were written for the shapes that the boxes have. Returns how many boxes.
std::size_t write_moved_blocks(const unsigned char* boxes, std::size_t stride, std::size_t item, std::size_t count,
                               const Target& to) {
    Moved moved[2];  // in turn: a wide load right after narrow stores to the same bytes stalls
    Written written;
    ChunkExtremes extremes{to.chunks};
    std::size_t framed = ChunkExtremes::kNone;  // the chunk whose frame is
    double origin[4] = {};
    float per_quantum[2];
    const std::size_t end = count / kSixteen * kSixteen;
    const auto is_written = [&](std::size_t first) {
        return first < end && (to.shapes[(item + first) / kSixteen] & kShapesWritten) != 0;
    };
    const auto compare = [&](std::size_t first, std::size_t turn) HWY_ATTR {
        const unsigned char* const some = boxes + stride * first;
        moved[turn].compare(some, stride, to.before + kBoxBytes * (item + first));
        if (const std::size_t chunk = (item + first) / kChunk; chunk != framed) {
            framed = chunk;
            for (std::size_t j = 0; j < 3; ++j) origin[j] = origin_of(to.chunks[chunk], j);
        }
        per_quantum[turn] = per_quantum_of(to.chunks[framed]);
        for (std::size_t lane = 0; lane < kSixteen; ++lane) moved[turn].put_offset(lane, some + stride * lane, origin);
    };
    if (is_written(0)) compare(0, 0);
    std::size_t first = 0;
    for (std::size_t turn = 0; is_written(first); first += kSixteen, turn ^= 1) {
        if (is_written(first + kSixteen)) compare(first + kSixteen, turn ^ 1);
        const std::size_t block = (item + first) / kSixteen;
        if (!moved[turn].same_shapes || !write_moved(moved[turn], per_quantum[turn], to.rows[block], written)) break;
        extremes.include((item + first) / kChunk, written);
        std::memcpy(to.rows[block].xy, written.xy, sizeof written.xy);
        std::memcpy(to.rows[block].zr, written.zr, sizeof written.zr);
        for (std::size_t lane = 0; lane < kSixteen; ++lane)
            std::memcpy(to.records[item + first + lane].center, moved[turn].offset[lane], sizeof(BoxRecord::center));
        std::memcpy(to.differs + item + first, moved[turn].differs, kSixteen);
        to.shapes[block] = kShapesWritten | kShapesStay;
    }
    extremes.flush();
    return first;
}

// Boxes of any items, up to the first that is not usable.
std::size_t write_any(const unsigned char* all_boxes, std::size_t stride, const std::uint32_t* items, std::size_t count,
                      bool in_order, const Target& to) {
    constexpr std::size_t kMixed = ~std::size_t{0};
    Boxes boxes[2];
    std::size_t framed[2] = {kMixed, kMixed};  // the chunk whose frame all lanes have
    const auto group_at = [&](std::size_t first) {
        return Group{items + first, std::min(kSixteen, count - first), in_order};
    };
    const auto put = [&](std::size_t turn, std::size_t first) HWY_ATTR {
        const Group group = group_at(first);
        const std::size_t frame = group.in_one_chunk() ? group.items[0] / kChunk : kMixed;
        for (std::size_t lane = 0; lane < kSixteen; ++lane)
            boxes[turn].put(lane, all_boxes + stride * (first + std::min(lane, group.count - 1)));
        if (frame == kMixed)
            for (std::size_t lane = 0; lane < kSixteen; ++lane)
                boxes[turn].put_frame(lane, to.chunks[group.item(lane) / kChunk]);
        else if (frame != framed[turn])
            boxes[turn].put_frame(to.chunks[frame]);
        framed[turn] = frame;
    };
    Written written;
    Moved moved;
    ChunkExtremes extremes{to.chunks};
    std::size_t done = 0;
    if (count > 0) put(0, 0);
    for (std::size_t first = 0, turn = 0; first < count; first += kSixteen, turn ^= 1) {
        if (first + kSixteen < count) put(turn ^ 1, first + kSixteen);
        const Group group = group_at(first);
        write(boxes[turn], written);
        const std::uint32_t unusable = ~written.usable & ((1u << group.count) - 1);
        if (unusable == 0 && group.is_block()) {
            const std::uint32_t item = group.items[0];
            RowBlock& block = to.rows[item / kSixteen];
            extremes.include(item / kChunk, written);
            std::memcpy(block.xy, written.xy, sizeof block.xy);
            std::memcpy(block.zr, written.zr, sizeof block.zr);
            for (std::size_t lane = 0; lane < kSixteen; ++lane) written.copy_record(lane, to.records[item + lane]);
            if (to.before != nullptr) {
                moved.compare(all_boxes + stride * first, stride, to.before + kBoxBytes * item);
                std::memcpy(to.differs + item, moved.differs, kSixteen);
                to.shapes[item / kSixteen] = moved.same_shapes ? kShapesWritten | kShapesStay : 0;
            }
            done += kSixteen;
            continue;
        }
        const std::size_t usable = unusable ? hwy::Num0BitsBelowLS1Bit_Nonzero32(unusable) : group.count;
        for (std::size_t lane = 0; lane < usable; ++lane) {
            const std::uint32_t item = group.items[lane];
            ListChunk& chunk = to.chunks[item / kChunk];
            RowBlock& block = to.rows[item / kSixteen];
            block.xy[item % kSixteen] = written.xy[lane];
            block.zr[item % kSixteen] = written.zr[lane];
            written.copy_record(lane, to.records[item]);
            written.grow(lane, chunk);
            if (to.before == nullptr) continue;
            auto of_shapes = hn::Zero(DW());
            to.differs[item] =
                differ(all_boxes + stride * (first + lane), to.before + kBoxBytes * item, of_shapes) ? 1 : 0;
            to.shapes[item / kSixteen] = 0;
        }
        done += usable;
        if (unusable) break;
    }
    extremes.flush();
    return done;
}

std::size_t write_strided(const unsigned char* boxes, std::size_t stride, const std::uint32_t* items, std::size_t count,
                          bool in_order, ListChunk* chunks, RowBlock* rows, BoxRecord* records,
                          const unsigned char* before, std::uint8_t* shapes, std::uint8_t* differs) {
    const Target to{chunks, rows, records, before, shapes, differs};
    if (before == nullptr || !in_order || count == 0 || items[0] % kSixteen != 0)
        return write_any(boxes, stride, items, count, in_order, to);
    for (std::size_t done = 0; done < count;) {
        done += write_moved_blocks(boxes + stride * done, stride, items[done], count - done, to);
        // What those blocks end at, and what follows that they cannot take either.
        std::size_t end = std::min(done + kSixteen, count);
        while (end < count && (count - end < kSixteen || (shapes[items[end] / kSixteen] & kShapesWritten) == 0))
            end = std::min(end + kSixteen, count);
        if (end == done) break;
        const std::size_t written = write_any(boxes + stride * done, stride, items + done, end - done, true, to);
        done += written;
        if (done < end) return done;
    }
    return count;
}

}  // namespace
}  // namespace crofton::cull::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::cull {

HWY_EXPORT(write_chunk);
HWY_EXPORT(write_items);
HWY_EXPORT(write_strided);

std::size_t write_boxes(const Obb* boxes, std::size_t count, ListChunk& chunk, RowBlock* rows, BoxRecord* records,
                        std::uint32_t* rejected) {
    return HWY_DYNAMIC_DISPATCH(write_chunk)(reinterpret_cast<const unsigned char*>(boxes), count, chunk, rows, records,
                                             rejected);
}

std::size_t write_boxes(const Obb* boxes, const std::uint32_t* items, std::size_t count, ListChunk* chunks,
                        RowBlock* rows, BoxRecord* records, std::uint32_t* rejected) {
    return HWY_DYNAMIC_DISPATCH(write_items)(reinterpret_cast<const unsigned char*>(boxes), items, count, chunks, rows,
                                             records, rejected);
}

std::size_t write_strided_boxes(const Obb* first, std::size_t stride, std::span<const std::uint32_t> items,
                                bool in_order, ListChunk* chunks, RowBlock* rows, BoxRecord* records, const Obb* before,
                                std::uint8_t* shapes, std::uint8_t* differs) {
    return HWY_DYNAMIC_DISPATCH(write_strided)(reinterpret_cast<const unsigned char*>(first), stride, items.data(),
                                               items.size(), in_order, chunks, rows, records,
                                               reinterpret_cast<const unsigned char*>(before), shapes, differs);
}

}  // namespace crofton::cull
#endif
