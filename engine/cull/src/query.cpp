#include "query.hpp"

#include <hwy/cache_control.h>
#include <algorithm>
#include <bit>

#include "box_constraints.hpp"

namespace crofton::cull {
namespace {

// Vector stores run past the end of what they mean to write.
constexpr std::size_t kPadding = tree::kWidth;

template <class T>
void grow(Vector<T>& buffer, std::size_t size) {
    if (buffer.size() < size) buffer.resize(size);
}

}  // namespace

KernelView kernel_view_of(const View& view) {
    KernelView result{};
    for (int j = 0; j < 3; ++j) result.origin[j] = view.frustum.origin[j];
    result.plane_count = view.frustum.plane_count;
    result.layer_mask = view.layer_mask;
    for (std::uint32_t i = 0; i < view.frustum.plane_count; ++i) {
        const Plane& plane = view.frustum.planes[i];
        for (int j = 0; j < 3; ++j) {
            result.planes[i].normal[j] = plane.normal[j];
            result.planes[i].normal_f[j] = static_cast<float>(plane.normal[j]);
        }
        result.planes[i].offset = plane.offset;
    }
    return result;
}

void Query::start(std::size_t items) {
    visible_.size_ = visible_.inside_ = 0;
    visible_.statistics_ = {};
    grow(visible_.ids_, items + kPadding);
    grow(visible_.straddling_, items + kPadding);
}

void Query::run(std::span<const Obb> boxes, std::span<const std::uint32_t> layer_masks) {
    start(boxes.size());
    std::size_t inside = 0, straddling = 0;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        if (!layer_masks.empty() && !(layer_masks[i] & view_.layer_mask)) continue;
        if (kCountStatistics) ++visible_.statistics_.boxes_tested;
        const Verdict verdict = classify(view_.frustum, boxes[i], options_.mode);
        if (verdict == Verdict::inside) visible_.ids_[inside++] = static_cast<ItemId>(i);
        if (verdict == Verdict::straddling) visible_.straddling_[straddling++] = static_cast<ItemId>(i);
    }
    finish(inside, straddling, boxes.size());
}

void Query::run(const tree::BoxTree& tree) {
    start(tree.boxes().size());
    if (!is_usable(view_.frustum) || !has_unit_normals(view_.frustum)) return run_all(tree);
    grow(visible_.undecided_, tree.boxes().size() + kPadding);
    grow(visible_.stack_, (tree.height() + 1) * tree::kWidth);
    const KernelView view = kernel_view_of(view_);
    const TreeKernelInput input{tree.nodes().data(),         tree.leaves().data(),     tree.leaf_ranges().data(),
                                tree.leaf_counts().data(),   tree.slot_items().data(), &view,
                                options_.mode == Mode::exact};
    TreeKernelOutput output{};
    output.inside = visible_.ids_.data();
    output.straddling = visible_.straddling_.data();
    output.undecided = visible_.undecided_.data();
    output.stack = visible_.stack_.data();
    output.stack[0] = (1u << view.plane_count) - 1;
    run_tree_kernel(input, 1, output);
    decide(tree, output);
    finish(output.inside_count, output.straddling_count, tree.boxes().size());
}

// A view that the kernels cannot take: item by item. If it is not finite, everything may be visible.
void Query::run_all(const tree::BoxTree& tree) {
    std::size_t inside = 0, straddling = 0;
    for (tree::LeafId l = 0; l < tree.leaves().size(); ++l)
        for (std::uint32_t lane = 0; lane < tree.leaves()[l].count; ++lane) {
            if (!(tree.leaves()[l].layers[lane] & view_.layer_mask)) continue;
            const ItemId item = tree.slot_items()[l * tree::kWidth + lane];
            const Verdict verdict = classify(view_.frustum, tree.boxes()[item], options_.mode);
            if (verdict == Verdict::inside) visible_.ids_[inside++] = item;
            if (verdict == Verdict::straddling) visible_.straddling_[straddling++] = item;
        }
    finish(inside, straddling, tree.boxes().size());
}

void Query::decide(const tree::BoxTree& tree, TreeKernelOutput& output) {
    Statistics& statistics = visible_.statistics_;
    for (std::size_t i = 0; i < output.undecided_count; ++i) {
        // The boxes lie in the order of their ids, far from each other: ask for them ahead.
        constexpr std::size_t kAhead = 8;
        if (i + kAhead < output.undecided_count)
            hwy::Prefetch(&tree.boxes()[tree.slot_items()[output.undecided[i + kAhead]]]);
        const ItemId item = tree.slot_items()[output.undecided[i]];
        const Verdict verdict = classify_usable(view_.frustum, tree.boxes()[item], options_.mode);
        if (verdict == Verdict::inside) output.inside[output.inside_count++] = item;
        if (verdict == Verdict::straddling) output.straddling[output.straddling_count++] = item;
        if (kCountStatistics) statistics.improper += verdict == Verdict::outside;
    }
    if (!kCountStatistics) return;
    statistics.nodes_tested = output.nodes_tested;
    statistics.boxes_tested = output.boxes_tested;
    statistics.accepted_whole = output.accepted_whole;
    statistics.exact_tests = output.undecided_count;
}

void Query::finish(std::size_t inside, std::size_t straddling, std::size_t items) {
    if (kCountStatistics) visible_.statistics_.straddling = straddling;
    visible_.size_ = inside + straddling;
    visible_.inside_ = inside;
    if (options_.order == Order::ascending) return sort(inside, straddling, items);
    std::copy_n(visible_.straddling_.begin(), straddling, visible_.ids_.begin() + static_cast<std::ptrdiff_t>(inside));
    visible_.verdicts_.clear();
}

// By two bits an item, in one sweep: the ids are distinct and below the number of items.
void Query::sort(std::size_t inside, std::size_t straddling, std::size_t items) {
    const std::size_t words = (items + 31) / 32;
    grow(visible_.bits_, words);
    grow(visible_.verdicts_, items);
    std::uint64_t* bits = visible_.bits_.data();
    std::fill_n(bits, words, 0);
    const auto mark = [&](ItemId id, std::uint64_t value) { bits[id / 32] |= value << (id % 32 * 2); };
    for (std::size_t i = 0; i < inside; ++i) mark(visible_.ids_[i], 3);
    for (std::size_t i = 0; i < straddling; ++i) mark(visible_.straddling_[i], 1);
    std::size_t n = 0;
    for (std::size_t w = 0; w < words; ++w)
        for (std::uint64_t visible = bits[w] & 0x5555555555555555u; visible; visible &= visible - 1) {
            const auto position = static_cast<unsigned>(std::countr_zero(visible));
            visible_.ids_[n] = static_cast<ItemId>(32 * w + position / 2);
            visible_.verdicts_[n++] = bits[w] >> position & 2 ? Verdict::inside : Verdict::straddling;
        }
}

}  // namespace crofton::cull
