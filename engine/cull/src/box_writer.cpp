#include "box_writer.hpp"

#include <hwy/cache_control.h>
#include <algorithm>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "box_writer.cpp"
// clang-format off
#include <hwy/foreach_target.h>
// clang-format on
#include <hwy/highway.h>

#include "lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::cull::HWY_NAMESPACE {
namespace {

constexpr std::size_t kSixteen = tree::kWidth;
using DD = hn::CappedTag<double, kSixteen>;
using VD = hn::Vec<DD>;

// As Obb has it: a centre, three axes, three half extents.
constexpr std::size_t kBoxBytes = sizeof(Obb), kShapeBytes = 24;

// Sixteen boxes side by side, and the frames that they are to be written in.
struct Boxes {
    alignas(64) double center[3][kSixteen];
    alignas(64) float shape[3][kSixteen][4];  // nine axes' components, three half extents: loaded interleaved
    alignas(64) double origin[3][kSixteen];
    alignas(64) double per_quantum[kSixteen];
    alignas(64) float per_quantum_f[kSixteen];

    HWY_INLINE void put(std::size_t lane, const unsigned char* box) {
        for (std::size_t j = 0; j < 3; ++j) std::memcpy(&center[j][lane], box + 8 * j, 8);
        for (std::size_t q = 0; q < 3; ++q) std::memcpy(shape[q][lane], box + kShapeBytes + 16 * q, 16);
    }
    HWY_INLINE void put_frame(std::size_t lane, const ListChunk& chunk) {
        for (std::size_t j = 0; j < 3; ++j) origin[j][lane] = chunk.origin[j];
        per_quantum[lane] = 1.0 / chunk.quantum;  // exact, a power of two
        per_quantum_f[lane] = static_cast<float>(per_quantum[lane]);
    }
};

// What becomes of them.
struct Written {
    alignas(64) float offset[3][kSixteen];     // infinite where the centre is not usable
    alignas(64) std::int32_t at[3][kSixteen];  // in quanta; kBeyond where the frame ends before
    alignas(64) std::uint32_t xy[kSixteen];
    alignas(64) std::uint32_t zr[kSixteen];
    alignas(64) std::uint32_t radius[kSixteen];  // in quanta
    alignas(64) float reach[kSixteen];
    alignas(64) std::uint32_t record[2][kSixteen][4];
    std::uint32_t usable = 0, bounded = 0;  // a bit a lane

