// SPDX-License-Identifier: MIT
// Finds the objects that occluders leave visible.
#include <algorithm>
#include <bit>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/boxtree/structure.hpp>
#include <crofton/core/error.hpp>
#include <crofton/occlude/occlusion.hpp>

#include "query_view.hpp"

namespace crofton::occlude {

using boxtree::ItemId;

// One query at work in a VisibleSet's buffers. First comes what occluders and the picture's edge leave, then, of these
// few, the exact verdicts of the frustum.
class VisibleQuery {
  public:
    VisibleQuery(const OcclusionBuffer& buffer, VisibleSet& visible, const VisibleOptions& options)
        : buffer_(buffer), view_(query_view_of(buffer.data())), visible_(visible), options_(options) {
        CROFTON_ASSERT(buffer.data().drawn, "draw the buffer before you query it");
        visible_.statistics_ = {};
        visible_.candidates_.clear();
        visible_.size_ = 0;
    }

    void add(const boxtree::BoxTree& tree) {
        if (tree.item_count() == 0) return;
        Vector<ItemId>& stack = visible_.stack_;
        stack.clear();
        stack.push_back(0);
        while (!stack.empty()) {
            const std::uint32_t child = stack.back();
            stack.pop_back();
            if (child & boxtree::kLeafBit)
                add_leaf(tree, child & ~boxtree::kLeafBit);
            else
                add_children(tree.structure(), tree.structure().nodes()[child]);
        }
    }

    void add(const boxtree::BoxTree& tree, const cull::MovingBoxes& moving) {
        const std::size_t count = moving.size();
        Vector<std::uint32_t>& places = visible_.places_;
        if (places.size() < tree.boxes().size()) places.resize(tree.boxes().size());
        for (std::size_t first = 0; first < count; first += 64) {
            const std::size_t size = std::min<std::size_t>(64, count - first);
            for (std::uint64_t rest = not_hidden(&moving.boxes()[first], nullptr, size); rest != 0; rest &= rest - 1) {
                const std::size_t place = first + static_cast<std::size_t>(std::countr_zero(rest));
                const ItemId item = moving.items()[place];
                if (!(tree.layer_masks()[item] & options_.layer_mask)) continue;
                if (options_.mask_moving && !cull::is_candidate(options_.candidate_mask, item)) continue;
                places[item] = static_cast<std::uint32_t>(place);
                visible_.candidates_.push_back(item);
            }
        }
    }

    void add(std::span<const Obb> boxes, std::span<const std::uint32_t> layer_masks) {
        for (std::size_t first = 0; first < boxes.size(); first += 64) {
            const std::size_t size = std::min<std::size_t>(64, boxes.size() - first);
            for (std::uint64_t rest = not_hidden(&boxes[first], nullptr, size); rest != 0; rest &= rest - 1) {
                const std::size_t i = first + static_cast<std::size_t>(std::countr_zero(rest));
                if (((layer_masks.empty() ? ~std::uint32_t{0} : layer_masks[i]) & options_.layer_mask) &&
                    cull::is_candidate(options_.candidate_mask, static_cast<ItemId>(i)))
                    visible_.candidates_.push_back(static_cast<ItemId>(i));
            }
        }
    }

    // Returns the index in the list of a mover that is a candidate.
    [[nodiscard]] std::uint32_t place_of(ItemId item) const { return visible_.places_[item]; }

    // box_of(item) and layers_of(item) are the item's; ids are below `items`.
    template <class BoxOf, class LayersOf>
    void finish(std::size_t items, const BoxOf& box_of, const LayersOf& layers_of) {
        sort(items);
        Vector<Obb>& boxes = visible_.boxes_;
        boxes.clear();
        std::size_t kept = 0;
        for (const ItemId item : visible_.candidates_) {
            const Obb& box = box_of(item);
            const std::uint32_t common = layers_of(item) & options_.layer_mask;
            if (options_.limits && !cull::is_worth_drawing(*options_.limits, box, item, common)) continue;
            boxes.push_back(box);
            visible_.candidates_[kept++] = item;
        }
        visible_.candidates_.resize(kept);
        cull::CullOptions how;
        how.mode = options_.mode;
        cull::find_visible(boxes, {}, {buffer_.view().frustum}, visible_.visible_, how);
        const auto seen = visible_.visible_.ids();
        if (visible_.ids_.size() < seen.size()) visible_.ids_.resize(seen.size());
        for (std::size_t i = 0; i < seen.size(); ++i) visible_.ids_[i] = visible_.candidates_[seen[i]];
        visible_.size_ = seen.size();
    }

  private:
    void add_children(const boxtree::Structure& structure, const boxtree::Node& node) {
        const ChildBits bits = query_children_kernel(view_, node, structure.axes_of(node));
        std::uint32_t open = 0;
        for (std::uint32_t l = 0; l < node.count; ++l)
            open |= static_cast<std::uint32_t>((node.layers_any[l] & options_.layer_mask) != 0) << l;
        if (cull::kCountStatistics) {
            VisibleStatistics& statistics = visible_.statistics_;
            statistics.nodes_tested += static_cast<std::uint64_t>(std::popcount(open));
            statistics.nodes_hidden += static_cast<std::uint64_t>(std::popcount(open & bits.hidden));
            statistics.nodes_outside += static_cast<std::uint64_t>(std::popcount(open & bits.outside_picture));
        }
        for (open &= ~(bits.hidden | bits.outside_picture); open != 0; open &= open - 1)
            visible_.stack_.push_back(node.child[std::countr_zero(open)]);
    }

