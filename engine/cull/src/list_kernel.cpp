#include "list_kernel.hpp"

#include <hwy/cache_control.h>
#include <algorithm>
#include <crofton/cull/statistics.hpp>

#include "row_planes.hpp"

// Vectors of unknown size cannot be members.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "list_kernel.cpp"
// clang-format off
#include <hwy/foreach_target.h>
// clang-format on
#include <hwy/highway.h>

#include "list_lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::cull::HWY_NAMESPACE {
namespace {

using VI = hn::Vec<DI>;

// Σ of the products of the signed halves of (a, b) and (c, d), in each lane. Exact: the planes see to the range.
HWY_INLINE VI dot_halves(VU a, VU b, VU c, VU d) {
    const DI di;
#if HWY_TARGET == HWY_SCALAR
    const auto low = [&](VU v) { return hn::ShiftRight<16>(hn::ShiftLeft<16>(hn::BitCast(di, v))); };
    const auto high = [&](VU v) { return hn::ShiftRight<16>(hn::BitCast(di, v)); };
    return hn::Add(hn::Add(hn::Mul(low(a), low(b)), hn::Mul(high(a), high(b))),
                   hn::Add(hn::Mul(low(c), low(d)), hn::Mul(high(c), high(d))));
#else
    const hn::Repartition<std::int16_t, DI> d16;
    VI rest = hn::Zero(di);
    VI sum = hn::ReorderWidenMulAccumulate(di, hn::BitCast(d16, a), hn::BitCast(d16, b), hn::Zero(di), rest);
    sum = hn::ReorderWidenMulAccumulate(di, hn::BitCast(d16, c), hn::BitCast(d16, d), sum, rest);
    return hn::RearrangeToOddPlusEven(sum, rest);
#endif
}

// The rows of 64 bounds: which are certainly outside, which certainly inside.
HWY_INLINE void test_rows(const RowBlock* blocks, const RowPlanes& planes, std::uint64_t& outside,
                          std::uint64_t& inside) {
    const DI di;
    const DU du;
    outside = inside = 0;
    for (std::size_t l = 0; l < 16; l += hn::Lanes(di)) {
        const VU xy0 = hn::Load(du, blocks[0].xy + l), xy1 = hn::Load(du, blocks[1].xy + l),
                 xy2 = hn::Load(du, blocks[2].xy + l), xy3 = hn::Load(du, blocks[3].xy + l);
        const VU zr0 = hn::Load(du, blocks[0].zr + l), zr1 = hn::Load(du, blocks[1].zr + l),
                 zr2 = hn::Load(du, blocks[2].zr + l), zr3 = hn::Load(du, blocks[3].zr + l);
        VI least0 = hn::Set(di, 0x7fffffff), least1 = least0, least2 = least0, least3 = least0;
        for (std::uint32_t i = 0; i < planes.count; ++i) {
            const VU xy = hn::Set(du, planes.normal_xy[i]), z = hn::Set(du, planes.normal_z[i]);
            const VI offset = hn::Set(di, planes.offset[i]);
            least0 = hn::Min(least0, hn::Add(dot_halves(xy0, xy, zr0, z), offset));
            least1 = hn::Min(least1, hn::Add(dot_halves(xy1, xy, zr1, z), offset));
            least2 = hn::Min(least2, hn::Add(dot_halves(xy2, xy, zr2, z), offset));
            least3 = hn::Min(least3, hn::Add(dot_halves(xy3, xy, zr3, z), offset));
        }
        const auto judge = [&](VI least, VU zr, std::size_t shift) {
            const VU radius = hn::ShiftRight<16 - kRowNormalBits>(hn::And(zr, hn::Set(du, 0xffff0000u)));
            const VI reach = hn::Add(hn::BitCast(di, radius), hn::Set(di, planes.slack));
            outside |= std::uint64_t{bits_of(hn::RebindMask(DF(), hn::Lt(least, hn::Neg(reach))))} << shift;
            inside |= std::uint64_t{bits_of(hn::RebindMask(DF(), hn::Gt(least, reach)))} << shift;
        };
        judge(least0, zr0, l);
        judge(least1, zr1, l + 16);
        judge(least2, zr2, l + 32);
        judge(least3, zr3, l + 48);
    }
}

// The indices of the set bits, which are few: eight are written for every word, whether it has them or not, and more
// where it has. Room for 8 beyond the last is needed.
HWY_INLINE std::size_t list_sparse_bits(const std::uint64_t* bits, std::size_t words, std::uint32_t* ids) {
    std::size_t count = 0;
    for (std::size_t w = 0; w < words; ++w) {
        std::uint64_t word = bits[w];
        const std::size_t found = hwy::PopCount(word);
        const auto base = static_cast<std::uint32_t>(64 * w);
        std::uint32_t* to = ids + count;
        const auto next = [&] {
            *to++ =
                base + static_cast<std::uint32_t>(hwy::Num0BitsBelowLS1Bit_Nonzero64(word | std::uint64_t{1} << 63));
            word &= word - 1;
        };
        for (int i = 0; i < 8; ++i) next();
        for (std::size_t i = 8; i < found; ++i) next();
        count += found;
    }
    return count;
}

// Verdicts of up to 16 bounds, a bit each.
struct Sixteen {
    std::uint32_t inside = 0, straddling = 0, unsettled = 0, undecided = 0, improper = 0;

