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

// Traverses the tree from some entries down to the leaves. With kMoved, traverses several trees at once, and prefetches
// their nodes and leaves as those of one tree.
template <class Limits, bool kCandidates = false, bool kMoved = false>
class Walk {
  public:
    // With kMoved, `inputs` has an entry for each tree; otherwise one.
    HWY_INLINE Walk(const TreeKernelInput* inputs, const TreeKernelOutput& output, const Limits& limits)
        : in_(inputs), out_(output), limits_(limits) {}

    // A copy of the output travels with the walk, so that the compiler keeps it in registers.
    [[nodiscard]] HWY_INLINE TreeKernelOutput result() const { return out_; }

    // Takes group after group of entries through the nodes. Notes what is fully inside, and the leaves that planes
    // cross. These leaves are tested when all nodes are done. The groups set the order of the answer.
    HWY_INLINE void run(const std::uint64_t* entries, std::size_t entry_count) {
        constexpr std::size_t kMaxGroups = boxtree::kWidth * boxtree::kWidth / kTreeGroup;
        std::size_t one_plane_ends[kMaxGroups + 1] = {}, many_plane_ends[kMaxGroups + 1] = {}, groups = 0;
        const std::size_t group = kMoved ? entry_count : kTreeGroup;
        for (std::size_t first = 0; first < entry_count; first += group, ++groups) {
            descend(entries + first, std::min(group, entry_count - first));
            list_whole();
            one_plane_ends[groups + 1] = one_plane_leaves_.count;
            many_plane_ends[groups + 1] = many_plane_leaves_.count;
        }
        one_plane_leaves_.pad();
        many_plane_leaves_.pad();
        for (std::size_t i = 0; i < kLeavesAhead; ++i) prefetch_leaf(one_plane_leaves_, i);
        if (out_.runs == nullptr) copy_runs();
        for (std::size_t g = 0; g < groups; ++g) {
            visit_one_plane_leaves(one_plane_ends[g], one_plane_ends[g + 1]);
            visit_many_plane_leaves(many_plane_ends[g], many_plane_ends[g + 1]);
        }
    }

  private:
    static constexpr std::size_t kNodesAhead = 4, kRunsAhead = 4, kLeavesAhead = kOpenPadding;

    // The tree that an entry belongs to is marked in its planes.
    [[nodiscard]] HWY_INLINE const TreeKernelInput& tree_of(std::uint32_t marked) const {
        return kMoved ? in_[tree_mark_of(marked)] : in_[0];
    }
    [[nodiscard]] HWY_INLINE const ViewPlace& place_in(const TreeKernelInput& tree) const {
        if constexpr (kMoved) return *tree.place;
        return *in_->view;
    }
    static HWY_INLINE std::uint32_t planes_of(std::uint32_t marked) {
        return kMoved ? marked & ((1u << kTreeMarkShift) - 1) : marked;
    }
    static HWY_INLINE std::uint32_t mark_of(std::uint32_t marked) { return kMoved ? marked - planes_of(marked) : 0; }

    // Visits the nodes level by level. Prefetches, and appends to lists without a branch on what is found.
    HWY_INLINE void descend(const std::uint64_t* entries, std::size_t count) {
        nodes_.count = whole_count_ = 0;
        for (std::size_t i = 0; i < count; ++i) start(entries[i]);
        if constexpr (kMoved)
            for (std::size_t i = 0; i < std::min(kNodesAhead, nodes_.count); ++i) prefetch_node(i);
        for (std::size_t head = 0; head < nodes_.count; ++head) {
            if (head + kNodesAhead < nodes_.count) prefetch_node(head + kNodesAhead);
            if (head + 2 < nodes_.count) {
                const TreeKernelInput& next = tree_of(nodes_.planes[head + 2]);
                const char* const axes =
                    reinterpret_cast<const char*>(next.axes + next.nodes[nodes_.children[head + 2]].axes);
                hwy::Prefetch(axes);
                hwy::Prefetch(axes + 64);
            }
            const std::uint32_t marked = nodes_.planes[head], planes = planes_of(marked);
            const TreeKernelInput& tree = tree_of(marked);
            const boxtree::Node& node = tree.nodes[nodes_.children[head]];
            if (kCountStatistics) out_.nodes_tested += node.count;
            if constexpr (Limits::kAny)
                if (planes & kLimited) {
                    visit_limited(node, nodes_.children[head], planes & ~kLimited);
                    continue;
                }
            const std::uint32_t candidates = kCandidates ? tree.nodes_with_candidates[nodes_.children[head]] : ~0u;
            if (is_one(planes))
                visit_one_plane_node(tree, node, marked, candidates);
            else
                visit_many_plane_node(tree, node, marked, candidates);
        }
    }

