// SPDX-License-Identifier: MIT
// One view's questions to many trees: what depends on the view alone is computed once, and the trees are walked
// together.
#include <hwy/cache_control.h>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <crofton/core/error.hpp>
#include <crofton/cull/moved_tree.hpp>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "exact/box_constraints.hpp"
#include "id_bits_kernel.hpp"
#include "tree/block_planes.hpp"
#include "tree/query.hpp"

namespace crofton::cull {
namespace {

constexpr std::size_t kRoomBehind = 64;  // each list, for vector stores

std::size_t words_of(const MovedTree& tree) {
    return (std::size_t{tree.arrays.item_count} + 63) / 64;
}

}  // namespace

MovedTree moved_tree_of(const boxtree::BoxTree& tree, const Move& move, std::uint32_t first_id) {
    MovedTree result;
    result.arrays = boxtree::arrays_of(tree);
    result.first_id = first_id;
    const boxtree::Node& root = result.arrays.nodes[0];
    result.root_l1_radius = root.l1_radius;
    std::copy_n(root.origin, 3, result.root_origin);
    result.move = move;
    return result;
}

struct MovedTreesQuery::State {
    static_assert(kMost == kMostMovedTrees);
    // How many items of trees are inside and straddling.
    struct Found {
        std::size_t inside = 0, straddling = 0;
    };

    const View* view = nullptr;
    bool usable = false;  // by filters
    KernelView planes_of_view;
    Statistics statistics;
    std::array<ViewPlace, kMost> places;
    std::array<TreeKernelInput, kMost> inputs;
    std::array<std::uint32_t, kMost> planes;
    RawBuffer<std::uint32_t> inside, straddling, undecided, undecided_trees, work;
    // For list(): bits of what is seen and of what straddles, tree by tree; where each tree's words begin.
    Vector<std::uint64_t> bits;
    std::array<std::size_t, kMost + 1> first_word;
    std::array<const MovedTree*, kMost> trees;