    HWY_INLINE void add(const BoxTest& test, std::size_t shift) {
        inside |= bits_of(test.inside) << shift;
        straddling |= bits_of(test.straddling) << shift;
        unsettled |= bits_of(test.unsettled) << shift;
        undecided |= bits_of(test.undecided) << shift;
        improper |= bits_of(test.improper) << shift;
    }
};

template <class Visit>
HWY_INLINE void for_each_bit(std::uint32_t bits, const Visit& visit) {
    for (; bits; bits &= bits - 1) visit(static_cast<unsigned>(hwy::Num0BitsBelowLS1Bit_Nonzero32(bits)));
}

template <class Record>
class ChunkQuery {
  public:
    ChunkQuery(const ListKernelInput<Record>& input, ListKernelOutput& output)
        : in_(input), out_(output), words_((input.count + 63) / 64), rows_(row_planes(*input.view, *input.chunk)) {
        const LocalOrigin at = local_origin(*in_.view, in_.chunk->origin, in_.chunk->reach);
        for_each_bit(rows_.planes, [&](unsigned i) { local_[i] = local_plane(in_.view->planes[i], at); });
    }

    void run() {
        out_.undecided_count = out_.settled_count = 0;
        out_.improper = out_.open = 0;
        const std::uint64_t last = ~std::uint64_t{0} >> (64 * words_ - in_.count);
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
            if (!rows_.useless) test_rows(in_.rows + 4 * w, rows_, outside, inside);
            const std::uint64_t valid = w + 1 == words_ ? last : ~std::uint64_t{0};
            out_.visible[w] = ~outside & valid;
            out_.inside[w] = inside & valid;
            open[w] = ~(outside | inside) & valid;
        }
        std::uint32_t indices[kChunk + 16], unsettled[kChunk + 16];
        const std::size_t count = list_sparse_bits(open, words_, indices);
        std::size_t unsettled_count = 0;
        for_each_sixteen(indices, count, [&](const auto& lanes, const std::uint32_t* which) {
            const Sixteen test = lanes([&](const auto& boxes) HWY_ATTR {
                return test_boxes(*in_.view, boxes, rows_.planes, local_, in_.exact);
            });
            for_each_bit(test.unsettled, [&](unsigned i) { unsettled[unsettled_count++] = which[i]; });
            apply(test, which);
        });
        out_.settled_count = unsettled_count;
        settle_all(unsettled, unsettled_count);
        if (kCountStatistics)
            for (std::size_t w = 0; w < words_; ++w) out_.open += hwy::PopCount(out_.visible[w] & ~out_.inside[w]);
    }

