// SPDX-License-Identifier: MIT
// A tree that lives by the fuzzer's bytes, with a plain list of what it must hold beside it.
#pragma once
#include <crofton/boxtree/box_tree.hpp>
#include <map>

#include "shapes.hpp"

namespace crofton::fuzz {

struct ModelItem {
    Obb box;
    std::uint32_t layers = ~0u;
    bool detached = false;
};

class LivingTree {
  public:
    explicit LivingTree(Shapes& in) : tree_(*boxtree::BoxTree::build({})) {
        const auto boxes = in.boxes(40);
        boxtree::BuildOptions options;
        options.orientation = static_cast<boxtree::Orientation>(in.below(3));
        std::vector<std::uint32_t> layers(boxes.size());
        for (std::uint32_t& mask : layers) mask = in.layers();
        tree_ = *boxtree::BoxTree::build(boxes, layers, options);
        for (std::uint32_t i = 0; i < boxes.size(); ++i) items[i] = {boxes[i], layers[i], false};
    }

    // One change; bounds may be loose after it.
    void change(Shapes& in) {
        const unsigned kind = in.below(10);
        if (items.empty() || kind < 2) return insert(in, kind == 0 && in.below(4) == 1);
        const auto at = std::next(items.begin(), in.byte() % static_cast<std::ptrdiff_t>(items.size()));
        const boxtree::ItemId id = at->first;
        ModelItem& item = at->second;
        switch (kind) {
            case 2:
                demand(tree_.remove(id).has_value(), "remove");
                demand(!tree_.remove(id).has_value(), "an item is removed twice");
                items.erase(at);
                break;
            case 3:
                item.layers = in.layers();
                demand(tree_.set_layer_mask(id, item.layers).has_value(), "set_layer_mask");
                break;
            case 4:
                demand(tree_.detach(id).has_value() == !item.detached, "detach");
                item.detached = true;
                break;
            case 5:
            case 6:
                if (item.detached) {
                    item.box = in.box();
                    demand(tree_.attach(id, item.box).has_value(), "attach");
                    item.detached = false;
                }
                break;
            default: {
                const Obb box = in.flag() ? in.box_near(item.box) : in.box();
                demand(tree_.move(id, box).has_value() == !item.detached, "move");
                if (!item.detached) item.box = box;
            }
        }
    }
    // Makes bounds tight again, and works on a rebuild now and then.
    void settle(Shapes& in) {
        tree_.refit();
        if (in.flag()) (void)tree_.rebuild_step(std::size_t{1} << in.below(12));
    }

    [[nodiscard]] boxtree::BoxTree& tree() { return tree_; }
    [[nodiscard]] const boxtree::BoxTree& tree() const { return tree_; }
    std::map<boxtree::ItemId, ModelItem> items;

    // What holds of every tree.
    void check() const {
        demand(tree_.validate().has_value(), "validate");
        std::size_t held = 0;
        for (const auto& [id, item] : items) {
            held += !item.detached;
            demand(tree_.contains(id) != item.detached && tree_.is_detached(id) == item.detached, "where an item is");
            demand(tree_.layer_masks()[id] == item.layers, "an item's layers");
            if (!item.detached)
                demand(std::memcmp(&tree_.boxes()[id], &item.box, sizeof item.box) == 0, "an item's box");
        }
        demand(tree_.item_count() == held, "item_count");
    }

  private:
    void insert(Shapes& in, bool detached) {
        ModelItem item{in.box(), in.layers(), detached};
        const auto id = detached ? tree_.insert_detached(item.layers) : tree_.insert(item.box, item.layers);
        demand(id.has_value() && !items.contains(*id), "insert");
        items[*id] = item;
    }

    boxtree::BoxTree tree_;
};

}  // namespace crofton::fuzz
