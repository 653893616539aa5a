// SPDX-License-Identifier: MIT
// All that can be asked of a tree, and done to it, once it has been accepted.
#pragma once
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/cull/cull.hpp>
#include <cstdlib>

namespace crofton::fuzz {

inline void query(const boxtree::BoxTree& tree) {
    cull::VisibleSet visible;
    for (const auto order : {cull::ResultOrder::ascending, cull::ResultOrder::tree}) {
        cull::find_visible(tree, {*frustum_of(Camera{})}, visible, {cull::CullMode::exact, order});
        for (const boxtree::ItemId item : visible.ids())
            if (item >= tree.boxes().size()) std::abort();
    }
}

inline void change(boxtree::BoxTree& tree) {
    Obb box;
    box.half_extents = glm::vec3(1.0f);
    for (boxtree::ItemId item = 0; item < tree.boxes().size() && item < 40; item += 3) {
        (void)tree.move(item, box);
        (void)tree.set_layer_mask(item, item);
        if (item % 2 == 0) (void)tree.remove(item);
        (void)tree.insert(box);
    }
    tree.refit();
    while (tree.item_count() > 0 && !tree.rebuild_step(1000)) {
    }
    query(tree);
}

}  // namespace crofton::fuzz
