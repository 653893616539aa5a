// SPDX-License-Identifier: MIT
// The traversal of a tree by one query. Included once per instruction set.
#if defined(CROFTON_CULL_TREE_WALK) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_CULL_TREE_WALK
#undef CROFTON_CULL_TREE_WALK
#else
#define CROFTON_CULL_TREE_WALK
#endif

#include <hwy/cache_control.h>
#include <hwy/highway.h>
#include <algorithm>
#include <crofton/cull/classify.hpp>
#include <cstddef>
#include <cstdint>

#include "limits/limit_tests-inl.hpp"
#include "tree/leaf_tests-inl.hpp"
#include "tree/open_list-inl.hpp"
#include "tree/tree_kernel.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::cull::HWY_NAMESPACE {

// In an entry's planes: everything below is inside, and in a layer that the view sees.
constexpr std::uint32_t kWhole = 1u << 31;
// Also in an entry's planes: something below may be beyond a draw limit.
constexpr std::uint32_t kLimited = 1u << 30;

// Traverses the tree from some entries down to the leaves.
template <class Limits, bool kCandidates = false>
class Walk {
  public:
    HWY_INLINE Walk(const TreeKernelInput& input, const TreeKernelOutput& output, const Limits& limits)
        : in_(input), out_(output), limits_(limits) {}

    // A copy of the output travels with the walk, so that the compiler keeps it in registers.
    [[nodiscard]] HWY_INLINE TreeKernelOutput result() const { return out_; }

    // Takes group after group of entries through the nodes. Notes what is fully inside, and the leaves that planes
    // cross. These leaves are tested when all nodes are done. The groups set the order of the answer.
    HWY_INLINE void run(const std::uint64_t* entries, std::size_t entry_count) {
        constexpr std::size_t kMaxGroups = boxtree::kWidth * boxtree::kWidth / kTreeGroup;
        std::size_t one_plane_ends[kMaxGroups + 1] = {}, many_plane_ends[kMaxGroups + 1] = {}, groups = 0;
        for (std::size_t first = 0; first < entry_count; first += kTreeGroup, ++groups) {
            descend(entries + first, std::min(kTreeGroup, entry_count - first));
            list_whole();
            one_plane_ends[groups + 1] = one_plane_leaves_.count;
            many_plane_ends[groups + 1] = many_plane_leaves_.count;
        }
        one_plane_leaves_.pad();
        many_plane_leaves_.pad();
        for (std::size_t i = 0; i < kLeavesAhead; ++i) prefetch_leaf(one_plane_leaves_.children[i]);
        if (out_.runs == nullptr) copy_runs();
        for (std::size_t g = 0; g < groups; ++g) {
            visit_one_plane_leaves(one_plane_ends[g], one_plane_ends[g + 1]);
            visit_many_plane_leaves(many_plane_ends[g], many_plane_ends[g + 1]);
        }
    }

  private:
    static constexpr std::size_t kNodesAhead = 4, kRunsAhead = 4, kLeavesAhead = kOpenPadding;

    // Visits the nodes level by level. Prefetches, and appends to lists without a branch on what is found.
    HWY_INLINE void descend(const std::uint64_t* entries, std::size_t count) {
        nodes_.count = whole_count_ = 0;
        for (std::size_t i = 0; i < count; ++i) start(entries[i]);
        for (std::size_t head = 0; head < nodes_.count; ++head) {
            if (head + kNodesAhead < nodes_.count) prefetch_node(nodes_.children[head + kNodesAhead]);
            if (head + 2 < nodes_.count) {
                const char* const axes =
                    reinterpret_cast<const char*>(in_.axes + in_.nodes[nodes_.children[head + 2]].axes);
                hwy::Prefetch(axes);
                hwy::Prefetch(axes + 64);
            }
            const std::uint32_t planes = nodes_.planes[head];
            const boxtree::Node& node = in_.nodes[nodes_.children[head]];
            if (kCountStatistics) out_.nodes_tested += node.count;
            if constexpr (Limits::kAny)
                if (planes & kLimited) {
                    visit_limited(node, nodes_.children[head], planes & ~kLimited);
                    continue;
                }
            const std::uint32_t candidates = kCandidates ? in_.nodes_with_candidates[nodes_.children[head]] : ~0u;
            if (is_one(planes))
                visit_one_plane_node(node, planes, candidates);
            else
                visit_many_plane_node(node, planes, candidates);
        }
    }

