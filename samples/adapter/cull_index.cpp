#include "cull_index.hpp"

namespace crofton::adapter {

CullIndex::CullIndex() = default;

cull::ItemId CullIndex::insert(const Obb& box, std::uint32_t layer_mask) {
    tree_.reset();
    if (free_.empty()) {
        boxes_.push_back(box);
        layer_masks_.push_back(layer_mask);
        return static_cast<cull::ItemId>(boxes_.size() - 1);
    }
    const cull::ItemId item = free_.back();
    free_.pop_back();
    boxes_[item] = box;
    layer_masks_[item] = layer_mask;
    return item;
}

void CullIndex::move(cull::ItemId item, const Obb& box) {
    tree_.reset();
    boxes_[item] = box;
}

void CullIndex::remove(cull::ItemId item) {
    tree_.reset();
    layer_masks_[item] = 0;
    free_.push_back(item);
}

void CullIndex::update() {
    if (tree_) return;
    tree_ = *tree::BoxTree::build(boxes_, layer_masks_);
}

const cull::VisibleSet& CullIndex::cull(const cull::View& view) {
    update();
    cull::cull(*tree_, view, visible_);
    return visible_;
}

}  // namespace crofton::adapter
