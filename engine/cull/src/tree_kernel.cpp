#include "tree_kernel.hpp"

#include <hwy/cache_control.h>
#include <crofton/cull/statistics.hpp>

// Vectors of unknown size cannot be members.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tree_kernel.cpp"
// clang-format off
#include <hwy/foreach_target.h>
// clang-format on
#include <hwy/highway.h>

#include "block_tests-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::cull::HWY_NAMESPACE {
namespace {

// In a stack entry's planes: everything below is inside, and in a layer that the view sees.
constexpr std::uint32_t kWhole = 1u << 31;

class Walk {
  public:
    HWY_INLINE Walk(const TreeKernelInput& input, const TreeKernelOutput& output) : in_(input), out_(output) {}

    // A copy of the output travels with the walk, so that the compiler keeps it in registers.
    [[nodiscard]] HWY_INLINE TreeKernelOutput result() const { return out_; }

    // One level down, without going into leaves; subtrees inside the view and leaves stay as they are.
    HWY_INLINE std::size_t expand(std::uint64_t entry, std::uint64_t* entries) {
        const auto child = static_cast<std::uint32_t>(entry >> 32);
        const auto planes = static_cast<std::uint32_t>(entry);
        if (child & tree::kLeafBit || planes & kWhole) {
            entries[0] = entry;
            return 1;
        }
        const tree::Node& node = in_.nodes[child];
        const NodeTest test = test_node(*in_.view, node, planes);
        std::size_t count = 0;
        for (std::uint32_t alive = test.alive; alive; alive &= alive - 1) {
            const auto lane = static_cast<unsigned>(hwy::Num0BitsBelowLS1Bit_Nonzero32(alive));
            const bool whole = test.planes[lane] == 0 && all_seen(node, lane);
            entries[count++] = std::uint64_t{node.child[lane]} << 32 | (whole ? kWhole : test.planes[lane]);
        }
        return count;
    }

    HWY_INLINE void run(std::size_t stack_size) {
        while (stack_size > 0) {
            const std::uint64_t entry = out_.stack[--stack_size];
            const auto child = static_cast<std::uint32_t>(entry >> 32);
            const auto planes = static_cast<std::uint32_t>(entry);
            if (planes & kWhole && accept_whole(child)) continue;
            if (child & tree::kLeafBit)
                visit_leaf(child & ~tree::kLeafBit, planes);
            else
                stack_size = visit_node(child, planes, stack_size);
        }
    }

  private:
    // Is everything below in a layer that the view sees?
    HWY_INLINE bool all_seen(const tree::Node& node, unsigned lane) const {
        return ((node.layers_every & in_.view->layer_mask) != 0) || (node.layers_all[lane] & in_.view->layer_mask) != 0;
    }

    HWY_INLINE std::size_t visit_node(std::uint32_t id, std::uint32_t planes, std::size_t stack_size) {
        const tree::Node& node = in_.nodes[id];
        const NodeTest test = test_node(*in_.view, node, planes & ~kWhole);
        if (kCountStatistics) out_.nodes_tested += node.count;
        const auto entry_planes = [&](unsigned lane) {
            const bool whole = test.planes[lane] == 0 && all_seen(node, lane);
            return whole ? kWhole : test.planes[lane];
        };
        if (node.only_leaves) {
            for (std::uint32_t alive = test.alive; alive; alive &= alive - 1) {
                const auto lane = static_cast<unsigned>(hwy::Num0BitsBelowLS1Bit_Nonzero32(alive));
                const tree::Leaf* leaf = &in_.leaves[node.child[lane] & ~tree::kLeafBit];
                if (test.planes[lane])
                    for (unsigned line = 0; line < sizeof(tree::Leaf) / 64; ++line)
                        hwy::Prefetch(reinterpret_cast<const char*>(leaf) + 64 * line);
            }
            for (std::uint32_t alive = test.alive; alive; alive &= alive - 1) {
                const auto lane = static_cast<unsigned>(hwy::Num0BitsBelowLS1Bit_Nonzero32(alive));
                const std::uint32_t below = entry_planes(lane);
                if (below & kWhole)
                    accept_whole(node.child[lane]);
                else
                    visit_leaf(node.child[lane] & ~tree::kLeafBit, below);
            }
            return stack_size;
        }
        for (std::uint32_t alive = test.alive; alive;) {
            const unsigned lane = 31u - static_cast<unsigned>(hwy::Num0BitsAboveMS1Bit_Nonzero32(alive));
            alive ^= 1u << lane;
            out_.stack[stack_size++] = std::uint64_t{node.child[lane]} << 32 | entry_planes(lane);
        }
        return stack_size;
    }