  private:
    // Hands sixteen at a time to `visit`: their indices, and a function that applies a test to their lanes.
    template <class Visit>
    HWY_INLINE void for_each_sixteen(const std::uint32_t* indices, std::size_t count, const Visit& visit) {
        Batch<Record> batch;
        for (std::size_t begin = 0; begin < count; begin += kBatch) {
            const std::size_t size = std::min(kBatch, count - begin);
            for (std::size_t i = 0; i < size; ++i) batch.copy(i, in_.records[indices[begin + i]]);
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
        const std::uint32_t kept = test.inside | test.straddling | test.unsettled | test.undecided;
        for_each_bit(valid_ & ~kept, [&](unsigned i) { out_.visible[which[i] / 64] &= ~bit(which[i]); });
        for_each_bit(test.inside, [&](unsigned i) { out_.inside[which[i] / 64] |= bit(which[i]); });
        for_each_bit(test.undecided, [&](unsigned i) { out_.undecided[out_.undecided_count++] = which[i]; });
    }

    HWY_INLINE void settle_all(const std::uint32_t* unsettled, std::size_t count) {
        for_each_sixteen(unsettled, count, [&](const auto& lanes, const std::uint32_t* which) {
            Sixteen test = lanes([&](const auto& bounds) HWY_ATTR {
                BoxTest result;
                result.inside = result.straddling = result.undecided = result.improper = hn::FirstN(DF(), 0);
                result.unsettled = bounds.present;
                settle(*in_.view, bounds, rows_.planes, local_, result);
                return result;
            });
            out_.improper += hwy::PopCount(test.improper);
            test.unsettled = 0;
            apply(test, which);
        });
    }

    static HWY_INLINE std::uint64_t bit(std::uint32_t i) { return std::uint64_t{1} << (i % 64); }

    const ListKernelInput<Record>& in_;
    ListKernelOutput& out_;
    std::size_t words_;
    RowPlanes rows_;
    LocalPlane local_[KernelView::kMaxPlanes];
    std::uint32_t valid_ = 0;
};

void RunBoxes(const ListKernelInput<BoxRecord>& input, ListKernelOutput& output) {
    ChunkQuery<BoxRecord>(input, output).run();
}
void RunAabbs(const ListKernelInput<AabbRecord>& input, ListKernelOutput& output) {
    ChunkQuery<AabbRecord>(input, output).run();
}
void RunSpheres(const ListKernelInput<SphereRecord>& input, ListKernelOutput& output) {
    ChunkQuery<SphereRecord>(input, output).run();
}

// Lanes i on of the bits.
HWY_INLINE hn::Mask<DU> mask_at(const std::uint64_t* bits, std::size_t i) {
    const DU du;
    if (hn::Lanes(du) < 8) return mask_of(bits[i / 64] >> (i % 64));
    return hn::LoadMaskBits(du, reinterpret_cast<const std::uint8_t*>(bits) + i / 8);
}

void MarkViews(const ViewBits* views, std::size_t view_count, std::size_t count, const std::uint32_t* layers,
               std::uint32_t* masks) {
    const DU du;
    std::size_t i = 0;
    for (; i + hn::Lanes(du) <= count; i += hn::Lanes(du)) {
        VU mask = hn::Zero(du);
        for (std::size_t n = 0; n < view_count; ++n) {
            auto seen = mask_at(views[n].visible, i);
            if (layers)
                seen = hn::And(
                    seen, hn::Ne(hn::And(hn::LoadU(du, layers + i), hn::Set(du, views[n].layer_mask)), hn::Zero(du)));
            mask = hn::Or(mask, hn::IfThenElseZero(seen, hn::Set(du, views[n].bit)));
        }
        hn::StoreU(mask, du, masks + i);
    }
    for (; i < count; ++i) {
        masks[i] = 0;
        for (std::size_t n = 0; n < view_count; ++n)
            if (views[n].visible[i / 64] >> (i % 64) & 1 && (!layers || layers[i] & views[n].layer_mask))
                masks[i] |= views[n].bit;
    }
}

std::size_t ListBits(const std::uint64_t* bits, std::size_t words, std::uint32_t* ids) {
    const DU du;
    const VU lanes = hn::Iota(du, 0);  // from another start it would be stored lane by lane
    std::size_t count = 0;
    for (std::size_t w = 0; w < words; ++w) {
        if (bits[w] == 0) continue;
        for (std::size_t l = 0; l < 64; l += hn::Lanes(du)) {
            const auto mask = mask_of(bits[w] >> l);
            const VU ids_here = hn::Add(lanes, hn::Set(du, static_cast<std::uint32_t>(64 * w + l)));
            hn::StoreU(hn::Compress(ids_here, mask), du, ids + count);
            count += hn::CountTrue(du, mask);
        }
    }
    return count;
}

}  // namespace
}  // namespace crofton::cull::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::cull {

HWY_EXPORT(RunBoxes);
HWY_EXPORT(RunAabbs);
HWY_EXPORT(RunSpheres);
HWY_EXPORT(MarkViews);
HWY_EXPORT(ListBits);

void run_list_kernel(const ListKernelInput<BoxRecord>& input, ListKernelOutput& output) {
    HWY_DYNAMIC_DISPATCH(RunBoxes)(input, output);
}
void run_list_kernel(const ListKernelInput<AabbRecord>& input, ListKernelOutput& output) {
    HWY_DYNAMIC_DISPATCH(RunAabbs)(input, output);
}
void run_list_kernel(const ListKernelInput<SphereRecord>& input, ListKernelOutput& output) {
    HWY_DYNAMIC_DISPATCH(RunSpheres)(input, output);
}

void mark_views_kernel(const ViewBits* views, std::size_t view_count, std::size_t count, const std::uint32_t* layers,
                       std::uint32_t* masks) {
    HWY_DYNAMIC_DISPATCH(MarkViews)(views, view_count, count, layers, masks);
}

std::size_t list_bits_kernel(const std::uint64_t* bits, std::size_t words, std::uint32_t* ids) {
    return HWY_DYNAMIC_DISPATCH(ListBits)(bits, words, ids);
}

}  // namespace crofton::cull
#endif