    static HWY_INLINE bool is_one(std::uint32_t planes) { return planes != 0 && (planes & (planes - 1)) == 0; }

    HWY_INLINE void start(std::uint64_t entry) {
        const auto child = static_cast<std::uint32_t>(entry >> 32);
        const auto planes = static_cast<std::uint32_t>(entry);
        if (planes & kWhole)
            whole_[whole_count_++] = child;
        else if (child & boxtree::kLeafBit)
            (is_one(planes_of(planes)) ? one_plane_leaves_ : many_plane_leaves_)
                .append(child & ~boxtree::kLeafBit, planes);
        else
            nodes_.append(child, planes);
    }

    // Below the first levels most nodes that cross a frustum cross one plane.
    HWY_INLINE void visit_one_plane_node(const TreeKernelInput& tree, const boxtree::Node& node, std::uint32_t marked,
                                         std::uint32_t candidates) {
        const DU du;
        const std::uint32_t planes = planes_of(marked);
        const auto i = hwy::Num0BitsBelowLS1Bit_Nonzero32(planes);
        const BlockPlane plane = block_plane(*in_->view, place_in(tree), i, node);
        const PairPlane normal = turned_.along(tree.axes, node.axes, planes)[i];
        for (std::size_t l = 0; l < boxtree::kWidth; l += hn::Lanes(du)) {
            const NodeSide side(NodeRows(node, l), normal, plane);
            MF alive = hn::AndNot(side.outside, present(*in_->view, node.layers_every, node.layers_any, node.count, l));
            if constexpr (kCandidates) alive = hn::And(alive, hn::RebindMask(DF(), mask_of(candidates >> l)));
            note<true>(node, l, alive, hn::IfThenZeroElse(hn::RebindMask(du, side.inside), hn::Set(du, planes)),
                       marked);
        }
    }

    HWY_INLINE void visit_many_plane_node(const TreeKernelInput& tree, const boxtree::Node& node, std::uint32_t marked,
                                          std::uint32_t candidates) {
        const DU du;
        const std::uint32_t planes = planes_of(marked);
        const NodeTest test =
            test_node(*in_->view, place_in(tree), turned_.along(tree.axes, node.axes, planes), node, planes);
        for (std::size_t l = 0; l < boxtree::kWidth; l += hn::Lanes(du))
            note<false>(node, l, hn::RebindMask(DF(), mask_of((test.alive & candidates) >> l)),
                        hn::Load(du, test.planes + l), marked);
    }

    // A node near a draw limit: its children are tested against planes and limits.
    HWY_INLINE void visit_limited(const boxtree::Node& node, boxtree::NodeId id, std::uint32_t planes) {
        const DU du;
        const NodeTest test =
            test_node(*in_->view, *in_->view, turned_.along(in_->axes, node.axes, planes), node, planes);
        for (std::size_t l = 0; l < boxtree::kWidth; l += hn::Lanes(du)) {
            const LimitTest limits = limits_.test(node, in_->axes[node.axes], id, l);
            const VU open = hn::IfThenZeroElse(hn::RebindMask(du, limits.kept), hn::Set(du, kLimited));
            note<false>(node, l, hn::AndNot(limits.dropped, hn::RebindMask(DF(), mask_of(test.alive >> l))),
                        hn::Or(hn::Load(du, test.planes + l), open));
        }
    }