    HWY_INLINE void copy_record(std::size_t lane, BoxRecord& to) const {
        for (std::size_t q = 0; q < 2; ++q)
            std::memcpy(reinterpret_cast<unsigned char*>(&to) + 16 * q, record[q][lane], 16);
    }
};
constexpr std::int32_t kBeyond = kMaxRowCoordinate + 1;

HWY_INLINE void write_centers(const Boxes& boxes, Written& to) {
    const DD d;
    const hn::Rebind<float, DD> df;
    const hn::Rebind<std::int32_t, DD> di;
    const VD magic = hn::Set(d, 0x1.8p52);  // added and taken away again it leaves the nearest integer
    for (std::size_t l = 0; l < kSixteen; l += hn::Lanes(d))
        for (std::size_t j = 0; j < 3; ++j) {
            const VD center = hn::Load(d, boxes.center[j] + l);
            const VD offset = hn::Sub(center, hn::Load(d, boxes.origin[j] + l));
            const auto good = hn::Le(hn::Abs(center), hn::Set(d, kMaxCoordinate));
            const VD quanta = hn::Mul(offset, hn::Load(d, boxes.per_quantum + l));
            const auto near = hn::Le(hn::Abs(quanta), hn::Set(d, double{kMaxRowCoordinate}));
            const VD whole = hn::Sub(hn::Add(quanta, magic), magic);
            hn::Store(hn::DemoteTo(df, hn::IfThenElse(good, offset, hn::Set(d, 1e35))), df, to.offset[j] + l);
            hn::Store(hn::DemoteTo(di, hn::IfThenElse(near, whole, hn::Set(d, double{kBeyond}))), di, to.at[j] + l);
        }
}

HWY_INLINE VU pairs_of(VI lower, VI upper) {
    const VI low = hn::And(lower, hn::Set(DI(), 0xffff));
    return hn::BitCast(DU(), hn::Or(low, hn::ShiftLeft<16>(upper)));
}

HWY_INLINE VF dot(const VF (&of)[9], std::size_t i, std::size_t k) {
    return hn::Add(hn::Add(hn::Mul(of[3 * i], of[3 * k]), hn::Mul(of[3 * i + 1], of[3 * k + 1])),
                   hn::Mul(of[3 * i + 2], of[3 * k + 2]));
}

// Certainly so, as validate(Obb) asks it: a dot in float of numbers below 1.01 is within 4 · 2^-24 of the truth.
HWY_INLINE MF has_valid_shape(const VF (&axes)[9], const VF (&half)[3]) {
    const DF d;
    auto good = hn::FirstN(d, kSixteen);
    for (std::size_t i = 0; i < 3; ++i) {
        good = hn::And(good, hn::And(hn::Ge(half[i], hn::Zero(d)), hn::Le(half[i], hn::Set(d, 1e18f))));
        for (std::size_t k = i; k < 3; ++k) {
            const VF error = hn::Sub(dot(axes, i, k), hn::Set(d, i == k ? 1.0f : 0.0f));
            good = hn::And(good, hn::Le(hn::Abs(error), hn::Set(d, 0.99e-4f)));
        }
    }
    return good;
}

// The radius is √(Σ|e_k|² + 2 Σ|e_i · e_k|) for half edges e_k, or more: with u = 2^-24 the edges and products cost 2u and
// 3u of |e_i| |e_k| ≤ (|e_i|² + |e_k|²) / 2 each, the sums 5u, so that the square is within 20u and the root within 12u,
// for which 2^-14 stands, so that no edge has more than 32766 units besides; what underflows is far below 1e-15. Edges are
// within 3u · 32766 + 1/2 of a unit.
HWY_INLINE void write_shapes(const Boxes& boxes, Written& to) {
    const DF d;
    const DI di;
    const DU du;
    to.usable = to.bounded = 0;
    for (std::size_t l = 0; l < kSixteen; l += hn::Lanes(d)) {
        VF axes[9], half[3], edge[9];
        hn::LoadInterleaved4(d, boxes.shape[0][l], axes[0], axes[1], axes[2], axes[3]);
        hn::LoadInterleaved4(d, boxes.shape[1][l], axes[4], axes[5], axes[6], axes[7]);
        hn::LoadInterleaved4(d, boxes.shape[2][l], axes[8], half[0], half[1], half[2]);
        for (std::size_t i = 0; i < 9; ++i) edge[i] = hn::Mul(axes[i], half[i / 3]);
        const VF mixed =
            hn::Add(hn::Add(hn::Abs(dot(edge, 0, 1)), hn::Abs(dot(edge, 1, 2))), hn::Abs(dot(edge, 2, 0)));
        const VF square =
            hn::Add(hn::Add(hn::Add(dot(edge, 0, 0), dot(edge, 1, 1)), dot(edge, 2, 2)), hn::Add(mixed, mixed));
        const VF radius = hn::Add(hn::Mul(hn::Sqrt(square), hn::Set(d, 1.0f + 0x1p-14f)), hn::Set(d, 1e-15f));

        const VF x = hn::Load(d, to.offset[0] + l), y = hn::Load(d, to.offset[1] + l), z = hn::Load(d, to.offset[2] + l);
        const VF reach = hn::Mul(hn::Add(hn::Add(hn::Abs(x), hn::Abs(y)), hn::Abs(z)), hn::Set(d, 1.0f + 0x1p-20f));
        auto usable = hn::And(hn::Le(square, hn::Set(d, 1e36f)), hn::Le(reach, hn::Set(d, 1e31f)));
        usable = hn::And(usable, has_valid_shape(axes, half));

        const VI at[3] = {hn::Load(di, to.at[0] + l), hn::Load(di, to.at[1] + l), hn::Load(di, to.at[2] + l)};
        const VI farthest = hn::Max(hn::Max(hn::Abs(at[0]), hn::Abs(at[1])), hn::Abs(at[2]));
        const VF size = hn::Mul(radius, hn::Mul(hn::Load(d, boxes.per_quantum_f + l), hn::Set(d, 1.0f + 0x1p-9f + 0x1p-18f)));
        const VF limited = hn::IfThenElse(hn::Le(size, hn::Set(d, 65530.0f)), size, hn::Set(d, 65535.0f));
        auto bounded = hn::And(usable, hn::Le(size, hn::Set(d, 65530.0f)));
        bounded = hn::And(bounded, hn::RebindMask(d, hn::Lt(farthest, hn::Set(di, kBeyond))));
        const VI whole = hn::Add(hn::ConvertTo(di, limited), hn::Set(di, 2));
        const VI mask = hn::BitCast(di, hn::VecFromMask(d, bounded));
        const VI shown = hn::IfThenElse(hn::RebindMask(di, bounded), whole, hn::Set(di, std::int32_t{kUnboundedRadius}));
        for (std::size_t j = 0; j < 3; ++j) hn::Store(hn::And(mask, at[j]), di, to.at[j] + l);
        hn::Store(hn::And(hn::BitCast(du, mask), pairs_of(at[0], at[1])), du, to.xy + l);
        hn::Store(pairs_of(hn::And(mask, at[2]), shown), du, to.zr + l);
        hn::Store(hn::BitCast(du, shown), du, to.radius + l);
        hn::Store(hn::IfThenElseZero(usable, reach), d, to.reach + l);

        const VU upper = hn::And(hn::Add(hn::BitCast(du, radius), hn::Set(du, 0xffffu)), hn::Set(du, 0xffff0000u));
        const VF per_unit = hn::Div(hn::Set(d, 0x1p15f), hn::BitCast(d, upper));
        const auto units = [&](std::size_t i) HWY_ATTR { return hn::NearestInt(hn::Mul(edge[i], per_unit)); };
        const VU first = hn::Or(hn::ShiftRight<16>(upper), hn::ShiftLeft<16>(hn::BitCast(du, units(0))));
        hn::StoreInterleaved4(hn::BitCast(du, x), hn::BitCast(du, y), hn::BitCast(du, z), first, du, to.record[0][l]);
        hn::StoreInterleaved4(pairs_of(units(1), units(2)), pairs_of(units(3), units(4)), pairs_of(units(5), units(6)),
                              pairs_of(units(7), units(8)), du, to.record[1][l]);
        to.usable |= bits_of(usable) << l;
        to.bounded |= bits_of(bounded) << l;
    }
}

HWY_INLINE void write(const Boxes& boxes, Written& to) {
    write_centers(boxes, to);
    write_shapes(boxes, to);
}

// The largest of a chunk's rows and records, lane by lane.
struct Extremes {
    alignas(64) std::int32_t at[3][kSixteen] = {};
    alignas(64) std::uint32_t radius[kSixteen] = {};
    alignas(64) float reach[kSixteen] = {};

