// SPDX-License-Identifier: MIT
// Many views in one pass through a tree and a list.
#include <bit>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/boxtree/structure.hpp>
#include <crofton/core/error.hpp>
#include <crofton/cull/bound_set.hpp>
#include <crofton/cull/cull.hpp>
#include <cstring>

#include "exact/box_constraints.hpp"
#include "tree/block_planes.hpp"
#include "tree/query.hpp"
#include "views/many_views_kernel.hpp"

namespace crofton::cull {

// One query of many views at work in a MaskedVisibleSet's buffers.
class ManyViewsQuery {
  public:
    ManyViewsQuery(const boxtree::BoxTree& tree, std::span<const View> views, CullMode mode, const DrawLimits* limits)
        : tree_(tree.structure()), views_(views), mode_(mode), limits_(limits) {}

    void run(MaskedVisibleSet& visible, const MovingBoxes* moving = nullptr) {
        find_resting(visible, moving ? moving->size() : 0);
        if (limits_) drop_beyond_limits(visible);
        if (moving) add_moving(*moving, visible);
    }

  private:
    // Reserves room for `more` items.
    void find_resting(MaskedVisibleSet& visible, std::size_t more) {
        const std::size_t leaves = tree_.leaves().size() + boxtree::kWidth;
        grow(visible.ids_, tree_.items().boxes().size() + more + boxtree::kWidth);
        visible.mask_bytes_ = views_.size() > 16 ? 4 : views_.size() > 8 ? 2 : 1;
        grow(visible.masks_, visible.ids_.size() * visible.mask_bytes_);
        grow(visible.whole_, leaves);
        grow(visible.open_, leaves);
        grow(visible.listed_, leaves);
        grow(visible.touched_, leaves / 1024 + 1);
        grow(visible.planes_, leaves * views_.size());
        grow(visible.stack_, std::size_t{tree_.height() + 1} * boxtree::kWidth);
        visible.size_ = 0;
        if (views_.empty()) return;
        bool vectors = true;
        KernelView kernel_views[kMaxViews];
        for (std::size_t v = 0; v < views_.size(); ++v) {
            vectors = vectors && is_usable(views_[v].frustum) && has_unit_normals(views_[v].frustum);
            kernel_views[v] = kernel_view_of(views_[v]);
            bring_before(tree_.nodes()[0].origin, tree_.nodes()[0].l1_radius, kernel_views[v]);
        }
        if (!vectors) return run_one_by_one(visible);
        const auto decide = [](const void* context, std::uint32_t slot, std::uint32_t view) {
            const auto& query = *static_cast<const ManyViewsQuery*>(context);
            const Obb& box = query.tree_.items().boxes()[query.tree_.slot_items()[slot]];
            return classify_usable(query.views_[view].frustum, box, query.mode_) != Verdict::outside;
        };
        const ManyViewsInput input{tree_.nodes().data(),
                                   tree_.leaves().data(),
                                   tree_.leaf_ranges().data(),
                                   tree_.leaf_counts().data(),
                                   tree_.slot_items().data(),
                                   tree_.axes().data(),
                                   static_cast<std::uint32_t>(tree_.leaves().size()),
                                   kernel_views,
                                   static_cast<std::uint32_t>(views_.size()),
                                   mode_ == CullMode::exact,
                                   decide,
                                   this};
        ManyViewsOutput output{};
        output.ids = visible.ids_.data();
        output.masks = visible.masks_.data();
        output.mask_bytes = visible.mask_bytes_;
        output.whole = visible.whole_.data();
        output.open = visible.open_.data();
        output.listed = visible.listed_.data();
        output.touched = visible.touched_.data();
        output.planes = visible.planes_.data();
        output.stack = visible.stack_.data();
        run_many_views_kernel(input, output);
        visible.size_ = output.count;
    }