    // Puts the children of a node from lane l on into lists, as far as they are `alive`: not certainly outside. The
    // node's own entry has the planes `marked`. kOnce: that is one plane.
    template <bool kOnce>
    HWY_INLINE void note(const boxtree::Node& node, std::size_t l, MF alive, VU straddled,
                         [[maybe_unused]] std::uint32_t marked = 0) {
        const DU du;
        const VU zero = hn::Zero(du), children = hn::Load(du, node.child + l);
        const auto lanes = hn::RebindMask(du, alive), straddles = hn::Ne(straddled, zero);
        auto whole = hn::AndNot(straddles, lanes);
        if (HWY_UNLIKELY(!(node.layers_every & in_->view->layer_mask))) {
            const VU seen = hn::And(hn::Load(du, node.layers_all + l), hn::Set(du, in_->view->layer_mask));
            whole = hn::And(whole, hn::Ne(seen, zero));
        }
        if constexpr (kMoved) hn::StoreU(hn::Set(du, mark_of(marked)), du, whole_marks_ + whole_count_);
        whole_count_ += simd::compress_store(du, children, whole, whole_ + whole_count_);
        const auto open = hn::AndNot(whole, lanes);
        const VU leaves = hn::AndNot(hn::Set(du, boxtree::kLeafBit), children);
        auto of_leaves = open;
        if (!node.only_leaves) {
            const auto is_node = hn::Eq(leaves, children);
            nodes_.append(children, with_mark(straddled, marked), hn::And(open, is_node));
            of_leaves = hn::AndNot(is_node, open);
        }
        // Where every child is in a layer that the view sees, a leaf is open only because it straddles a plane.
        if (kOnce && HWY_LIKELY(node.layers_every & in_->view->layer_mask))
            return one_plane_leaves_.append(leaves, marked, of_leaves);
        const auto few = hn::Eq(hn::And(straddled, hn::Sub(straddled, hn::Set(du, 1))), zero);
        auto once = hn::And(few, straddles);
        if constexpr (Limits::kAny) once = hn::And(once, hn::Lt(straddled, hn::Set(du, kLimited)));
        one_plane_leaves_.append(leaves, with_mark(straddled, marked), hn::And(of_leaves, once));
        many_plane_leaves_.append(leaves, with_mark(straddled, marked), hn::AndNot(once, of_leaves));
    }

    static HWY_INLINE VU with_mark(VU planes, std::uint32_t marked) {
        if constexpr (kMoved)
            return hn::Or(planes, hn::Set(DU(), mark_of(marked)));
        else
            return planes;
    }

    // Integers rather than pointers, because an empty tree has no elements.
    HWY_INLINE static void prefetch(const void* table, std::size_t from, std::size_t bytes) {
        const std::uintptr_t first = reinterpret_cast<std::uintptr_t>(table) + from;
        for (std::size_t at = 0; at < bytes; at += 64) hwy::Prefetch(reinterpret_cast<const char*>(first + at));
    }

    HWY_INLINE void prefetch_leaf(const OpenList& list, std::size_t i) const {
        const boxtree::LeafId leaf = list.children[i];
        const TreeKernelInput& tree = tree_of(list.planes[i]);
        prefetch(tree.leaves, leaf * sizeof(boxtree::Leaf), offsetof(boxtree::Leaf, layers));
        prefetch(tree.slot_items, std::size_t{leaf} * boxtree::kWidth * sizeof(*tree.slot_items), 1);
    }

    HWY_INLINE void prefetch_node(std::size_t i) const {
        const boxtree::NodeId node = nodes_.children[i];
        prefetch(tree_of(nodes_.planes[i]).nodes, node * sizeof(boxtree::Node), offsetof(boxtree::Node, layers_any));
        if constexpr (Limits::kAny) limits_.prefetch(node);
    }

