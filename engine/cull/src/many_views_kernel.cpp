#include "many_views_kernel.hpp"

#include <hwy/cache_control.h>

// Vectors of unknown size cannot be members.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "many_views_kernel.cpp"
// clang-format off
#include <hwy/foreach_target.h>
// clang-format on
#include <hwy/highway.h>

#include "block_tests-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::cull::HWY_NAMESPACE {
namespace {

template <class Visit>
HWY_INLINE void for_each_bit(std::uint32_t bits, const Visit& visit) {
    for (; bits; bits &= bits - 1) visit(static_cast<unsigned>(hwy::Num0BitsBelowLS1Bit_Nonzero32(bits)));
}

class ManyWalk {
  public:
    HWY_INLINE ManyWalk(const ManyViewsInput& input, const ManyViewsOutput& output) : in_(input), out_(output) {}

    // A copy of the output travels with the walk, so that the compiler keeps it in registers.
    [[nodiscard]] HWY_INLINE ManyViewsOutput result() const { return out_; }

    HWY_INLINE void run() {
        ManyViewsEntry& root = out_.stack[0];
        root = {};
        for (std::uint32_t v = 0; v < in_.view_count; ++v) {
            root.straddling |= 1u << v;
            root.planes[v] = static_cast<std::uint16_t>((1u << in_.views[v].plane_count) - 1);
        }
        size_ = 1;
        while (size_ > 0) {
            // Read in place: what is pushed over it is pushed when it has been used.
            const ManyViewsEntry& entry = out_.stack[--size_];
            if (entry.straddling == 0 && accept_whole(entry.child, entry.whole)) continue;
            if (entry.child & tree::kLeafBit)
                visit_leaf(entry);
            else
                visit_node(entry);
        }
    }

  private:
    // By lanes of a node: the views that see all, and those with planes left to test.
    struct Below {
        alignas(64) std::uint32_t whole[tree::kWidth];
        alignas(64) std::uint32_t straddling[tree::kWidth];
        alignas(64) std::uint32_t planes[32][tree::kWidth];

        void write(ManyViewsEntry& entry, const tree::Node& node, unsigned lane) const {
            entry.child = node.child[lane];
            entry.whole = whole[lane];
            entry.straddling = straddling[lane];
            for_each_bit(entry.straddling,
                         [&](unsigned v) { entry.planes[v] = static_cast<std::uint16_t>(planes[v][lane]); });
        }
    };

    // Returns the lanes that some view may see something of.
    HWY_INLINE std::uint32_t test_below(const tree::Node& node, const ManyViewsEntry& entry, Below& below) const {
        const DU du;
        const std::uint32_t used = (1u << node.count) - 1;
        for (unsigned lane = 0; lane < tree::kWidth; ++lane) {
            below.whole[lane] = entry.whole;
            below.straddling[lane] = 0;
        }
        std::uint32_t alive = entry.whole ? used : 0;
        for_each_bit(entry.straddling, [&](unsigned v) HWY_ATTR {
            const KernelView& view = in_.views[v];
            const NodeTest test = test_node(view, node, entry.planes[v]);
            alive |= test.alive;
            const bool every = (node.layers_every & view.layer_mask) != 0;
            const VU bit = hn::Set(du, 1u << v), zero = hn::Zero(du);
            for (std::size_t l = 0; l < tree::kWidth; l += hn::Lanes(du)) {
                const VU planes = hn::Load(du, test.planes + l);
                const auto living = mask_of(test.alive >> l);
                auto whole = hn::Eq(planes, zero);
                if (!every)
                    whole = hn::And(
                        whole, hn::Ne(hn::And(hn::Load(du, node.layers_all + l), hn::Set(du, view.layer_mask)), zero));
                const auto add = [&](std::uint32_t* views, const auto& mask) HWY_ATTR {
                    hn::Store(hn::Or(hn::Load(du, views + l), hn::IfThenElseZero(mask, bit)), du, views + l);
                };
                add(below.whole, hn::And(living, whole));
                add(below.straddling, hn::AndNot(whole, living));
                hn::Store(planes, du, below.planes[v] + l);
            }
        });
        return alive & used;
    }

    HWY_INLINE void visit_node(const ManyViewsEntry& entry) {
        const tree::Node& node = in_.nodes[entry.child];
        Below below;
        std::uint32_t alive = test_below(node, entry, below);
        if (!node.only_leaves) {
            while (alive) {
                const unsigned lane = 31u - static_cast<unsigned>(hwy::Num0BitsAboveMS1Bit_Nonzero32(alive));
                alive ^= 1u << lane;
                below.write(out_.stack[size_++], node, lane);
            }
            return;
        }
        for_each_bit(alive, [&](unsigned lane) {
            if (below.straddling[lane] == 0) return;
            const auto* leaf = reinterpret_cast<const char*>(&in_.leaves[node.child[lane] & ~tree::kLeafBit]);
            for (unsigned line = 0; line < sizeof(tree::Leaf) / 64; ++line) hwy::Prefetch(leaf + 64 * line);
        });
        for_each_bit(alive, [&](unsigned lane) {
            if (below.straddling[lane] == 0) {
                accept_whole(node.child[lane], below.whole[lane]);
                return;
            }
            ManyViewsEntry leaf;
            below.write(leaf, node, lane);
            visit_leaf(leaf);
        });
    }

