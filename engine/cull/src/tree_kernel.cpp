#include "tree_kernel.hpp"

#include <hwy/cache_control.h>
#include <algorithm>
#include <crofton/cull/statistics.hpp>
#include <cstddef>

// Integer products that are summed in the same step are worth a target of their own.
#define HWY_WANT_AVX3_DL 1
// Vectors of unknown size cannot be members.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tree_kernel.cpp"
// clang-format off
#include <hwy/foreach_target.h>
// clang-format on
#include <hwy/highway.h>

#include "leaf_tests-inl.hpp"

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
        const std::uint32_t whole = seen(node, test.alive & test.settled);
        for (std::uint32_t alive = test.alive; alive; alive &= alive - 1) {
            const auto lane = static_cast<unsigned>(hwy::Num0BitsBelowLS1Bit_Nonzero32(alive));
            entries[count++] = std::uint64_t{node.child[lane]} << 32 | (whole >> lane & 1 ? kWhole : test.planes[lane]);
        }
        return count;
    }

    // First all nodes, then the leaves that they leave open: in one long loop, whose memory is asked for ahead.
    HWY_INLINE void run(std::size_t stack_size) {
        while (stack_size > 0) {
            const std::uint64_t entry = out_.stack[--stack_size];
            const auto child = static_cast<std::uint32_t>(entry >> 32);
            const auto planes = static_cast<std::uint32_t>(entry);
            if (planes & kWhole && accept_whole(child)) continue;
            if (child & tree::kLeafBit) {
                out_.open_leaves[open_] = child;
                out_.open_planes[open_++] = planes & ~kWhole;
            } else {
                stack_size = visit_node(child, planes & ~kWhole, stack_size);
            }
        }
        if (out_.runs == nullptr) out_.whole_count = out_.inside_count;
        constexpr std::size_t kAhead = 4;
        for (std::size_t i = 0; i < std::min(kAhead, open_); ++i) prefetch_leaf(out_.open_leaves[i]);
        for (std::size_t i = 0; i < open_; ++i) {
            if (i + kAhead < open_) prefetch_leaf(out_.open_leaves[i + kAhead]);
            visit_leaf(out_.open_leaves[i] & ~tree::kLeafBit, out_.open_planes[i]);
        }
    }

  private:
    // Lanes of `lanes` below which everything is in a layer that the view sees.
    HWY_INLINE std::uint32_t seen(const tree::Node& node, std::uint32_t lanes) const {
        if (HWY_LIKELY(node.layers_every & in_.view->layer_mask)) return lanes;
        std::uint32_t result = 0;
        for (std::uint32_t rest = lanes; rest; rest &= rest - 1) {
            const auto lane = static_cast<unsigned>(hwy::Num0BitsBelowLS1Bit_Nonzero32(rest));
            if (node.layers_all[lane] & in_.view->layer_mask) result |= 1u << lane;
        }
        return result;
    }

    HWY_INLINE std::size_t visit_node(std::uint32_t id, std::uint32_t planes, std::size_t stack_size) {
        const tree::Node& node = in_.nodes[id];
        const NodeTest test = test_node(*in_.view, node, planes);
        if (kCountStatistics) out_.nodes_tested += node.count;
        const std::uint32_t whole = seen(node, test.alive & test.settled);
        if (node.only_leaves) {
            for (std::uint32_t rest = whole; rest; rest &= rest - 1)
                accept_whole(node.child[hwy::Num0BitsBelowLS1Bit_Nonzero32(rest)]);
            leave_open(node, test, test.alive & ~whole);
            return stack_size;
        }
        for (std::uint32_t alive = test.alive; alive;) {
            const unsigned lane = 31u - static_cast<unsigned>(hwy::Num0BitsAboveMS1Bit_Nonzero32(alive));
            alive ^= 1u << lane;
            const bool is_whole = whole >> lane & 1;
            if (!is_whole && !(node.child[lane] & tree::kLeafBit)) prefetch_node(node.child[lane]);
            out_.stack[stack_size++] = std::uint64_t{node.child[lane]} << 32 | (is_whole ? kWhole : test.planes[lane]);
        }
        return stack_size;
    }

    // Without a branch on how many they are.
    HWY_INLINE void leave_open(const tree::Node& node, const NodeTest& test, std::uint32_t lanes) {
        const DU du;
        for (std::size_t l = 0; l < tree::kWidth; l += hn::Lanes(du)) {
            const std::uint32_t part = lanes >> l;
            const std::uint8_t bytes[8] = {static_cast<std::uint8_t>(part), static_cast<std::uint8_t>(part >> 8)};
            const auto mask = hn::LoadMaskBits(du, bytes);
            hn::StoreU(hn::Compress(hn::Load(du, node.child + l), mask), du, out_.open_leaves + open_);
            hn::StoreU(hn::Compress(hn::Load(du, test.planes + l), mask), du, out_.open_planes + open_);
            open_ += hn::CountTrue(du, mask);
        }
    }

    HWY_INLINE void prefetch_leaf(std::uint32_t child) const {
        const std::uint32_t leaf = child & ~tree::kLeafBit;
        for (std::size_t at = 0; at < offsetof(tree::Leaf, layers); at += 64)
            hwy::Prefetch(reinterpret_cast<const char*>(in_.leaves + leaf) + at);
        hwy::Prefetch(in_.slot_items + std::size_t{leaf} * tree::kWidth);
    }

    HWY_INLINE void prefetch_node(std::uint32_t node) const {
        for (std::size_t at = 0; at < offsetof(tree::Node, layers_any); at += 64)
            hwy::Prefetch(reinterpret_cast<const char*>(in_.nodes + node) + at);
    }

    HWY_INLINE void note_run(std::uint32_t leaf, std::uint32_t items) {
        out_.runs[out_.run_count++] = {leaf * tree::kWidth, items};
        out_.whole_count += items;
    }

    HWY_INLINE void copy_leaf(std::uint32_t leaf) {
        if (out_.runs != nullptr) return note_run(leaf, in_.leaf_counts[leaf]);
        const DU du;
        for (std::size_t l = 0; l < tree::kWidth; l += hn::Lanes(du))
            hn::StoreU(hn::Load(du, in_.slot_items + leaf * tree::kWidth + l), du, out_.inside + out_.inside_count + l);
        out_.inside_count += in_.leaf_counts[leaf];
    }

    HWY_INLINE void copy_items(tree::LeafRange range) {
        if (out_.runs != nullptr) return note_run(range.first, range.items);
        const DU du;
        const tree::ItemId* from = in_.slot_items + std::size_t{range.first} * tree::kWidth;
        tree::ItemId* to = out_.inside + out_.inside_count;
        for (std::size_t i = 0; i < range.items; i += hn::Lanes(du)) hn::StoreU(hn::Load(du, from + i), du, to + i);
        out_.inside_count += range.items;
    }

    // False for a node whose leaves are not consecutive.
    HWY_INLINE bool accept_whole(std::uint32_t child) {
        const std::size_t before = out_.inside_count + out_.whole_count;
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
        if (kCountStatistics) out_.accepted_whole += out_.inside_count + out_.whole_count - before;
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
        if (kCountStatistics) out_.boxes_tested += leaf.count;
        const LocalOrigin at = local_origin(view, leaf.origin, leaf.reach);
        const DU du;
        if (HWY_LIKELY(planes && !(planes & (planes - 1)))) {
            const LeafPlane plane = leaf_plane(view, hwy::Num0BitsBelowLS1Bit_Nonzero32(planes), at, leaf);
            for (std::size_t l = 0; l < tree::kWidth; l += hn::Lanes(du))
                emit(id, l, test_leaf(LeafRows(view, leaf, l), plane));
            return;
        }
        const LeafPlanes local(view, planes, at, leaf);
        for (std::size_t l = 0; l < tree::kWidth; l += hn::Lanes(du))
            emit(id, l, test_leaf(LeafRows(view, leaf, l), local.planes, local.count, in_.exact));
    }

    const TreeKernelInput& in_;
    TreeKernelOutput out_;
    std::size_t open_ = 0;
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