    // Lists what is fully inside as runs of slots. A node whose leaves are not consecutive is replaced by its children,
    // which are appended to the list.
    HWY_INLINE void list_whole() {
        const std::size_t before = out_.whole_count;
        for (std::size_t i = 0; i < whole_count_; ++i) {
            const std::uint32_t child = whole_[i], mark = kMoved ? whole_marks_[i] : 0;
            if (child & boxtree::kLeafBit) {
                note_leaf(child & ~boxtree::kLeafBit, mark);
                continue;
            }
            const boxtree::LeafRange range = tree_of(mark).ranges[child];
            const boxtree::Node& node = tree_of(mark).nodes[child];
            if (range.count == 0)
                for (std::uint32_t lane = 0; lane < node.count; ++lane) {
                    if constexpr (kMoved) whole_marks_[whole_count_] = mark;
                    whole_[whole_count_++] = node.child[lane];
                }
            else if (range.items > 0)
                note_run(range.first * boxtree::kWidth, range.items, mark);
            else
                for (std::uint32_t leaf = range.first; leaf < range.first + range.count; ++leaf) note_leaf(leaf, mark);
        }
        if (kCountStatistics) out_.accepted_whole += out_.whole_count - before;
    }

    HWY_INLINE void note_leaf(boxtree::LeafId leaf, std::uint32_t mark) {
        note_run(leaf * boxtree::kWidth, tree_of(mark).leaf_counts[leaf], mark);
    }

    // Appends a run of slots, joined with the last one if it follows that.
    HWY_INLINE void note_run(std::uint32_t first, std::uint32_t items, [[maybe_unused]] std::uint32_t mark) {
        bool follows = out_.run_count > 0 && run_end_ == first;
        if constexpr (kMoved) follows = follows && run_marks_[out_.run_count - 1] == mark;
        out_.run_count += !follows;
        if constexpr (kMoved) run_marks_[out_.run_count - 1] = mark;
        SlotRun& run = runs_[out_.run_count - 1];
        run.first = follows ? run.first : first;
        run_end_ = first + items;
        run.count = run_end_ - run.first;
        out_.whole_count += items;
    }

    HWY_INLINE void copy_runs() {
        const DU du;
        for (std::size_t r = 0; r < out_.run_count; ++r) {
            if (r + kRunsAhead < out_.run_count)
                hwy::Prefetch(tree_of_run(r + kRunsAhead).slot_items + runs_[r + kRunsAhead].first);
            const TreeKernelInput& tree = tree_of_run(r);
            const boxtree::ItemId* from = tree.slot_items + runs_[r].first;
            boxtree::ItemId* to = out_.inside + out_.inside_count;
            if constexpr (kCandidates) {
                for (std::size_t i = 0; i < runs_[r].count; i += hn::Lanes(du))
                    to += simd::compress_store(du, hn::Load(du, from + i), candidates(runs_[r].first + i), to);
                out_.inside_count = static_cast<std::size_t>(to - out_.inside);
                continue;
            }
            for (std::size_t i = 0; i < runs_[r].count; i += hn::Lanes(du))
                hn::StoreU(moved_ids(tree, hn::Load(du, from + i)), du, to + i);
            out_.inside_count += runs_[r].count;
        }
    }

    HWY_INLINE const TreeKernelInput& tree_of_run(std::size_t r) const {
        return kMoved ? tree_of(run_marks_[r]) : in_[0];
    }

    static HWY_INLINE VU moved_ids(const TreeKernelInput& tree, VU ids) {
        if constexpr (kMoved)
            return hn::Add(ids, hn::Set(DU(), tree.first_id));
        else
            return ids;
    }

    // Returns which of a vector's length of slots are candidates.
    HWY_INLINE auto candidates(std::size_t slot) const {
        return mask_of(std::uint32_t{in_->leaves_with_candidates[slot / boxtree::kWidth]} >> slot % boxtree::kWidth);
    }