    HWY_INLINE void copy_leaf(std::uint32_t leaf) {
        const DU du;
        for (std::size_t l = 0; l < tree::kWidth; l += hn::Lanes(du))
            hn::StoreU(hn::Load(du, in_.slot_items + leaf * tree::kWidth + l), du, out_.inside + out_.inside_count + l);
        out_.inside_count += in_.leaf_counts[leaf];
    }

    HWY_INLINE void copy_items(tree::LeafRange range) {
        const DU du;
        const tree::ItemId* from = in_.slot_items + std::size_t{range.first} * tree::kWidth;
        tree::ItemId* to = out_.inside + out_.inside_count;
        for (std::size_t i = 0; i < range.items; i += hn::Lanes(du)) hn::StoreU(hn::Load(du, from + i), du, to + i);
        out_.inside_count += range.items;
    }

    // False for a node whose leaves are not consecutive.
    HWY_INLINE bool accept_whole(std::uint32_t child) {
        const std::size_t before = out_.inside_count;
        if (child & tree::kLeafBit) {
            copy_leaf(child & ~tree::kLeafBit);
        } else {
            const tree::LeafRange range = in_.ranges[child];
            if (range.count == 0) return false;
            if (range.items > 0)
                copy_items(range);
            else
                for (std::uint32_t leaf = range.first; leaf < range.first + range.count; ++leaf) copy_leaf(leaf);
        }
        if (kCountStatistics) out_.accepted_whole += out_.inside_count - before;
        return true;
    }

    template <class V>
    static HWY_INLINE void append(const V& values, MF mask, std::uint32_t* list, std::size_t& count) {
        const DU du;
        const auto bits = hn::RebindMask(du, mask);
        hn::StoreU(hn::Compress(values, bits), du, list + count);
        count += hn::CountTrue(du, bits);
    }

    HWY_INLINE void emit(std::uint32_t id, std::size_t l, const BoxTest& test) {
        const DU du;
        const VU items = hn::Load(du, in_.slot_items + id * tree::kWidth + l);
        append(items, test.inside, out_.inside, out_.inside_count);
        append(items, test.straddling, out_.straddling, out_.straddling_count);
        if (kCountStatistics) out_.improper += hn::CountTrue(DF(), test.improper);
        if (HWY_UNLIKELY(!hn::AllFalse(DF(), test.undecided)))
            append(hn::Iota(du, static_cast<std::uint32_t>(id * tree::kWidth + l)), test.undecided, out_.undecided,
                   out_.undecided_count);
    }

    HWY_INLINE void visit_leaf(std::uint32_t id, std::uint32_t planes) {
        const tree::Leaf& leaf = in_.leaves[id];
        const KernelView& view = *in_.view;
        if (kCountStatistics) out_.boxes_tested += in_.leaf_counts[id];
        planes &= ~kWhole;
        const LocalOrigin at = local_origin(view, leaf.origin, leaf.reach);
        const DU du;
        if (HWY_LIKELY(planes && !(planes & (planes - 1)))) {
            const KernelPlane& plane = view.planes[hwy::Num0BitsBelowLS1Bit_Nonzero32(planes)];
            const LocalPlane local = local_plane(plane, at);
            for (std::size_t l = 0; l < tree::kWidth; l += hn::Lanes(du))
                emit(id, l, test_boxes(lanes_of(view, leaf, l), plane, local));
            return;
        }
        LocalPlane local[KernelView::kMaxPlanes];
        for (std::uint32_t rest = planes; rest; rest &= rest - 1) {
            const auto i = hwy::Num0BitsBelowLS1Bit_Nonzero32(rest);
            local[i] = local_plane(view.planes[i], at);
        }
        for (std::size_t l = 0; l < tree::kWidth; l += hn::Lanes(du))
            emit(id, l, test_leaf(view, leaf, l, planes, local, in_.exact));
    }

    const TreeKernelInput& in_;
    TreeKernelOutput out_;
};

void RunTree(const TreeKernelInput& input, std::size_t stack_size, TreeKernelOutput& output) {
    Walk walk(input, output);
    walk.run(stack_size);
    output = walk.result();
}

std::size_t ExpandTree(const TreeKernelInput& input, std::uint64_t entry, std::uint64_t* entries) {
    return Walk(input, TreeKernelOutput{}).expand(entry, entries);
}

}  // namespace
}  // namespace crofton::cull::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::cull {

HWY_EXPORT(RunTree);
HWY_EXPORT(ExpandTree);

std::size_t expand_tree_kernel(const TreeKernelInput& input, std::uint64_t entry, std::uint64_t* entries) {
    return HWY_DYNAMIC_DISPATCH(ExpandTree)(input, entry, entries);
}

void run_tree_kernel(const TreeKernelInput& input, std::size_t stack_size, TreeKernelOutput& output) {
    HWY_DYNAMIC_DISPATCH(RunTree)(input, stack_size, output);
}

}  // namespace crofton::cull
#endif