    void add_leaf(const boxtree::BoxTree& tree, boxtree::LeafId leaf) {
        const boxtree::Structure& structure = tree.structure();
        const boxtree::Leaf& lanes = structure.leaves()[leaf];
        ItemId items[boxtree::kWidth];
        std::size_t count = 0;
        for (std::uint32_t l = 0; l < lanes.count; ++l) {
            const ItemId item = structure.slot_items()[leaf * boxtree::kWidth + l];
            if ((lanes.layers[l] & options_.layer_mask) && cull::is_candidate(options_.candidate_mask, item))
                items[count++] = item;
        }
        if (count == 0) return;
        for (std::uint64_t rest = not_hidden(tree.boxes().data(), items, count); rest != 0; rest &= rest - 1)
            visible_.candidates_.push_back(items[std::countr_zero(rest)]);
    }

    // Returns which of at most 64 boxes are neither hidden nor outside the picture.
    [[nodiscard]] std::uint64_t not_hidden(const Obb* boxes, const ItemId* items, std::size_t count) {
        const QueryBits bits = query_boxes_kernel(view_, reinterpret_cast<const unsigned char*>(boxes), items, count);
        if (cull::kCountStatistics) {
            visible_.statistics_.items_tested += count;
            visible_.statistics_.items_hidden += static_cast<std::uint64_t>(std::popcount(bits.hidden));
        }
        return ~(bits.hidden | bits.outside_picture) & ~std::uint64_t{0} >> (64 - count);
    }

    // With one bit for each item.
    void sort(std::size_t items) {
        Vector<std::uint64_t>& bits = visible_.bits_;
        bits.assign((items + 63) / 64, 0);
        for (const ItemId item : visible_.candidates_) bits[item / 64] |= std::uint64_t{1} << (item % 64);
        visible_.candidates_.clear();
        for (std::size_t w = 0; w < bits.size(); ++w)
            for (std::uint64_t rest = bits[w]; rest != 0; rest &= rest - 1)
                visible_.candidates_.push_back(
                    static_cast<ItemId>(64 * w + static_cast<std::size_t>(std::countr_zero(rest))));
    }

    const OcclusionBuffer& buffer_;
    QueryView view_;
    VisibleSet& visible_;
    const VisibleOptions& options_;
};

void find_visible(const boxtree::BoxTree& tree, const OcclusionBuffer& buffer, VisibleSet& visible,
                  const VisibleOptions& options) {
    VisibleQuery query(buffer, visible, options);
    query.add(tree);
    const std::span<const Obb> boxes = tree.boxes();
    const std::span<const std::uint32_t> layers = tree.layer_masks();
    query.finish(
        boxes.size(), [&](ItemId item) -> const Obb& { return boxes[item]; },
        [&](ItemId item) { return layers[item]; });
}

void find_visible(const boxtree::BoxTree& resting, const cull::MovingBoxes& moving, const OcclusionBuffer& buffer,
                  VisibleSet& visible, const VisibleOptions& options) {
    VisibleQuery query(buffer, visible, options);
    query.add(resting);
    query.add(resting, moving);
    const boxtree::Items& items = resting.structure().items();
    query.finish(
        items.size(),
        [&](ItemId item) -> const Obb& {
            return items.is_detached(item) ? moving.boxes()[query.place_of(item)] : items.boxes()[item];
        },
        [&](ItemId item) { return items.layer_masks()[item]; });
}

void find_visible(std::span<const Obb> boxes, std::span<const std::uint32_t> layer_masks, const OcclusionBuffer& buffer,
                  VisibleSet& visible, const VisibleOptions& options) {
    VisibleQuery query(buffer, visible, options);
    query.add(boxes, layer_masks);
    query.finish(
        boxes.size(), [&](ItemId item) -> const Obb& { return boxes[item]; },
        [&](ItemId item) { return layer_masks.empty() ? ~std::uint32_t{0} : layer_masks[item]; });
}

void find_visible(const cull::BoxSet& set, std::span<const Obb> bounds, const OcclusionBuffer& buffer,
                  OcclusionBits& bits, cull::CullMode mode, Executor& executor) {
    cull::find_visible(set, bounds, {buffer.view().frustum}, bits.frustum, mode, executor);
    const std::size_t words = (bounds.size() + 63) / 64;
    if (bits.occluded.size() != words) bits.occluded.resize(words);
    const QueryView view = query_view_of(buffer.data());
    executor.parallel_for(words, 16, [&](std::size_t begin, std::size_t end, unsigned) {
        for (std::size_t w = begin; w < end; ++w) {
            std::uint32_t items[64];
            std::size_t count = 0;
            bits.occluded[w] = 0;
            for (std::uint64_t rest = bits.frustum.visible[w]; rest != 0; rest &= rest - 1)
                items[count++] = static_cast<std::uint32_t>(64 * w + static_cast<std::size_t>(std::countr_zero(rest)));
            if (count == 0) continue;
            const std::uint64_t hidden =
                query_boxes_kernel(view, reinterpret_cast<const unsigned char*>(bounds.data()), items, count).hidden;
            for (std::uint64_t rest = hidden; rest != 0; rest &= rest - 1)
                bits.occluded[w] |= std::uint64_t{1} << (items[std::countr_zero(rest)] % 64);
        }
    });
}

}  // namespace crofton::occlude