    HWY_INLINE void include(const Written& written) {
        for (std::size_t l = 0; l < kSixteen; l += hn::Lanes(DF())) {
            for (std::size_t j = 0; j < 3; ++j)
                hn::Store(hn::Max(hn::Load(DI(), at[j] + l), hn::Abs(hn::Load(DI(), written.at[j] + l))), DI(), at[j] + l);
            hn::Store(hn::Max(hn::Load(DU(), radius + l), hn::Load(DU(), written.radius + l)), DU(), radius + l);
            hn::Store(hn::Max(hn::Load(DF(), reach + l), hn::Load(DF(), written.reach + l)), DF(), reach + l);
        }
    }
};

std::size_t WriteChunk(const unsigned char* all_boxes, std::size_t count, ListChunk& chunk, RowBlock* rows,
                       BoxRecord* records, std::uint32_t* left) {
    Boxes boxes[2];  // by turns: what was stored in narrow pieces is read in wide ones when it has settled
    const auto put = [&](Boxes& to, std::size_t first) HWY_ATTR {
        for (std::size_t lane = 0; lane < kSixteen; ++lane)
            to.put(lane, all_boxes + kBoxBytes * std::min(first + lane, count - 1));
    };
    for (Boxes& to : boxes)
        for (std::size_t lane = 0; lane < kSixteen; ++lane) to.put_frame(lane, chunk);
    Extremes extremes;
    Written written;
    std::size_t left_count = 0, bounded = 0;
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
            left[left_count++] = static_cast<std::uint32_t>(first + hwy::Num0BitsBelowLS1Bit_Nonzero32(rest));
    }
    for (std::size_t j = 0; j < 3; ++j) chunk.extent[j] = *std::max_element(extremes.at[j], extremes.at[j] + kSixteen);
    chunk.largest_radius = *std::max_element(extremes.radius, extremes.radius + kSixteen);
    chunk.reach = *std::max_element(extremes.reach, extremes.reach + kSixteen);
    chunk.strays = static_cast<std::uint32_t>(count - bounded);
    return left_count;
}