    template <class V>
    static HWY_INLINE void append(const V& values, MF mask, std::uint32_t* list, std::size_t& count) {
        const DU du;
        count += simd::compress_store(du, values, hn::RebindMask(du, mask), list + count);
    }

    HWY_INLINE void emit(const TreeKernelInput& tree, [[maybe_unused]] std::uint32_t mark, boxtree::LeafId id,
                         std::size_t l, const BoxTest& test) {
        const DU du;
        const VU items = moved_ids(tree, hn::Load(du, tree.slot_items + id * boxtree::kWidth + l));
        append(items, test.inside, out_.inside, out_.inside_count);
        append(items, test.straddling, out_.straddling, out_.straddling_count);
        if (kCountStatistics) out_.false_positives += hn::CountTrue(DF(), test.false_positives);
        if (HWY_UNLIKELY(!hn::AllFalse(DF(), test.undecided))) {
            if constexpr (kMoved)
                hn::StoreU(hn::Set(du, tree_mark_of(mark)), du, out_.undecided_trees + out_.undecided_count);
            append(hn::Iota(du, static_cast<std::uint32_t>(id * boxtree::kWidth + l)), test.undecided, out_.undecided,
                   out_.undecided_count);
        }
    }

    HWY_INLINE MF present_candidates(boxtree::LeafId id, const boxtree::Leaf& leaf, std::size_t l) const {
        const MF lanes = present(*in_->view, leaf.layers_every, leaf.layers, leaf.count, l);
        if constexpr (kCandidates)
            return hn::And(lanes, hn::RebindMask(DF(), candidates(id * boxtree::kWidth + l)));
        else
            return lanes;
    }

    // Leaves of one tree follow each other: its pointers stay in registers.
    HWY_INLINE void visit_one_plane_leaves(std::size_t begin, std::size_t end) {
        for (std::size_t at = begin; at < end;) {
            const std::uint32_t mark = mark_of(one_plane_leaves_.planes[at]);
            const TreeKernelInput tree = tree_of(mark);
            do {
                prefetch_leaf(one_plane_leaves_, at + kLeavesAhead);
                visit_one_plane_leaf(tree, mark, one_plane_leaves_.children[at],
                                     planes_of(one_plane_leaves_.planes[at]));
            } while (++at < end && mark_of(one_plane_leaves_.planes[at]) == mark);
        }
    }

    HWY_INLINE void visit_one_plane_leaf(const TreeKernelInput& tree, std::uint32_t mark, boxtree::LeafId id,
                                         std::uint32_t planes) {
        const KernelView& view = *in_->view;
        const boxtree::Leaf& leaf = tree.leaves[id];
        if (kCountStatistics) out_.boxes_tested += leaf.count;
        const auto i = hwy::Num0BitsBelowLS1Bit_Nonzero32(planes);
        const LeafPlane plane{&view.pair_planes[i], block_plane(view, place_in(tree), i, leaf)};
        for (std::size_t l = 0; l < boxtree::kWidth; l += hn::Lanes(DU()))
            emit(tree, mark, id, l, test_leaf(LeafRows(leaf, l), present_candidates(id, leaf, l), plane));
    }

    HWY_INLINE void visit_many_plane_leaves(std::size_t begin, std::size_t end) {
        for (std::size_t at = begin; at < end;) {
            const std::uint32_t mark = mark_of(many_plane_leaves_.planes[at]);
            const TreeKernelInput tree = tree_of(mark);
            do {
                prefetch_leaf(many_plane_leaves_, at + kLeavesAhead);
                visit_many_plane_leaf(tree, mark, many_plane_leaves_.children[at],
                                      planes_of(many_plane_leaves_.planes[at]));
            } while (++at < end && mark_of(many_plane_leaves_.planes[at]) == mark);
        }
    }