    static HWY_INLINE bool is_one(std::uint32_t planes) { return planes != 0 && (planes & (planes - 1)) == 0; }

    HWY_INLINE void start(std::uint64_t entry) {
        const auto child = static_cast<std::uint32_t>(entry >> 32);
        const auto planes = static_cast<std::uint32_t>(entry);
        if (planes & kWhole)
            whole_[whole_count_++] = child;
        else if (child & boxtree::kLeafBit)
            (is_one(planes) ? one_plane_leaves_ : many_plane_leaves_).append(child & ~boxtree::kLeafBit, planes);
        else
            nodes_.append(child, planes);
    }

    // Below the first levels most nodes that cross a frustum cross one plane.
    HWY_INLINE void visit_one_plane_node(const boxtree::Node& node, std::uint32_t planes, std::uint32_t candidates) {
        const DU du;
        const auto i = hwy::Num0BitsBelowLS1Bit_Nonzero32(planes);
        const BlockPlane plane = block_plane(*in_.view, i, node);
        const PairPlane normal = turned_.along(node.axes, planes)[i];
        for (std::size_t l = 0; l < boxtree::kWidth; l += hn::Lanes(du)) {
            const NodeSide side(NodeRows(node, l), normal, plane);
            MF alive = hn::AndNot(side.outside, present(*in_.view, node.layers_every, node.layers_any, node.count, l));
            if constexpr (kCandidates) alive = hn::And(alive, hn::RebindMask(DF(), mask_of(candidates >> l)));
            note<true>(node, l, alive, hn::IfThenZeroElse(hn::RebindMask(du, side.inside), hn::Set(du, planes)),
                       planes);
        }
    }

    HWY_INLINE void visit_many_plane_node(const boxtree::Node& node, std::uint32_t planes, std::uint32_t candidates) {
        const DU du;
        const NodeTest test = test_node(*in_.view, turned_.along(node.axes, planes), node, planes);
        for (std::size_t l = 0; l < boxtree::kWidth; l += hn::Lanes(du))
            note<false>(node, l, hn::RebindMask(DF(), mask_of((test.alive & candidates) >> l)),
                        hn::Load(du, test.planes + l));
    }

    // A node near a draw limit: its children are tested against planes and limits.
    HWY_INLINE void visit_limited(const boxtree::Node& node, boxtree::NodeId id, std::uint32_t planes) {
        const DU du;
        const NodeTest test = test_node(*in_.view, turned_.along(node.axes, planes), node, planes);
        for (std::size_t l = 0; l < boxtree::kWidth; l += hn::Lanes(du)) {
            const LimitTest limits = limits_.test(node, in_.axes[node.axes], id, l);
            const VU open = hn::IfThenZeroElse(hn::RebindMask(du, limits.kept), hn::Set(du, kLimited));
            note<false>(node, l, hn::AndNot(limits.dropped, hn::RebindMask(DF(), mask_of(test.alive >> l))),
                        hn::Or(hn::Load(du, test.planes + l), open));
        }
    }

