// SPDX-License-Identifier: MIT
#include "views/many_views_kernel.hpp"

#include <hwy/cache_control.h>
#include <algorithm>
#include <cstddef>
#include <cstring>

// Also compile for AVX-512 VNNI (`vpdpwssd`).
#define HWY_WANT_AVX3_DL 1
// clang-format off
#include <hwy/foreach_target.h>
// clang-format on
#include <hwy/highway.h>

#include "tree/leaf_tests-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::cull::HWY_NAMESPACE {
namespace {

// In a stack entry's planes: everything below is inside, and in a layer that the view sees.
constexpr std::uint32_t kWhole = 1u << 31;

using DP = hn::Rebind<std::uint16_t, DU>;

// Many views through one tree. First each view goes through the nodes alone. It notes the leaves that are fully inside,
// and those that must be tested. Then one pass over the noted leaves answers for all views: each leaf is read once.
template <class Mask>  // wide enough for the views
class ManyWalk {
  public:
    HWY_INLINE ManyWalk(const ManyViewsInput& input, const ManyViewsOutput& output) : in_(input), out_(output) {}

    // A copy of the output travels with the walk, so that the compiler keeps it in registers.
    [[nodiscard]] HWY_INLINE ManyViewsOutput result() const { return out_; }

    HWY_INLINE void run() {
        for (std::uint32_t v = 0; v < in_.view_count; ++v) walk_nodes(v);
        const std::size_t listed = write_whole();
        constexpr std::size_t kAhead = 4;
        for (std::size_t i = 0; i < std::min(kAhead, listed); ++i) prefetch_leaf(out_.listed[i]);
        for (std::size_t i = 0; i < listed; ++i) {
            if (i + kAhead < listed) prefetch_leaf(out_.listed[i + kAhead]);
            look_into(out_.listed[i]);
        }
    }

  private:
    HWY_INLINE void walk_nodes(std::uint32_t v) {
        const KernelView& view = in_.views[v];
        TurnedPlanes turned(view);
        std::size_t size = 1;
        out_.stack[0] = (1u << view.plane_count) - 1;
        while (size > 0) {
            const std::uint64_t entry = out_.stack[--size];
            const auto child = static_cast<std::uint32_t>(entry >> 32);
            const auto planes = static_cast<std::uint32_t>(entry);
            if (planes & kWhole && note_whole(child, 1u << v)) continue;
            if (child & boxtree::kLeafBit)
                note_open(child & ~boxtree::kLeafBit, planes & ~kWhole, v);
            else
                size = visit_node(v, child, planes & ~kWhole, size, turned);
        }
    }

    HWY_INLINE std::size_t visit_node(std::uint32_t v, std::uint32_t id, std::uint32_t planes, std::size_t size,
                                      TurnedPlanes& turned) {
        const boxtree::Node& node = in_.nodes[id];
        const NodeTest test =
            test_node(in_.views[v], in_.views[v], turned.along(in_.axes, node.axes, planes), node, planes);
        const std::uint32_t whole = seen(in_.views[v], node, test.alive & test.inside);
        if (node.only_leaves) {
            note_leaves(node, test, whole, v);
            return size;
        }
        for_each_bit(test.alive, [&](unsigned lane) {
            const bool is_whole = whole >> lane & 1;
            if (!is_whole && !(node.child[lane] & boxtree::kLeafBit)) prefetch_node(node.child[lane]);
            out_.stack[size++] = std::uint64_t{node.child[lane]} << 32 | (is_whole ? kWhole : test.planes[lane]);
        });
        return size;
    }