    HWY_INLINE void visit_many_plane_leaf(const TreeKernelInput& tree, std::uint32_t mark, boxtree::LeafId id,
                                          std::uint32_t straddled) {
        const KernelView& view = *in_->view;
        const boxtree::Leaf& leaf = tree.leaves[id];
        if (kCountStatistics) out_.boxes_tested += leaf.count;
        if constexpr (Limits::kAny)
            if (straddled & kLimited) return visit_limited_leaf(id, straddled & ~kLimited);
        LeafPlane planes[KernelView::kMaxPlanes];
        unsigned count = 0;
        for (std::uint32_t rest = straddled; rest; rest &= rest - 1) {
            const auto i = hwy::Num0BitsBelowLS1Bit_Nonzero32(rest);
            planes[count++] = {&view.pair_planes[i], block_plane(view, place_in(tree), i, leaf)};
        }
        // Nearly all have two, which need no loop.
        for (std::size_t l = 0; l < boxtree::kWidth; l += hn::Lanes(DU())) {
            const MF lanes = present_candidates(id, leaf, l);
            emit(tree, mark, id, l,
                 HWY_LIKELY(count == 2) ? test_leaf(leaf, l, lanes, planes, 2, in_->exact)
                                        : test_leaf(leaf, l, lanes, planes, count, in_->exact));
        }
    }

    HWY_INLINE void visit_limited_leaf(boxtree::LeafId id, std::uint32_t straddled) {
        const DU du;
        const KernelView& view = *in_->view;
        const boxtree::Leaf& leaf = in_->leaves[id];
        LeafPlane planes[KernelView::kMaxPlanes];
        unsigned count = 0;
        for (std::uint32_t rest = straddled; rest; rest &= rest - 1) {
            const auto i = hwy::Num0BitsBelowLS1Bit_Nonzero32(rest);
            planes[count++] = {&view.pair_planes[i], block_plane(view, view, i, leaf)};
        }
        for (std::size_t l = 0; l < boxtree::kWidth && l < leaf.count; l += hn::Lanes(du)) {
            const LimitTest limits = limits_.test(leaf, l);
            const MF lanes = hn::AndNot(limits.dropped, present(view, leaf.layers_every, leaf.layers, leaf.count, l));
            if (hn::AllFalse(DF(), lanes)) continue;
            const MF none = hn::FirstN(DF(), 0);
            BoxTest test{lanes, none, none, none, none};
            if (count == 1) test = test_leaf(LeafRows(leaf, l), lanes, planes[0]);
            if (count > 1) test = test_leaf(leaf, l, lanes, planes, count, in_->exact);
            const MF unsure = hn::AndNot(limits.kept, hn::Or(test.inside, test.straddling));
            test.inside = hn::And(test.inside, limits.kept);
            test.straddling = hn::And(test.straddling, limits.kept);
            test.undecided = hn::Or(test.undecided, unsure);
            emit(*in_, 0, id, l, test);
        }
    }

    [[nodiscard]] HWY_INLINE std::uint32_t* work(std::size_t list) const { return out_.work + list * out_.work_size; }

    const TreeKernelInput* in_;
    TreeKernelOutput out_;
    TurnedPlanes turned_{*in_->view};
    OpenList nodes_{work(0), work(1)};              // open, from the first on
    OpenList one_plane_leaves_{work(2), work(3)};   // that one plane crosses
    OpenList many_plane_leaves_{work(4), work(5)};  // that several cross: fewer, and slower to test
    std::uint32_t* whole_ = work(6);                // children that lie inside as a whole
    std::size_t whole_count_ = 0;
    SlotRun* runs_ = out_.runs != nullptr ? out_.runs : reinterpret_cast<SlotRun*>(work(7));
    std::uint32_t run_end_ = 0;
    std::uint32_t* whole_marks_ = kMoved ? work(9) : nullptr;  // with kMoved: what marks the trees of whole_ and runs_
    std::uint32_t* run_marks_ = kMoved ? work(10) : nullptr;
    Limits limits_;
};

}  // namespace crofton::cull::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
