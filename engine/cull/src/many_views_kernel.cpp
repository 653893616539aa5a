#include "many_views_kernel.hpp"

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
    ManyWalk(const ManyViewsInput& input, ManyViewsOutput& output) : in_(input), out_(output) {}

    void run() {
        ManyViewsEntry& root = out_.stack[0];
        root = {};
        for (std::uint32_t v = 0; v < in_.view_count; ++v) {
            root.straddling |= 1u << v;
            root.planes[v] = static_cast<std::uint16_t>((1u << in_.views[v].plane_count) - 1);
        }
        size_ = 1;
        while (size_ > 0) {
            const ManyViewsEntry entry = out_.stack[--size_];
            if (entry.straddling == 0 && accept_whole(entry)) continue;
            if (entry.child & tree::kLeafBit)
                visit_leaf(entry);
            else
                visit_node(entry);
        }
    }

  private:
    void visit_node(const ManyViewsEntry& entry) {
        const tree::Node& node = in_.nodes[entry.child];
        ManyViewsEntry below[tree::kWidth];
        for (std::uint32_t lane = 0; lane < node.count; ++lane) {
            below[lane].child = node.child[lane];
            below[lane].straddling = below[lane].whole = 0;
        }
        const auto pass_on = [&](unsigned v, unsigned lane, std::uint32_t planes) {
            if (planes == 0 && node.layers_all[lane] & in_.views[v].layer_mask) {
                below[lane].whole |= 1u << v;
            } else {
                below[lane].straddling |= 1u << v;
                below[lane].planes[v] = static_cast<std::uint16_t>(planes);
            }
        };
        for_each_bit(entry.straddling, [&](unsigned v) {
            const NodeTest test = test_node(in_.views[v], node, entry.planes[v]);
            for_each_bit(test.alive, [&](unsigned lane) { pass_on(v, lane, test.planes[lane]); });
        });
        for (std::uint32_t lane = node.count; lane-- > 0;) {
            below[lane].whole |= entry.whole;
            if (below[lane].straddling | below[lane].whole) out_.stack[size_++] = below[lane];
        }
    }

    // False for a node whose leaves are not consecutive.
    bool accept_whole(const ManyViewsEntry& entry) {
        const DU du;
        tree::LeafRange range{entry.child & ~tree::kLeafBit, 1};
        if (!(entry.child & tree::kLeafBit)) range = in_.ranges[entry.child];
        for (std::uint32_t leaf = range.first; leaf < range.first + range.count; ++leaf) {
            for (std::size_t l = 0; l < tree::kWidth; l += hn::Lanes(du)) {
                hn::StoreU(hn::Load(du, in_.slot_items + leaf * tree::kWidth + l), du, out_.ids + out_.count + l);
                hn::StoreU(hn::Set(du, entry.whole), du, out_.masks + out_.count + l);
            }
            out_.count += in_.leaf_counts[leaf];
        }
        return range.count > 0;
    }

    void visit_leaf(const ManyViewsEntry& entry) {
        const std::uint32_t id = entry.child & ~tree::kLeafBit;
        const tree::Leaf& leaf = in_.leaves[id];
        const DU du;
        alignas(64) std::uint32_t masks[tree::kWidth];
        for (std::uint32_t lane = 0; lane < tree::kWidth; ++lane) masks[lane] = lane < leaf.count ? entry.whole : 0;
        for_each_bit(entry.straddling, [&](unsigned v) {
            const KernelView& view = in_.views[v];
            const LocalOrigin at = local_origin(view, leaf.origin, leaf.reach);
            LocalPlane local[KernelView::kMaxPlanes];
            for_each_bit(entry.planes[v], [&](unsigned i) { local[i] = local_plane(view.planes[i], at); });
            for (std::size_t l = 0; l < tree::kWidth; l += hn::Lanes(du)) {
                const BoxTest test = test_leaf(view, leaf, l, entry.planes[v], local, in_.exact);
                const auto seen = hn::RebindMask(du, hn::Or(test.inside, test.straddling));
                hn::Store(hn::Or(hn::Load(du, masks + l), hn::IfThenElseZero(seen, hn::Set(du, 1u << v))), du,
                          masks + l);
                if (HWY_LIKELY(hn::AllFalse(DF(), test.undecided))) continue;
                for_each_bit(bits_of(test.undecided), [&](unsigned lane) {
                    const auto slot = static_cast<std::uint32_t>(id * tree::kWidth + l + lane);
                    if (in_.decide(in_.context, slot, v)) masks[l + lane] |= 1u << v;
                });
            }
        });
        for (std::size_t l = 0; l < tree::kWidth; l += hn::Lanes(du)) {
            const VU mask = hn::Load(du, masks + l);
            const auto seen = hn::Ne(mask, hn::Zero(du));
            hn::StoreU(hn::Compress(hn::Load(du, in_.slot_items + id * tree::kWidth + l), seen), du,
                       out_.ids + out_.count);
            hn::StoreU(hn::Compress(mask, seen), du, out_.masks + out_.count);
            out_.count += hn::CountTrue(du, seen);
        }
    }

    const ManyViewsInput& in_;
    ManyViewsOutput& out_;
    std::size_t size_ = 0;
};

void RunManyViews(const ManyViewsInput& input, ManyViewsOutput& output) {
    ManyWalk(input, output).run();
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