    // Puts the children of a node from lane l on into lists, as far as they are `alive`: not certainly outside. kOnce:
    // none straddles any but `plane`.
    template <bool kOnce>
    HWY_INLINE void note(const boxtree::Node& node, std::size_t l, MF alive, VU straddled,
                         [[maybe_unused]] std::uint32_t plane = 0) {
        const DU du;
        const VU zero = hn::Zero(du), children = hn::Load(du, node.child + l);
        const auto lanes = hn::RebindMask(du, alive), straddles = hn::Ne(straddled, zero);
        auto whole = hn::AndNot(straddles, lanes);
        if (HWY_UNLIKELY(!(node.layers_every & in_.view->layer_mask))) {
            const VU seen = hn::And(hn::Load(du, node.layers_all + l), hn::Set(du, in_.view->layer_mask));
            whole = hn::And(whole, hn::Ne(seen, zero));
        }
        whole_count_ += simd::compress_store(du, children, whole, whole_ + whole_count_);
        const auto open = hn::AndNot(whole, lanes);
        const VU leaves = hn::AndNot(hn::Set(du, boxtree::kLeafBit), children);
        auto of_leaves = open;
        if (!node.only_leaves) {
            const auto is_node = hn::Eq(leaves, children);
            nodes_.append(children, straddled, hn::And(open, is_node));
            of_leaves = hn::AndNot(is_node, open);
        }
        // Where every child is in a layer that the view sees, a leaf is open only because it straddles a plane.
        if (kOnce && HWY_LIKELY(node.layers_every & in_.view->layer_mask))
            return one_plane_leaves_.append(leaves, plane, of_leaves);
        const auto few = hn::Eq(hn::And(straddled, hn::Sub(straddled, hn::Set(du, 1))), zero);
        auto once = hn::And(few, straddles);
        if constexpr (Limits::kAny) once = hn::And(once, hn::Lt(straddled, hn::Set(du, kLimited)));
        one_plane_leaves_.append(leaves, straddled, hn::And(of_leaves, once));
        many_plane_leaves_.append(leaves, straddled, hn::AndNot(once, of_leaves));
    }

    // Integers rather than pointers, because an empty tree has no elements.
    HWY_INLINE static void prefetch(const void* table, std::size_t from, std::size_t bytes) {
        const std::uintptr_t first = reinterpret_cast<std::uintptr_t>(table) + from;
        for (std::size_t at = 0; at < bytes; at += 64) hwy::Prefetch(reinterpret_cast<const char*>(first + at));
    }

    HWY_INLINE void prefetch_leaf(boxtree::LeafId leaf) const {
        prefetch(in_.leaves, leaf * sizeof(boxtree::Leaf), offsetof(boxtree::Leaf, layers));
        prefetch(in_.slot_items, std::size_t{leaf} * boxtree::kWidth * sizeof(*in_.slot_items), 1);
    }

    HWY_INLINE void prefetch_node(boxtree::NodeId node) const {
        prefetch(in_.nodes, node * sizeof(boxtree::Node), offsetof(boxtree::Node, layers_any));
        if constexpr (Limits::kAny) limits_.prefetch(node);
    }

    // Lists what is fully inside as runs of slots. A node whose leaves are not consecutive is replaced by its children,
    // which are appended to the list.
    HWY_INLINE void list_whole() {
        const std::size_t before = out_.whole_count;
        for (std::size_t i = 0; i < whole_count_; ++i) {
            const std::uint32_t child = whole_[i];
            if (child & boxtree::kLeafBit) {
                note_leaf(child & ~boxtree::kLeafBit);
                continue;
            }
            const boxtree::LeafRange range = in_.ranges[child];
            const boxtree::Node& node = in_.nodes[child];
            if (range.count == 0)
                for (std::uint32_t lane = 0; lane < node.count; ++lane) whole_[whole_count_++] = node.child[lane];
            else if (range.items > 0)
                note_run(range.first * boxtree::kWidth, range.items);
            else
                for (std::uint32_t leaf = range.first; leaf < range.first + range.count; ++leaf) note_leaf(leaf);
        }
        if (kCountStatistics) out_.accepted_whole += out_.whole_count - before;
    }

    HWY_INLINE void note_leaf(boxtree::LeafId leaf) { note_run(leaf * boxtree::kWidth, in_.leaf_counts[leaf]); }

