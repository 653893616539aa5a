// SPDX-License-Identifier: MIT
// What rests in a tree and what moves beside it, in one answer: against a plain list.
#include <algorithm>
#include <crofton/cull/bound_set.hpp>

#include "tree_model.hpp"

namespace {

using namespace crofton;
using fuzz::demand;
using Ids = std::vector<boxtree::ItemId>;

// The caller's own boxes of what is detached.
struct Movers {
    std::vector<boxtree::ItemId> items;
    std::vector<Obb> boxes;

    // All that is detached, in any order.
    void gather(fuzz::Shapes& in, fuzz::LivingTree& living) {
        items.clear();
        for (const auto& [id, item] : living.items)
            if (item.detached) items.push_back(id);
        for (std::size_t i = 1; i < items.size(); ++i) std::swap(items[i], items[in.byte() % (i + 1)]);
        boxes.clear();
        for (const boxtree::ItemId id : items) {
            if (in.flag()) living.items[id].box = in.box();
            boxes.push_back(living.items[id].box);
        }
    }
};

Ids expected_of(const fuzz::LivingTree& living, const cull::View& view, cull::CullMode mode) {
    Ids ids;
    for (const auto& [id, item] : living.items)
        if ((item.layers & view.layer_mask) != 0 &&
            cull::classify(view.frustum, item.box, mode) != cull::Verdict::outside)
            ids.push_back(id);
    return ids;
}

void check_views(fuzz::Shapes& in, const fuzz::LivingTree& living, const cull::MovingBoxes& moving) {
    const auto mode = static_cast<cull::CullMode>(in.below(2));
    std::vector<cull::View> views(1 + in.below(4));
    cull::VisibleSet visible;
    for (cull::View& view : views) {
        view = {in.frustum(), in.layers()};
        for (const auto order : {cull::ResultOrder::ascending, cull::ResultOrder::tree}) {
            cull::find_visible(living.tree(), moving, view, visible, {mode, order});
            Ids seen(visible.ids().begin(), visible.ids().end());
            if (order == cull::ResultOrder::tree) std::sort(seen.begin(), seen.end());
            demand(seen == expected_of(living, view, mode), "what rests and what moves");
        }
    }
    cull::MaskedVisibleSet many;
    (void)cull::find_visible(living.tree(), moving, views, many, mode);
    for (std::uint32_t v = 0; v < views.size(); ++v) {
        Ids seen;
        for (std::size_t i = 0; i < many.size(); ++i)
            if (many.view_mask(i) >> v & 1u) seen.push_back(many.ids()[i]);
        std::sort(seen.begin(), seen.end());
        demand(seen == expected_of(living, views[v], mode), "what many views see");
    }
}

// A list with one thing wrong is refused, and the one before stays.
void check_refusals(fuzz::Shapes& in, const fuzz::LivingTree& living, cull::MovingBoxes& moving, const Movers& movers) {
    const std::size_t before = moving.size();
    std::vector<Obb> boxes = movers.boxes;
    std::vector<boxtree::ItemId> items = movers.items;
    if (boxes.empty()) return;
    const std::size_t at = in.byte() % boxes.size();
    const unsigned kind = in.below(3);
    if (kind == 0) boxes[at].center.x = std::numeric_limits<double>::quiet_NaN();
    if (kind == 1) boxes.pop_back();
    if (kind == 2) items[at] = 100000;
    demand(!moving.update(living.tree(), items, boxes).has_value(), "a bad list of movers");
    demand(moving.size() == before, "a refused list changes the one before");
}

}  // namespace

CROFTON_FUZZ(in) {
    fuzz::LivingTree living(in);
    cull::MovingBoxes moving;
    for (int frame = 0; frame < 12 && in.more(); ++frame) {
        for (unsigned changes = in.below(12); changes > 0; --changes) living.change(in);
        living.settle(in);
        Movers movers;
        movers.gather(in, living);
        demand(moving.update(living.tree(), movers.items, movers.boxes).has_value(), "a list of movers");
        if (in.below(4) == 0) check_refusals(in, living, moving, movers);
        check_views(in, living, moving);
        (void)moving.update(living.tree(), {}, {});  // before the boxes go
    }
}