    void bring_before_tree(std::size_t t, const Asked& asked);
    void add(bool is_inside, std::uint32_t id, std::uint32_t* inside_ids, std::uint32_t* straddling_ids, Found& found);
    Found ask(std::span<const Asked> asked, CullMode mode, std::span<const std::uint32_t> first_ids,
              std::uint32_t* inside_ids, std::uint32_t* straddling_ids);
    Found ask_each(std::span<const Asked> asked, CullMode mode, std::span<const std::uint32_t> first_ids,
                   std::uint32_t* inside_ids, std::uint32_t* straddling_ids);
};

MovedTreesQuery::MovedTreesQuery() : state_(Owner<State>::make()) {}
MovedTreesQuery::~MovedTreesQuery() = default;

const Statistics& MovedTreesQuery::statistics() const {
    return state_->statistics;
}

void MovedTreesQuery::start(const View& view) {
    state_->view = &view;
    state_->usable = is_usable(view.frustum) && has_unit_normals(view.frustum);
    if (state_->usable) state_->planes_of_view = kernel_view_of(view);
    state_->statistics = {};
}

// In double: some twenty roundings of 2^-53 of sums of the sizes below, with normals of up to 1.001 a component.
std::uint32_t MovedTreesQuery::planes_that_may_cut(const Obb& box) const {
    const Frustum& frustum = state_->view->frustum;
    std::uint32_t planes = 0;
    if (!state_->usable) return ~0u;
    const glm::dvec3 at = box.center - frustum.origin, half(box.half_extents);
    const double size = glm::dot(glm::abs(box.center) + glm::abs(frustum.origin) + 2.0 * half, glm::dvec3(1.0));
    for (std::uint32_t i = 0; i < frustum.plane_count; ++i) {
        const Plane& plane = frustum.planes[i];
        const double error_bound = 0x1p-47 * (size + std::abs(plane.offset));
        const double lowest = glm::dot(plane.normal, at) + plane.offset - glm::dot(half, glm::abs(plane.normal));
        planes |= std::uint32_t{!(lowest > error_bound)} << i;
    }
    return planes;
}

// A moved tree is met by the view moved back, with wider error bounds: a plane's value is off by |normal| ≤ 1.001 for
// each component times what the point is off by.
void MovedTreesQuery::State::bring_before_tree(std::size_t t, const Asked& asked) {
    const MovedTree& tree = *asked.tree;
    ViewPlace& place = places[t];
    const glm::dvec3 origin = tree.move.back(view->frustum.origin);
    for (int j = 0; j < 3; ++j) place.origin[j] = origin[j];
    const double rounding = tree.move.rounding(view->frustum.origin);
    bring_before(tree.root_origin, tree.root_l1_radius, asked.planes, planes_of_view, place);
    for (std::uint32_t rest = asked.planes; rest; rest &= rest - 1) place.far[std::countr_zero(rest)] += rounding;
}

void MovedTreesQuery::State::add(bool is_inside, std::uint32_t id, std::uint32_t* inside_ids,
                                 std::uint32_t* straddling_ids, Found& found) {
    if (is_inside)
        inside_ids[found.inside++] = id;
    else
        straddling_ids[found.straddling++] = id;
}

MovedTreesQuery::State::Found MovedTreesQuery::State::ask(std::span<const Asked> asked, CullMode mode,
                                                          std::span<const std::uint32_t> first_ids,
                                                          std::uint32_t* inside_ids, std::uint32_t* straddling_ids) {
    if (asked.empty()) return {};
    if (!usable) return ask_each(asked, mode, first_ids, inside_ids, straddling_ids);
    std::size_t items = 0, blocks = 0;
    for (std::size_t t = 0; t < asked.size(); ++t) {
        const MovedTree& tree = *asked[t].tree;
        bring_before_tree(t, asked[t]);
        inputs[t] = {.nodes = tree.arrays.nodes,
                     .leaves = tree.arrays.leaves,
                     .ranges = tree.arrays.ranges,
                     .leaf_counts = tree.arrays.leaf_counts,
                     .slot_items = tree.arrays.slot_items,
                     .axes = tree.arrays.axes,
                     .view = &planes_of_view,
                     .exact = mode == CullMode::exact,
                     .first_id = first_ids[t],
                     .place = &places[t]};
        planes[t] = asked[t].planes;
        // The walk meets these behind nodes and leaves, which it prefetches itself.
        hwy::Prefetch(tree.arrays.ranges);
        hwy::Prefetch(tree.arrays.leaf_counts);
        items += tree.arrays.item_count;
        blocks += std::size_t{tree.arrays.node_count} + tree.arrays.leaf_count;
    }
    TreeKernelOutput output{};
    output.inside = inside_ids;
    output.straddling = straddling_ids;
    output.undecided = undecided.room(items + kRoomBehind);
    output.undecided_trees = undecided_trees.room(items + kRoomBehind);
    output.work_size = blocks + boxtree::kWidth;
    output.work = work.room(kMovedWorkLists * output.work_size + kRoomBehind);
    run_moved_trees_kernel(inputs.data(), planes.data(), asked.size(), output);
    Found found{output.inside_count, output.straddling_count};
    for (std::size_t i = 0; i < output.undecided_count; ++i) {
        const std::size_t t = undecided_trees.data()[i];
        const MovedTree& tree = *asked[t].tree;
        const boxtree::ItemId item = tree.arrays.slot_items[undecided.data()[i]];
        const Obb box = tree.move(tree.arrays.boxes[item]);
        const Verdict verdict = classify_usable(view->frustum, box, mode);
        if (verdict != Verdict::outside)
            add(verdict == Verdict::inside, first_ids[t] + item, inside_ids, straddling_ids, found);
        else if (kCountStatistics && mode == CullMode::exact)
            output.false_positives += classify_usable(view->frustum, box, CullMode::conservative) != Verdict::outside;
    }
    if (kCountStatistics)
        statistics += {output.nodes_tested,    output.boxes_tested,   output.accepted_whole, 0,
                       output.undecided_count, output.false_positives};
    return found;
}

// A view that the kernels cannot take is tested item by item. If it is not finite, everything may be visible.
MovedTreesQuery::State::Found MovedTreesQuery::State::ask_each(std::span<const Asked> asked, CullMode mode,
                                                               std::span<const std::uint32_t> first_ids,
                                                               std::uint32_t* inside_ids,
                                                               std::uint32_t* straddling_ids) {
    Found found;
    for (std::size_t t = 0; t < asked.size(); ++t) {
        const MovedTree& tree = *asked[t].tree;
        for (boxtree::LeafId l = 0; l < tree.arrays.leaf_count; ++l)
            for (std::uint32_t lane = 0; lane < tree.arrays.leaves[l].count; ++lane) {
                if (!(tree.arrays.leaves[l].layers[lane] & view->layer_mask)) continue;
                const boxtree::ItemId item = tree.arrays.slot_items[l * boxtree::kWidth + lane];
                const Verdict verdict = classify(view->frustum, tree.move(tree.arrays.boxes[item]), mode);
                if (verdict != Verdict::outside)
                    add(verdict == Verdict::inside, first_ids[t] + item, inside_ids, straddling_ids, found);
            }
    }
    return found;
}

std::size_t MovedTreesQuery::find_visible(std::span<const Asked> trees, CullMode mode,
                                          AnswerList<std::uint32_t>& inside, AnswerList<std::uint32_t>& straddling) {
    std::array<std::uint32_t, kMost> first_ids;
    std::size_t items = 0;
    for (std::size_t t = 0; t < trees.size(); ++t) {
        first_ids[t] = trees[t].tree->first_id;
        items += trees[t].tree->arrays.item_count;
    }
    const State::Found found =
        state_->ask(trees, mode, first_ids, inside.room(items + kRoomBehind), straddling.room(items + kRoomBehind));
    inside.grow(found.inside);
    straddling.grow(found.straddling);
    if (kCountStatistics) state_->statistics.straddling += found.straddling;
    return found.inside;
}

// The trees' items get ids one tree after the other, each from a word's begin on.
void MovedTreesQuery::find_visible(std::span<const Asked> trees, CullMode mode) {
    State& state = *state_;
    std::array<std::uint32_t, kMost> first_ids;
    state.first_word[0] = 0;
    for (std::size_t t = 0; t < trees.size(); ++t) {
        state.trees[t] = trees[t].tree;
        first_ids[t] = static_cast<std::uint32_t>(64 * state.first_word[t]);
        state.first_word[t + 1] = state.first_word[t] + words_of(*trees[t].tree);
    }
    const std::size_t words = state.first_word[trees.size()] + 1;  // one more for the kernel
    std::uint32_t* const inside = state.inside.room(64 * words + kRoomBehind);
    std::uint32_t* const straddling = state.straddling.room(64 * words + kRoomBehind);
    const State::Found found = state.ask(trees, mode, first_ids, inside, straddling);
    state.bits.assign(2 * words, 0);
    std::uint64_t *const seen = state.bits.data(), *const marked = seen + words;
    mark_ids_kernel(inside, found.inside, seen);
    mark_ids_kernel(straddling, found.straddling, marked);
    for (std::size_t w = 0; w < words; ++w) seen[w] |= marked[w];
}

void MovedTreesQuery::list_all(const MovedTree& tree, AnswerList<std::uint32_t>& ids) {
    const std::uint32_t first = tree.first_id, count = tree.arrays.item_count;
    std::uint32_t* const to = ids.extend(count);
    for (std::uint32_t i = 0; i < count; ++i) to[i] = first + i;
}

std::size_t MovedTreesQuery::list(std::size_t tree, std::span<const std::uint64_t> shown,
                                  AnswerList<std::uint32_t>& ids, AnswerList<Verdict>& verdicts) {
    State& state = *state_;
    const std::size_t words = words_of(*state.trees[tree]), all_words = state.bits.size() / 2;
    std::uint64_t* const seen = state.bits.data() + state.first_word[tree];
    for (std::size_t w = 0; w < std::min(words, shown.size()); ++w) seen[w] &= shown[w];
    std::size_t straddling = 0;
    for (std::size_t w = 0; w < words; ++w)
        straddling += static_cast<std::size_t>(std::popcount(seen[w] & seen[all_words + w]));
    constexpr MarkBytes kBytes{static_cast<std::uint8_t>(Verdict::straddling),
                               static_cast<std::uint8_t>(Verdict::inside)};
    static_assert(sizeof(Verdict) == 1);
    std::uint32_t* const listed = ids.room(64 * words + kRoomBehind);
    const std::size_t count =
        list_marked_bits_kernel(seen, seen + all_words, words, kBytes, listed,
                                reinterpret_cast<std::uint8_t*>(verdicts.room(64 * words + kRoomBehind)));
    const std::uint32_t first = state.trees[tree]->first_id;
    for (std::size_t i = 0; i < count; ++i) listed[i] += first;
    ids.grow(count);
    verdicts.grow(count);
    if (kCountStatistics) state.statistics.straddling += straddling;
    return count - straddling;
}

}  // namespace crofton::cull