    // Appends a run of slots, joined with the last one if it follows that.
    HWY_INLINE void note_run(std::uint32_t first, std::uint32_t items) {
        const bool follows = out_.run_count > 0 && run_end_ == first;
        out_.run_count += !follows;
        SlotRun& run = runs_[out_.run_count - 1];
        run.first = follows ? run.first : first;
        run_end_ = first + items;
        run.count = run_end_ - run.first;
        out_.whole_count += items;
    }

    HWY_INLINE void copy_runs() {
        const DU du;
        for (std::size_t r = 0; r < out_.run_count; ++r) {
            if (r + kRunsAhead < out_.run_count) hwy::Prefetch(in_.slot_items + runs_[r + kRunsAhead].first);
            const boxtree::ItemId* from = in_.slot_items + runs_[r].first;
            boxtree::ItemId* to = out_.inside + out_.inside_count;
            if constexpr (kCandidates) {
                for (std::size_t i = 0; i < runs_[r].count; i += hn::Lanes(du))
                    to += simd::compress_store(du, hn::Load(du, from + i), candidates(runs_[r].first + i), to);
                out_.inside_count = static_cast<std::size_t>(to - out_.inside);
                continue;
            }
            for (std::size_t i = 0; i < runs_[r].count; i += hn::Lanes(du))
                hn::StoreU(hn::Load(du, from + i), du, to + i);
            out_.inside_count += runs_[r].count;
        }
    }

    // Returns which of a vector's length of slots are candidates.
    HWY_INLINE auto candidates(std::size_t slot) const {
        return mask_of(std::uint32_t{in_.leaves_with_candidates[slot / boxtree::kWidth]} >> slot % boxtree::kWidth);
    }

    template <class V>
    static HWY_INLINE void append(const V& values, MF mask, std::uint32_t* list, std::size_t& count) {
        const DU du;
        count += simd::compress_store(du, values, hn::RebindMask(du, mask), list + count);
    }

    HWY_INLINE void emit(boxtree::LeafId id, std::size_t l, const BoxTest& test) {
        const DU du;
        const VU items = hn::Load(du, in_.slot_items + id * boxtree::kWidth + l);
        append(items, test.inside, out_.inside, out_.inside_count);
        append(items, test.straddling, out_.straddling, out_.straddling_count);
        if (kCountStatistics) out_.false_positives += hn::CountTrue(DF(), test.false_positives);
        if (HWY_UNLIKELY(!hn::AllFalse(DF(), test.undecided)))
            append(hn::Iota(du, static_cast<std::uint32_t>(id * boxtree::kWidth + l)), test.undecided, out_.undecided,
                   out_.undecided_count);
    }

    HWY_INLINE MF present_candidates(boxtree::LeafId id, const boxtree::Leaf& leaf, std::size_t l) const {
        const MF lanes = present(*in_.view, leaf.layers_every, leaf.layers, leaf.count, l);
        if constexpr (kCandidates)
            return hn::And(lanes, hn::RebindMask(DF(), candidates(id * boxtree::kWidth + l)));
        else
            return lanes;
    }

    HWY_INLINE void visit_one_plane_leaves(std::size_t begin, std::size_t end) {
        const KernelView& view = *in_.view;
        for (std::size_t at = begin; at < end; ++at) {
            prefetch_leaf(one_plane_leaves_.children[at + kLeavesAhead]);
            const boxtree::LeafId id = one_plane_leaves_.children[at];
            const boxtree::Leaf& leaf = in_.leaves[id];
            if (kCountStatistics) out_.boxes_tested += leaf.count;
            const auto i = hwy::Num0BitsBelowLS1Bit_Nonzero32(one_plane_leaves_.planes[at]);
            const LeafPlane plane{&view.pair_planes[i], block_plane(view, i, leaf)};
            for (std::size_t l = 0; l < boxtree::kWidth; l += hn::Lanes(DU())) {
                emit(id, l, test_leaf(LeafRows(leaf, l), present_candidates(id, leaf, l), plane));
            }
        }
    }