    // False for a node whose leaves are not consecutive.
    HWY_INLINE bool note_whole(std::uint32_t child, std::uint32_t view) {
        if (child & boxtree::kLeafBit) {
            const std::uint32_t leaf = child & ~boxtree::kLeafBit;
            out_.whole[leaf] |= view;
            touch(leaf, leaf);
            return true;
        }
        const boxtree::LeafRange range = in_.ranges[child];
        if (range.count == 0) return false;
        const std::uint32_t end = range.first + range.count;
        const DU du;
        const VU bit = hn::Set(du, view);
        std::uint32_t leaf = range.first;
        for (; leaf + hn::Lanes(du) <= end; leaf += static_cast<std::uint32_t>(hn::Lanes(du)))
            hn::StoreU(hn::Or(hn::LoadU(du, out_.whole + leaf), bit), du, out_.whole + leaf);
        for (; leaf < end; ++leaf) out_.whole[leaf] |= view;
        touch(range.first, end - 1);
        return true;
    }

    HWY_INLINE void touch(std::uint32_t first, std::uint32_t last) {
        for (std::uint32_t block = first / 16; block <= last / 16; ++block)
            out_.touched[block / 64] |= std::uint64_t{1} << (block % 64);
    }

    HWY_INLINE void note_open(std::uint32_t leaf, std::uint32_t planes, std::uint32_t v) {
        out_.open[leaf] |= 1u << v;
        planes_of(v)[leaf] = static_cast<std::uint16_t>(planes);
        touch(leaf, leaf);
    }

    // Leaf by leaf only where they are not consecutive.
    HWY_INLINE void note_leaves(const boxtree::Node& node, const NodeTest& test, std::uint32_t whole, std::uint32_t v) {
        if (test.alive == 0) return;
        const std::uint32_t first = node.child[0] & ~boxtree::kLeafBit, open = test.alive & ~whole;
        if (HWY_UNLIKELY(!are_consecutive(node))) {
            for_each_bit(whole, [&](unsigned lane) { note_whole(node.child[lane], 1u << v); });
            for_each_bit(
                open, [&](unsigned lane) { note_open(node.child[lane] & ~boxtree::kLeafBit, test.planes[lane], v); });
            return;
        }
        const DU du;
        const DP dp;
        const VU bit = hn::Set(du, 1u << v);
        for (std::size_t l = 0; l < boxtree::kWidth; l += hn::Lanes(du)) {
            const auto add = [&](std::uint32_t* views, std::uint32_t lanes) HWY_ATTR {
                const VU more = hn::IfThenElseZero(mask_of(lanes >> l), bit);
                hn::StoreU(hn::Or(hn::LoadU(du, views + first + l), more), du, views + first + l);
            };
            add(out_.whole, whole);
            add(out_.open, open);
            // Lanes beyond the last are other nodes' leaves.
            std::uint16_t* planes = planes_of(v) + first + l;
            const VU before = hn::PromoteTo(du, hn::LoadU(dp, planes));
            const VU after = hn::IfThenElse(mask_of(open >> l), hn::Load(du, test.planes + l), before);
            hn::StoreU(hn::DemoteTo(dp, hn::BitCast(DI(), after)), dp, planes);
        }
        touch(first, first + node.count - 1);
    }

    static HWY_INLINE bool are_consecutive(const boxtree::Node& node) {
        const DU du;
        const VU lanes = hn::Iota(du, 0);
        for (std::size_t l = 0; l < boxtree::kWidth && l < node.count; l += hn::Lanes(du)) {
            const VU next = hn::Add(lanes, hn::Set(du, node.child[0] + static_cast<std::uint32_t>(l)));
            const auto differs = hn::Ne(hn::Load(du, node.child + l), next);
            if (!hn::AllFalse(du, hn::And(differs, hn::FirstN(du, node.count - l)))) return false;
        }
        return true;
    }

    HWY_INLINE std::uint16_t* planes_of(std::uint32_t v) const {
        return out_.planes + v * (std::size_t{in_.leaf_count} + boxtree::kWidth);
    }

    // Writes the leaves that no view must test, and lists the others.
    HWY_INLINE std::size_t write_whole() {
        const std::uint32_t words = (in_.leaf_count + 1023) / 1024;
        std::size_t listed = 0;
        for (std::uint32_t w = 0; w < words; ++w) {
            for (std::uint64_t rest = out_.touched[w]; rest; rest &= rest - 1)
                listed = write_block(
                    1024 * w + 16 * static_cast<std::uint32_t>(hwy::Num0BitsBelowLS1Bit_Nonzero64(rest)), listed);
            out_.touched[w] = 0;
        }
        return listed;
    }