    HWY_INLINE void copy_items(std::size_t first_slot, std::size_t count, std::uint32_t views) {
        const DU du;
        for (std::size_t i = 0; i < count; i += hn::Lanes(du)) {
            hn::StoreU(hn::LoadU(du, in_.slot_items + first_slot + i), du, out_.ids + out_.count + i);
            hn::StoreU(hn::Set(du, views), du, out_.masks + out_.count + i);
        }
        out_.count += count;
    }

    // False for a node whose leaves are not consecutive.
    HWY_INLINE bool accept_whole(std::uint32_t child, std::uint32_t views) {
        tree::LeafRange range{child & ~tree::kLeafBit, 1};
        if (!(child & tree::kLeafBit)) range = in_.ranges[child];
        if (range.items > 0) {
            copy_items(std::size_t{range.first} * tree::kWidth, range.items, views);
            return true;
        }
        for (std::uint32_t leaf = range.first; leaf < range.first + range.count; ++leaf)
            copy_items(std::size_t{leaf} * tree::kWidth, in_.leaf_counts[leaf], views);
        return range.count > 0;
    }

    // The boxes of a leaf that view v sees, lanes l on.
    HWY_INLINE MF test_view(unsigned v, std::uint32_t id, std::size_t l, std::uint32_t planes,
                            const LocalPlane* local) const {
        const tree::Leaf& leaf = in_.leaves[id];
        const KernelView& view = in_.views[v];
        BoxTest test;
        if (HWY_LIKELY(planes && !(planes & (planes - 1)))) {
            const auto i = hwy::Num0BitsBelowLS1Bit_Nonzero32(planes);
            test = test_boxes(lanes_of(view, leaf, l), view.planes[i], local[i]);
        } else {
            test = test_leaf(view, leaf, l, planes, local, in_.exact);
        }
        const MF seen = hn::Or(test.inside, test.straddling);
        if (HWY_LIKELY(hn::AllFalse(DF(), test.undecided))) return seen;
        alignas(64) std::uint32_t decided[tree::kWidth] = {};
        for_each_bit(bits_of(test.undecided), [&](unsigned lane) {
            const auto slot = static_cast<std::uint32_t>(id * tree::kWidth + l + lane);
            decided[lane] = in_.decide(in_.context, slot, v);
        });
        const DU du;
        return hn::Or(seen, hn::RebindMask(DF(), hn::Ne(hn::Load(du, decided), hn::Zero(du))));
    }

    HWY_INLINE void visit_leaf(const ManyViewsEntry& entry) {
        const std::uint32_t id = entry.child & ~tree::kLeafBit;
        const tree::Leaf& leaf = in_.leaves[id];
        const DU du;
        for (std::size_t l = 0; l < tree::kWidth && l < leaf.count; l += hn::Lanes(du)) {
            VU mask = hn::Set(du, entry.whole);
            for_each_bit(entry.straddling, [&](unsigned v) HWY_ATTR {
                const LocalOrigin at = local_origin(in_.views[v], leaf.origin, leaf.reach);
                LocalPlane local[KernelView::kMaxPlanes];
                for_each_bit(entry.planes[v], [&](unsigned i) { local[i] = local_plane(in_.views[v].planes[i], at); });
                const auto seen = hn::RebindMask(du, test_view(v, id, l, entry.planes[v], local));
                mask = hn::Or(mask, hn::IfThenElseZero(seen, hn::Set(du, 1u << v)));
            });
            const auto seen = hn::And(hn::Ne(mask, hn::Zero(du)), hn::FirstN(du, leaf.count - l));
            hn::StoreU(hn::Compress(hn::Load(du, in_.slot_items + id * tree::kWidth + l), seen), du,
                       out_.ids + out_.count);
            hn::StoreU(hn::Compress(mask, seen), du, out_.masks + out_.count);
            out_.count += hn::CountTrue(du, seen);
        }
    }

    const ManyViewsInput& in_;
    ManyViewsOutput out_;
    std::size_t size_ = 0;
};

void RunManyViews(const ManyViewsInput& input, ManyViewsOutput& output) {
    ManyWalk walk(input, output);
    walk.run();
    output = walk.result();
}

}  // namespace
}  // namespace crofton::cull::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::cull {

HWY_EXPORT(RunManyViews);

void run_many_views_kernel(const ManyViewsInput& input, ManyViewsOutput& output) {
    HWY_DYNAMIC_DISPATCH(RunManyViews)(input, output);
}

}  // namespace crofton::cull
#endif