    void add_moving(const MovingBoxes& moving, MaskedVisibleSet& visible) const {
        grow(visible.moving_masks_, moving.size());
        const std::span<std::uint32_t> masks = std::span(visible.moving_masks_).first(moving.size());
        (void)find_visible(moving.set(), moving.boxes(), {}, views_, masks, mode_);  // few enough: checked before
        for (std::size_t k = 0; k < masks.size(); ++k) {
            if (masks[k] == 0) continue;
            const ItemId item = moving.items()[k];
            const std::uint32_t mask = masks[k] & views_with(tree_.items().layer_masks()[item]);
            append(visible, item, within_limits(mask, item, moving.boxes()[k]));
        }
    }

    void drop_beyond_limits(MaskedVisibleSet& visible) const {
        const std::size_t size = visible.size_;
        visible.size_ = 0;
        for (std::size_t i = 0; i < size; ++i) {
            const ItemId item = visible.ids_[i];
            append(visible, item, within_limits(visible.view_mask(i), item, tree_.items().boxes()[item]));
        }
    }

    // Returns which of the views in `mask` keep the item. Views that share the same of its layers keep it together.
    [[nodiscard]] std::uint32_t within_limits(std::uint32_t mask, ItemId item, const Obb& box) const {
        if (!limits_) return mask;
        std::uint32_t kept = 0, common = 0;
        bool is_kept = false;
        for (std::uint32_t left = mask; left != 0; left &= left - 1) {
            const auto v = static_cast<std::size_t>(std::countr_zero(left));
            const std::uint32_t layers = tree_.items().layer_masks()[item] & views_[v].layer_mask;
            if (left == mask || layers != common) is_kept = is_worth_drawing(*limits_, box, item, layers);
            common = layers;
            if (is_kept) kept |= 1u << v;
        }
        return kept;
    }

    [[nodiscard]] std::uint32_t views_with(std::uint32_t layers) const {
        std::uint32_t with = 0;
        for (std::size_t v = 0; v < views_.size(); ++v)
            with |= std::uint32_t{(layers & views_[v].layer_mask) != 0} << v;
        return with;
    }

    static void append(MaskedVisibleSet& visible, ItemId item, std::uint32_t mask) {
        if (mask == 0) return;
        visible.ids_[visible.size_] = item;
        std::memcpy(visible.masks_.data() + visible.size_++ * visible.mask_bytes_, &mask, visible.mask_bytes_);
    }

    template <class T>
    static void grow(Vector<T>& buffer, std::size_t size) {
        if (buffer.size() < size) buffer.resize(size);
    }

    // The kernel writes masks of fewer bytes: a mask's lower bytes come first.
    static_assert(std::endian::native == std::endian::little);

    // Where the kernel cannot take one of the views: each item is tested against each view.
    void run_one_by_one(MaskedVisibleSet& visible) const {
        for (const ItemId item : tree_.slot_items()) {
            if (item == boxtree::kNone) continue;
            std::uint32_t mask = 0;
            for (std::size_t v = 0; v < views_.size(); ++v)
                if (tree_.items().layer_masks()[item] & views_[v].layer_mask &&
                    classify(views_[v].frustum, tree_.items().boxes()[item], mode_) != Verdict::outside)
                    mask |= 1u << v;
            append(visible, item, mask);
        }
    }

    const boxtree::Structure& tree_;
    std::span<const View> views_;
    CullMode mode_;
    const DrawLimits* limits_;
};

Result<void> check_view_count(std::size_t views) {
    if (views <= kMaxViews) return {};
    return fail(ErrorCode::out_of_range, kMaxViews,
                {"cull: ", views, " views; one pass takes at most ", kMaxViews, ": split them into several passes"});
}

Result<void> find_visible(const boxtree::BoxTree& tree, std::span<const View> views, MaskedVisibleSet& visible,
                          CullMode mode, const DrawLimits* limits) {
    if (auto few = check_view_count(views.size()); !few) return few;
    ManyViewsQuery(tree, views, mode, limits).run(visible);
    return {};
}

Result<void> find_visible(const boxtree::BoxTree& resting, const MovingBoxes& moving, std::span<const View> views,
                          MaskedVisibleSet& visible, CullMode mode, const DrawLimits* limits) {
    if (auto few = check_view_count(views.size()); !few) return few;
    ManyViewsQuery(resting, views, mode, limits).run(visible, &moving);
    return {};
}

}  // namespace crofton::cull
