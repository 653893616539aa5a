#include <algorithm>
#include <cmath>
#include <crofton/core/assert.hpp>
#include <crofton/cull/cull.hpp>

#include "box_constraints.hpp"

namespace crofton::cull {

using tree::kLeafBit;
using tree::kWidth;
using tree::Leaf;
using tree::LeafRange;
using tree::Node;

// One query at work in a VisibleSet's buffers.
class Query {
  public:
    Query(const View& view, VisibleSet& visible, const Options& options, std::size_t items)
        : view_(view), visible_(visible), options_(options), usable_(is_usable(view.frustum)) {
        visible.size_ = 0;
        visible.statistics_ = {};
        if (visible.ids_.size() < items) {
            visible.ids_.resize(items);
            visible.verdicts_.resize(items);
        }
    }

    void run(std::span<const Obb> boxes, std::span<const std::uint32_t> layer_masks) {
        for (std::size_t i = 0; i < boxes.size(); ++i)
            if (layer_masks.empty() || (layer_masks[i] & view_.layer_mask)) test(static_cast<ItemId>(i), boxes[i]);
    }

    void run(const tree::BoxTree& tree) {
        auto& stack = visible_.stack_;
        stack.clear();
        const std::uint32_t all_planes = (1u << view_.frustum.plane_count) - 1;
        if (tree.nodes()[0].count > 0) stack.push_back(all_planes);
        while (!stack.empty()) {
            const auto id = static_cast<std::uint32_t>(stack.back() >> 32);
            const auto planes = static_cast<std::uint32_t>(stack.back());
            stack.pop_back();
            if (id & kLeafBit) {
                visit_leaf(tree, id & ~kLeafBit, planes);
                continue;
            }
            const Node& node = tree.nodes()[id];
            for (std::uint32_t lane = node.count; lane-- > 0;) {
                if (!(node.layers_any[lane] & view_.layer_mask)) continue;
                std::uint32_t straddled = planes;
                if (usable_ && planes && !test(node, lane, straddled)) continue;
                stack.push_back(std::uint64_t{node.child[lane]} << 32 | straddled);
            }
        }
        if (options_.order == Order::ascending) sort();
    }

  private:
    // False if a plane certainly rejects the child; planes that it is certainly inside of are taken out of `planes`.
    bool test(const Node& node, std::uint32_t lane, std::uint32_t& planes) {
        if (kCountStatistics) ++visible_.statistics_.nodes_tested;
        const Frustum& frustum = view_.frustum;
        for (std::uint32_t i = 0; i < frustum.plane_count; ++i) {
            if (!(planes >> i & 1)) continue;
            const Plane& plane = frustum.planes[i];
            double middle = plane.offset, reach = 0.0, size = std::fabs(plane.offset);
            for (int j = 0; j < 3; ++j) {
                const double d = node.origin[j] - frustum.origin[j] + double{node.center[j][lane]};
                middle += plane.normal[j] * d;
                reach += std::fabs(plane.normal[j]) * double{node.half[j][lane]};
                size +=
                    std::fabs(plane.normal[j]) * (std::fabs(node.origin[j] - frustum.origin[j]) + double{node.reach});
            }
            const double slack = 16.0 * kUnit * size + kTiny;
            if (middle + reach < -slack) return false;
            if (middle - reach > slack) planes &= ~(1u << i);
        }
        return true;
    }

    void visit_leaf(const tree::BoxTree& tree, tree::LeafId id, std::uint32_t planes) {
        const Leaf& leaf = tree.leaves()[id];
        for (std::uint32_t lane = 0; lane < leaf.count; ++lane) {
            if (!(leaf.layers[lane] & view_.layer_mask)) continue;
            const ItemId item = tree.slot_items()[id * kWidth + lane];
            if (planes == 0) {
                if (kCountStatistics) ++visible_.statistics_.accepted_whole;
                add(item, usable_ ? Verdict::inside : Verdict::straddling);
            } else {
                test(item, tree.boxes()[item]);
            }
        }
    }

    void test(ItemId item, const Obb& box) {
        if (kCountStatistics) ++visible_.statistics_.boxes_tested;
        const Verdict verdict = classify(view_.frustum, box, options_.mode);
        if (verdict != Verdict::outside) add(item, verdict);
    }

    void add(ItemId item, Verdict verdict) {
        if (kCountStatistics) visible_.statistics_.straddling += verdict == Verdict::straddling;
        visible_.ids_[visible_.size_] = item;
        visible_.verdicts_[visible_.size_] = verdict;
        ++visible_.size_;
    }

    // By two bits an item, in one sweep: the ids are distinct and below the number of items.
    void sort() {
        const std::size_t words = (visible_.ids_.size() + 31) / 32;
        auto& bits = visible_.bits_;
        bits.assign(words, 0);
        for (std::size_t i = 0; i < visible_.size_; ++i)
            bits[visible_.ids_[i] / 32] |= std::uint64_t{visible_.verdicts_[i] == Verdict::inside ? 3u : 1u}
                                           << (visible_.ids_[i] % 32 * 2);
        std::size_t n = 0;
        for (std::size_t w = 0; w < words; ++w)
            for (std::uint64_t word = bits[w]; word;) {
                const int pair = std::countr_zero(word) / 2;
                visible_.ids_[n] = static_cast<ItemId>(32 * w + static_cast<unsigned>(pair));
                visible_.verdicts_[n++] = word >> (2 * pair) & 2 ? Verdict::inside : Verdict::straddling;
                word &= ~(std::uint64_t{3} << (2 * pair));
            }
    }

    const View& view_;
    VisibleSet& visible_;
    const Options& options_;
    bool usable_;
};

void cull(const tree::BoxTree& tree, const View& view, VisibleSet& visible, const Options& options, Executor&) {
    Query(view, visible, options, tree.boxes().size()).run(tree);
}

void cull(std::span<const Obb> boxes, std::span<const std::uint32_t> layer_masks, const View& view, VisibleSet& visible,
          const Options& options, Executor&) {
    CROFTON_ASSERT(layer_masks.empty() || layer_masks.size() == boxes.size(),
                   "cull needs one layer mask per box, or none");
    Query(view, visible, options, boxes.size()).run(boxes, layer_masks);
}

}  // namespace crofton::cull