std::size_t WriteItems(const unsigned char* all_boxes, const std::uint32_t* items, std::size_t count, ListChunk* chunks,
                       RowBlock* rows, BoxRecord* records, std::uint32_t* left) {
    Boxes boxes[2];
    const auto put = [&](Boxes& to, std::size_t first) HWY_ATTR {
        for (std::size_t lane = 0; lane < kSixteen; ++lane) {
            const std::uint32_t item = items[std::min(first + lane, count - 1)];
            to.put(lane, all_boxes + kBoxBytes * item);
            to.put_frame(lane, chunks[item / kChunk]);
        }
    };
    // Scattered items wait for memory: it is asked for this many ahead.
    constexpr std::size_t kAhead = 48;
    const auto ask = [&](std::size_t i) {
        const std::uint32_t item = items[i];
        hwy::Prefetch(all_boxes + kBoxBytes * item);
        hwy::Prefetch(all_boxes + kBoxBytes * item + kBoxBytes - 4);
        hwy::Prefetch(&rows[item / kSixteen].xy);
        hwy::Prefetch(&rows[item / kSixteen].zr);
        hwy::Prefetch(&records[item]);
    };
    for (std::size_t i = 0; i < std::min(kAhead, count); ++i) ask(i);
    Written written;
    std::size_t left_count = 0;
    if (count > 0) put(boxes[0], 0);
    for (std::size_t first = 0, turn = 0; first < count; first += kSixteen, turn ^= 1) {
        for (std::size_t i = first + kAhead; i < std::min(first + kAhead + kSixteen, count); ++i) ask(i);
        if (first + kSixteen < count) put(boxes[turn ^ 1], first + kSixteen);
        write(boxes[turn], written);
        for (std::size_t lane = 0; lane < std::min(kSixteen, count - first); ++lane) {
            const std::uint32_t item = items[first + lane];
            if (!(written.usable >> lane & 1)) {
                left[left_count++] = item;
                continue;
            }
            ListChunk& chunk = chunks[item / kChunk];
            RowBlock& block = rows[item / kSixteen];
            const std::uint32_t was_stray = block.zr[item % kSixteen] >> 16 == kUnboundedRadius;
            chunk.strays = chunk.strays - was_stray + (~written.bounded >> lane & 1);
            block.xy[item % kSixteen] = written.xy[lane];
            block.zr[item % kSixteen] = written.zr[lane];
            written.copy_record(lane, records[item]);
            for (std::size_t j = 0; j < 3; ++j)
                chunk.extent[j] = std::max(chunk.extent[j], std::abs(written.at[j][lane]));
            chunk.largest_radius = std::max(chunk.largest_radius, written.radius[lane]);
            chunk.reach = std::max(chunk.reach, written.reach[lane]);
        }
    }
    return left_count;
}

}  // namespace
}  // namespace crofton::cull::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::cull {

HWY_EXPORT(WriteChunk);
HWY_EXPORT(WriteItems);

std::size_t write_boxes(const Obb* boxes, std::size_t count, ListChunk& chunk, RowBlock* rows, BoxRecord* records,
                        std::uint32_t* left) {
    return HWY_DYNAMIC_DISPATCH(WriteChunk)(reinterpret_cast<const unsigned char*>(boxes), count, chunk, rows, records,
                                            left);
}

std::size_t write_boxes(const Obb* boxes, const std::uint32_t* items, std::size_t count, ListChunk* chunks,
                        RowBlock* rows, BoxRecord* records, std::uint32_t* left) {
    return HWY_DYNAMIC_DISPATCH(WriteItems)(reinterpret_cast<const unsigned char*>(boxes), items, count, chunks, rows,
                                            records, left);
}

}  // namespace crofton::cull
#endif
