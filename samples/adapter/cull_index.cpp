// SPDX-License-Identifier: MIT
#include "cull_index.hpp"

#include <cstdio>
#include <cstdlib>

namespace crofton::adapter {
namespace {

// Work that a frame spends on keeping a tree of moving things good, in items.
constexpr std::size_t kMaintenance = 2000;

// Callers give valid boxes and their own ids: a failure here is a mistake in the adapter.
template <class T>
T must(Result<T> result) {
    if (!result) {
        std::fprintf(stderr, "crofton adapter: %s\n", result.error().message.c_str());
        std::abort();
    }
    if constexpr (!std::is_void_v<T>) return std::move(*result);
}

}  // namespace

cull::ItemId CullIndex::insert(const Obb& box) {
    changed_ = true;
    if (tree_) return must(tree_->insert(box));
    boxes_.push_back(box);
    removed_.push_back(false);
    return static_cast<cull::ItemId>(boxes_.size() - 1);
}

void CullIndex::move(cull::ItemId item, const Obb& box) {
    changed_ = true;
    if (tree_)
        must(tree_->move(item, box));
    else
        boxes_[item] = box;
}

void CullIndex::remove(cull::ItemId item) {
    changed_ = true;
    if (tree_)
        must(tree_->remove(item));
    else
        removed_[item] = true;
}

void CullIndex::build() {
    tree_.emplace(must(boxtree::BoxTree::build(boxes_)));
    for (std::size_t i = 0; i < removed_.size(); ++i)
        if (removed_[i]) must(tree_->remove(static_cast<cull::ItemId>(i)));
    boxes_ = {};
    removed_ = {};
}

void CullIndex::update() {
    if (!tree_) build();
    if (!changed_) return;
    tree_->refit();
    tree_->rebuild_step(kMaintenance);
    changed_ = false;
}

const cull::VisibleSet& CullIndex::cull(const cull::View& view) {
    update();
    cull::find_visible(*tree_, view, visible_);
    return visible_;
}

}  // namespace crofton::adapter
