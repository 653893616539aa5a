#include "tree_kernel.hpp"

#include <hwy/cache_control.h>
#include <algorithm>
#include <crofton/cull/statistics.hpp>
#include <cstddef>
#include <utility>

// Integer products that are summed in the same step are worth a target of their own.
#define HWY_WANT_AVX3_DL 1
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

// In an entry's planes: everything below is inside, and in a layer that the view sees.
constexpr std::uint32_t kWhole = 1u << 31;

// Lanes of `lanes` below which everything is in a layer that the view sees.
HWY_INLINE std::uint32_t seen(const KernelView& view, const tree::Node& node, std::uint32_t lanes) {
    if (HWY_LIKELY(node.layers_every & view.layer_mask)) return lanes;
    std::uint32_t result = 0;
    for (std::uint32_t rest = lanes; rest; rest &= rest - 1) {
        const auto lane = static_cast<unsigned>(hwy::Num0BitsBelowLS1Bit_Nonzero32(rest));
        if (node.layers_all[lane] & view.layer_mask) result |= 1u << lane;
    }
    return result;
}

class Walk {
  public:
    HWY_INLINE Walk(const TreeKernelInput& input, const TreeKernelOutput& output) : in_(input), out_(output) {}

    // A copy of the output travels with the walk, so that the compiler keeps it in registers.
    [[nodiscard]] HWY_INLINE TreeKernelOutput result() const { return out_; }

    // Group after group of entries through the nodes, what lies inside as a whole copied and the leaves that stay open
    // noted; these follow when all nodes are done. The groups settle the order of the answer.
    HWY_INLINE void run(const std::uint64_t* entries, std::size_t entry_count) {
        constexpr std::size_t kMaxGroups = tree::kWidth * tree::kWidth / kTreeGroup;
        std::size_t crossing_ends[kMaxGroups + 1] = {}, cornered_ends[kMaxGroups + 1] = {}, groups = 0;
        for (std::size_t first = 0; first < entry_count; first += kTreeGroup, ++groups) {
            descend(entries + first, std::min(kTreeGroup, entry_count - first));
            accept_all();
            part(crossing_ends[groups]);
            crossing_ends[groups + 1] = leaves_.count;
            cornered_ends[groups + 1] = cornered_.count;
        }
        if (out_.runs == nullptr) out_.whole_count = out_.inside_count;
        for (std::size_t g = 0; g < groups; ++g) {
            visit_crossing(leaves_.from(crossing_ends[g], crossing_ends[g + 1]));
            visit_cornered(cornered_.from(cornered_ends[g], cornered_ends[g + 1]));
        }
    }

  private:
    // Children and the planes that they straddle.
    struct List {
        std::uint32_t* children;
        std::uint32_t* planes;
        std::size_t count = 0;

        [[nodiscard]] HWY_INLINE List from(std::size_t begin, std::size_t end) const {
            return {children + begin, planes + begin, end - begin};
        }
        HWY_INLINE void append(VU which, VU their_planes, hn::Mask<DU> mask) {
            const DU du;
            hn::StoreU(hn::Compress(which, mask), du, children + count);
            hn::StoreU(hn::Compress(their_planes, mask), du, planes + count);
            count += hn::CountTrue(du, mask);
        }
        HWY_INLINE void append(std::uint32_t child, std::uint32_t child_planes) {
            children[count] = child;
            planes[count++] = child_planes;
        }
    };

    // Level by level; memory is asked for ahead, and lists grow without a branch on what is found.
    HWY_INLINE void descend(const std::uint64_t* entries, std::size_t count) {
        nodes_.count = whole_count_ = 0;
        for (std::size_t i = 0; i < count; ++i) start(entries[i]);
        constexpr std::size_t kAhead = 4;
        for (std::size_t head = 0; head < nodes_.count; ++head) {
            if (head + kAhead < nodes_.count) prefetch_node(nodes_.children[head + kAhead]);
            visit_node(nodes_.children[head], nodes_.planes[head]);
        }
    }

    HWY_INLINE void start(std::uint64_t entry) {
        const auto child = static_cast<std::uint32_t>(entry >> 32);
        const auto planes = static_cast<std::uint32_t>(entry);
        if (planes & kWhole)
            whole_[whole_count_++] = child;
        else
            (child & tree::kLeafBit ? leaves_ : nodes_).append(child, planes);
    }