    HWY_INLINE void visit_many_plane_leaves(std::size_t begin, std::size_t end) {
        const KernelView& view = *in_.view;
        for (std::size_t at = begin; at < end; ++at) {
            prefetch_leaf(many_plane_leaves_.children[at + kLeavesAhead]);
            const boxtree::LeafId id = many_plane_leaves_.children[at];
            const boxtree::Leaf& leaf = in_.leaves[id];
            if (kCountStatistics) out_.boxes_tested += leaf.count;
            if constexpr (Limits::kAny)
                if (many_plane_leaves_.planes[at] & kLimited) {
                    visit_limited_leaf(id, many_plane_leaves_.planes[at] & ~kLimited);
                    continue;
                }
            LeafPlane planes[KernelView::kMaxPlanes];
            unsigned count = 0;
            for (std::uint32_t rest = many_plane_leaves_.planes[at]; rest; rest &= rest - 1) {
                const auto i = hwy::Num0BitsBelowLS1Bit_Nonzero32(rest);
                planes[count++] = {&view.pair_planes[i], block_plane(view, i, leaf)};
            }
            // Nearly all have two, which need no loop.
            for (std::size_t l = 0; l < boxtree::kWidth; l += hn::Lanes(DU())) {
                const MF lanes = present_candidates(id, leaf, l);
                emit(id, l,
                     HWY_LIKELY(count == 2) ? test_leaf(leaf, l, lanes, planes, 2, in_.exact)
                                            : test_leaf(leaf, l, lanes, planes, count, in_.exact));
            }
        }
    }

    HWY_INLINE void visit_limited_leaf(boxtree::LeafId id, std::uint32_t straddled) {
        const DU du;
        const KernelView& view = *in_.view;
        const boxtree::Leaf& leaf = in_.leaves[id];
        LeafPlane planes[KernelView::kMaxPlanes];
        unsigned count = 0;
        for (std::uint32_t rest = straddled; rest; rest &= rest - 1) {
            const auto i = hwy::Num0BitsBelowLS1Bit_Nonzero32(rest);
            planes[count++] = {&view.pair_planes[i], block_plane(view, i, leaf)};
        }
        for (std::size_t l = 0; l < boxtree::kWidth && l < leaf.count; l += hn::Lanes(du)) {
            const LimitTest limits = limits_.test(leaf, l);
            const MF lanes = hn::AndNot(limits.dropped, present(view, leaf.layers_every, leaf.layers, leaf.count, l));
            if (hn::AllFalse(DF(), lanes)) continue;
            const MF none = hn::FirstN(DF(), 0);
            BoxTest test{lanes, none, none, none, none};
            if (count == 1) test = test_leaf(LeafRows(leaf, l), lanes, planes[0]);
            if (count > 1) test = test_leaf(leaf, l, lanes, planes, count, in_.exact);
            const MF unsure = hn::AndNot(limits.kept, hn::Or(test.inside, test.straddling));
            test.inside = hn::And(test.inside, limits.kept);
            test.straddling = hn::And(test.straddling, limits.kept);
            test.undecided = hn::Or(test.undecided, unsure);
            emit(id, l, test);
        }
    }

    [[nodiscard]] HWY_INLINE std::uint32_t* work(std::size_t list) const { return out_.work + list * out_.work_size; }

    const TreeKernelInput& in_;
    TreeKernelOutput out_;
    TurnedPlanes turned_{*in_.view, in_.axes};
    OpenList nodes_{work(0), work(1)};              // open, from the first on
    OpenList one_plane_leaves_{work(2), work(3)};   // that one plane crosses
    OpenList many_plane_leaves_{work(4), work(5)};  // that several cross: fewer, and slower to test
    std::uint32_t* whole_ = work(6);                // children that lie inside as a whole
    std::size_t whole_count_ = 0;
    SlotRun* runs_ = out_.runs != nullptr ? out_.runs : reinterpret_cast<SlotRun*>(work(7));
    std::uint32_t run_end_ = 0;
    Limits limits_;
};

}  // namespace crofton::cull::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