    HWY_INLINE std::size_t write_block(std::uint32_t first, std::size_t listed) {
        const DU du;
        const VU lanes = hn::Iota(du, 0), zero = hn::Zero(du), same = hn::Set(du, out_.whole[first]);
        alignas(64) std::uint32_t views[16];
        std::uint32_t whole = 0;
        bool uniform = true;
        for (std::uint32_t l = 0; l < 16; l += static_cast<std::uint32_t>(hn::Lanes(du))) {
            const VU seen = hn::Load(du, out_.whole + first + l);
            const auto open = hn::Ne(hn::Load(du, out_.open + first + l), zero);
            const auto only = hn::AndNot(open, hn::Ne(seen, zero));
            uniform = uniform && hn::AllTrue(du, hn::And(only, hn::Eq(seen, same)));
            whole |= bits_of(hn::RebindMask(DF(), only)) << l;
            hn::Store(seen, du, views + l);
            hn::Store(hn::IfThenElseZero(open, seen), du, out_.whole + first + l);
            listed += simd::compress_store(du, hn::Add(lanes, hn::Set(du, first + l)), open, out_.listed + listed);
        }
        if (uniform && is_full(first)) {
            for (std::uint32_t leaf = 0; leaf < 16; ++leaf) copy_leaf(first + leaf, same, std::size_t{16} * leaf);
            out_.count += 256;
        } else {
            for_each_bit(whole, [&](unsigned lane) HWY_ATTR {
                copy_leaf(first + lane, hn::Set(du, views[lane]), 0);
                out_.count += in_.leaf_counts[first + lane];
            });
        }
        return listed;
    }

    // Whether these sixteen leaves have sixteen items each.
    HWY_INLINE bool is_full(std::uint32_t first) const {
        if (first + 16 > in_.leaf_count) return false;
        std::uint64_t counts[2];
        std::memcpy(counts, in_.leaf_counts + first, 16);
        return counts[0] == 0x1010101010101010u && counts[1] == 0x1010101010101010u;
    }

    HWY_INLINE void copy_leaf(std::uint32_t leaf, VU views, std::size_t at) {
        const DU du;
        for (std::size_t l = 0; l < boxtree::kWidth; l += hn::Lanes(du)) {
            const VU items = hn::Load(du, in_.slot_items + std::size_t{leaf} * boxtree::kWidth + l);
            hn::StoreU(items, du, out_.ids + out_.count + at + l);
            store_masks(views, out_.count + at + l);
        }
    }

    HWY_INLINE void prefetch_leaf(std::uint32_t leaf) const {
        hwy::Prefetch(in_.slot_items + std::size_t{leaf} * boxtree::kWidth);
        for (std::size_t at = 0; at < offsetof(boxtree::Leaf, layers); at += 64)
            hwy::Prefetch(reinterpret_cast<const char*>(in_.leaves + leaf) + at);
    }

    HWY_INLINE void prefetch_node(std::uint32_t node) const {
        for (std::size_t at = 0; at < offsetof(boxtree::Node, layers_any); at += 64)
            hwy::Prefetch(reinterpret_cast<const char*>(in_.nodes + node) + at);
    }

    HWY_INLINE void store_masks(VU masks, std::size_t at) {
        Mask* to = static_cast<Mask*>(out_.masks) + at;
        if constexpr (sizeof(Mask) == 4) {
            hn::StoreU(masks, DU(), to);
        } else {
            const hn::Rebind<Mask, DU> narrow;
            hn::StoreU(hn::DemoteTo(narrow, hn::BitCast(DI(), masks)), narrow, to);
        }
    }

    // The views that see each of a leaf's items.
    struct LeafMasks {
        static constexpr std::size_t kParts = (boxtree::kWidth + hn::MaxLanes(DU()) - 1) / hn::MaxLanes(DU());
        VU part[kParts];
    };