    HWY_INLINE void visit_node(std::uint32_t id, std::uint32_t planes) {
        const tree::Node& node = in_.nodes[id];
        const NodeTest test = test_node(*in_.view, node, planes);
        if (kCountStatistics) out_.nodes_tested += node.count;
        const std::uint32_t whole = seen(*in_.view, node, test.alive & test.settled), open = test.alive & ~whole;
        const DU du;
        for (std::size_t l = 0; l < tree::kWidth; l += hn::Lanes(du)) {
            const VU children = hn::Load(du, node.child + l), straddled = hn::Load(du, test.planes + l);
            const auto whole_mask = mask_of(whole >> l), open_mask = mask_of(open >> l);
            hn::StoreU(hn::Compress(children, whole_mask), du, whole_ + whole_count_);
            whole_count_ += hn::CountTrue(du, whole_mask);
            if (node.only_leaves) {
                leaves_.append(children, straddled, open_mask);
                continue;
            }
            const auto is_leaf = hn::Ne(hn::And(children, hn::Set(du, tree::kLeafBit)), hn::Zero(du));
            leaves_.append(children, straddled, hn::And(open_mask, is_leaf));
            nodes_.append(children, straddled, hn::AndNot(is_leaf, open_mask));
        }
    }

    // Most leaves cross one plane; the others, in a list of their own, are fewer and cost more.
    HWY_INLINE void part(std::size_t begin) {
        const DU du;
        const VU zero = hn::Zero(du), one = hn::Set(du, 1);
        const std::size_t end = std::exchange(leaves_.count, begin);
        for (std::size_t i = begin; i < end; i += hn::Lanes(du)) {
            const VU children = hn::LoadU(du, leaves_.children + i), planes = hn::LoadU(du, leaves_.planes + i);
            const auto used = hn::FirstN(du, end - i);
            const auto few = hn::Eq(hn::And(planes, hn::Sub(planes, one)), zero);
            const auto once = hn::And(few, hn::Ne(planes, zero));
            leaves_.append(children, planes, hn::And(used, once));
            cornered_.append(children, planes, hn::AndNot(once, used));
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

    // A node whose leaves are not consecutive leaves it to its children, at the list's end.
    HWY_INLINE void accept_all() {
        const std::size_t before = out_.inside_count + out_.whole_count;
        constexpr std::size_t kAhead = 8;
        for (std::size_t i = 0; i < whole_count_; ++i) {
            if (i + kAhead < whole_count_) {
                const std::uint32_t ahead = whole_[i + kAhead];
                if (ahead & tree::kLeafBit)
                    hwy::Prefetch(in_.slot_items + std::size_t{ahead & ~tree::kLeafBit} * tree::kWidth);
                else
                    hwy::Prefetch(in_.ranges + ahead);
            }
            const std::uint32_t child = whole_[i];
            if (child & tree::kLeafBit) {
                copy_leaf(child & ~tree::kLeafBit);
                continue;
            }
            const tree::LeafRange range = in_.ranges[child];
            const tree::Node& node = in_.nodes[child];
            if (range.count == 0)
                for (std::uint32_t lane = 0; lane < node.count; ++lane) whole_[whole_count_++] = node.child[lane];
            else if (range.items > 0)
                copy_items(range);
            else
                for (std::uint32_t leaf = range.first; leaf < range.first + range.count; ++leaf) copy_leaf(leaf);
        }
        if (kCountStatistics) out_.accepted_whole += out_.inside_count + out_.whole_count - before;
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

    // The planes are made a leaf ahead: what a leaf waits for is computed while the one before is tested.
    HWY_INLINE void visit_crossing(const List& leaves) {
        const KernelView& view = *in_.view;
        const DU du;
        if (leaves.count == 0) return;
        const auto plane_of = [&](std::size_t i) HWY_ATTR {
            const tree::Leaf& leaf = in_.leaves[leaves.children[i] & ~tree::kLeafBit];
            return plane_before_(hwy::Num0BitsBelowLS1Bit_Nonzero32(leaves.planes[i]), leaf);
        };
        constexpr std::size_t kAhead = 5;
        const std::size_t last = leaves.count - 1;
        for (std::size_t i = 0; i < std::min(kAhead, leaves.count); ++i) prefetch_leaf(leaves.children[i]);
        LeafPlane next = plane_of(0);
        for (std::size_t i = 0; i <= last; ++i) {
            prefetch_leaf(leaves.children[std::min(i + kAhead, last)]);
            const LeafPlane plane = next;
            next = plane_of(std::min(i + 1, last));
            const std::uint32_t id = leaves.children[i] & ~tree::kLeafBit;
            const tree::Leaf& leaf = in_.leaves[id];
            if (kCountStatistics) out_.boxes_tested += leaf.count;
            for (std::size_t l = 0; l < tree::kWidth; l += hn::Lanes(du))
                emit(id, l, test_leaf(LeafRows(view, leaf, l), plane));
        }
    }

    HWY_INLINE void visit_cornered(const List& leaves) {
        const KernelView& view = *in_.view;
        const DU du;
        constexpr std::size_t kAhead = 4;
        for (std::size_t i = 0; i < std::min(kAhead, leaves.count); ++i) prefetch_leaf(leaves.children[i]);
        for (std::size_t i = 0; i < leaves.count; ++i) {
            if (i + kAhead < leaves.count) prefetch_leaf(leaves.children[i + kAhead]);
            const std::uint32_t id = leaves.children[i] & ~tree::kLeafBit;
            const tree::Leaf& leaf = in_.leaves[id];
            if (kCountStatistics) out_.boxes_tested += leaf.count;
            LeafPlane planes[KernelView::kMaxPlanes];
            unsigned count = 0;
            for (std::uint32_t rest = leaves.planes[i]; rest; rest &= rest - 1)
                planes[count++] = plane_before_(hwy::Num0BitsBelowLS1Bit_Nonzero32(rest), leaf);
            // Nearly all have two: then there is no loop.
            for (std::size_t l = 0; l < tree::kWidth; l += hn::Lanes(du)) {
                const LeafRows rows(view, leaf, l);
                emit(id, l,
                     HWY_LIKELY(count == 2) ? test_leaf(rows, planes, 2, in_.exact)
                                            : test_leaf(rows, planes, count, in_.exact));
            }
        }
    }

    const TreeKernelInput& in_;
    TreeKernelOutput out_;
    LeafPlaneMaker plane_before_{*in_.view, in_.nodes[0]};
    List nodes_{out_.work, out_.work + out_.work_size};  // open, from the first on
    List leaves_{out_.work + 2 * out_.work_size, out_.work + 3 * out_.work_size};
    List cornered_{out_.work + 5 * out_.work_size, out_.work + 6 * out_.work_size};  // those that cross several planes
    std::uint32_t* whole_ = out_.work + 4 * out_.work_size;  // children that lie inside as a whole
    std::size_t whole_count_ = 0;
};

void RunTree(const TreeKernelInput& input, const std::uint64_t* entries, std::size_t count, TreeKernelOutput& output) {
    Walk walk(input, output);
    walk.run(entries, count);
    output = walk.result();
}

// One level down, without going into leaves; subtrees inside the view and leaves stay as they are.
std::size_t ExpandTree(const TreeKernelInput& input, std::uint64_t entry, std::uint64_t* entries) {
    const auto child = static_cast<std::uint32_t>(entry >> 32);
    const auto planes = static_cast<std::uint32_t>(entry);
    if (child & tree::kLeafBit || planes & kWhole) {
        entries[0] = entry;
        return 1;
    }
    const tree::Node& node = input.nodes[child];
    const NodeTest test = test_node(*input.view, node, planes);
    std::size_t count = 0;
    const std::uint32_t whole = seen(*input.view, node, test.alive & test.settled);
    for (std::uint32_t alive = test.alive; alive; alive &= alive - 1) {
        const auto lane = static_cast<unsigned>(hwy::Num0BitsBelowLS1Bit_Nonzero32(alive));
        entries[count++] = tree_entry(node.child[lane], whole >> lane & 1 ? kWhole : test.planes[lane]);
    }
    return count;
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

void run_tree_kernel(const TreeKernelInput& input, const std::uint64_t* entries, std::size_t count,
                     TreeKernelOutput& output) {
    HWY_DYNAMIC_DISPATCH(RunTree)(input, entries, count, output);
}

}  // namespace crofton::cull
#endif