    HWY_INLINE void look_into(std::uint32_t id) {
        const std::uint32_t whole = out_.whole[id], open = out_.open[id];
        const DU du;
        constexpr std::size_t kLanes = hn::MaxLanes(DU());
        LeafMasks masks;
        for (VU& part : masks.part) part = hn::Set(du, whole);
        for_each_bit(open, [&](unsigned v) HWY_ATTR { test_view(v, id, planes_of(v)[id], masks); });
        const std::size_t count = in_.leaf_counts[id];
        for (std::size_t l = 0; l < count; l += kLanes) {
            const VU mask = masks.part[l / kLanes];
            const auto seen = hn::And(hn::Ne(mask, hn::Zero(du)), hn::FirstN(du, count - l));
            const VU items = hn::Load(du, in_.slot_items + std::size_t{id} * boxtree::kWidth + l);
            store_masks(simd::compress(du, mask, seen), out_.count);
            out_.count += simd::compress_store(du, items, seen, out_.ids + out_.count);
        }
        // Last: clang 14 for WebAssembly reads what fills a vector after a store that follows it.
        out_.whole[id] = out_.open[id] = 0;
    }

    // Adds view v's bit to the boxes of a leaf that it sees. The planes are put into the leaf's units once.
    HWY_INLINE void test_view(std::uint32_t v, std::uint32_t id, std::uint32_t straddled, LeafMasks& masks) const {
        const boxtree::Leaf& leaf = in_.leaves[id];
        const KernelView& view = in_.views[v];
        LeafPlane planes[KernelView::kMaxPlanes];
        unsigned count = 0;
        for_each_bit(straddled, [&](unsigned i) {
            planes[count++] = {&view.pair_planes[i], block_plane(view, view, i, leaf)};
        });
        const DU du;
        const VU bit = hn::Set(du, 1u << v);
        for (std::size_t l = 0; l < boxtree::kWidth; l += hn::Lanes(du)) {
            const MF lanes = present(view, leaf.layers_every, leaf.layers, leaf.count, l);
            const BoxTest test = HWY_LIKELY(count == 1) ? test_leaf(LeafRows(leaf, l), lanes, planes[0])
                                                        : test_leaf(leaf, l, lanes, planes, count, in_.exact);
            MF seen = hn::Or(test.inside, test.straddling);
            if (HWY_UNLIKELY(!hn::AllFalse(DF(), test.undecided)))
                seen = hn::Or(seen, decide(v, id, l, bits_of(test.undecided)));
            VU& part = masks.part[l / hn::Lanes(du)];
            part = hn::Or(part, hn::IfThenElseZero(hn::RebindMask(du, seen), bit));
        }
    }

    HWY_INLINE MF decide(std::uint32_t v, std::uint32_t id, std::size_t l, std::uint32_t undecided) const {
        alignas(64) std::uint32_t decided[boxtree::kWidth] = {};
        for_each_bit(undecided, [&](unsigned lane) {
            const auto slot = static_cast<std::uint32_t>(id * boxtree::kWidth + l + lane);
            decided[lane] = in_.decide(in_.context, slot, v);
        });
        const DU du;
        return hn::RebindMask(DF(), hn::Ne(hn::Load(du, decided), hn::Zero(du)));
    }

    const ManyViewsInput& in_;
    ManyViewsOutput out_;
};

template <class Mask>
void walk(const ManyViewsInput& input, ManyViewsOutput& output) {
    ManyWalk<Mask> walk(input, output);
    walk.run();
    output = walk.result();
}

void run_many_views(const ManyViewsInput& input, ManyViewsOutput& output) {
    if (output.mask_bytes == 1) return walk<std::uint8_t>(input, output);
    if (output.mask_bytes == 2) return walk<std::uint16_t>(input, output);
    walk<std::uint32_t>(input, output);
}

}  // namespace
}  // namespace crofton::cull::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::cull {

HWY_EXPORT(run_many_views);

void run_many_views_kernel(const ManyViewsInput& input, ManyViewsOutput& output) {
    HWY_DYNAMIC_DISPATCH(run_many_views)(input, output);
}

}  // namespace crofton::cull
#endif
