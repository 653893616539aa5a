#include <crofton/core/assert.hpp>
#include <crofton/cull/many_views.hpp>

#include "box_constraints.hpp"
#include "many_views_kernel.hpp"
#include "query.hpp"

namespace crofton::cull {

class ManyViewsQuery {
  public:
    ManyViewsQuery(const tree::BoxTree& tree, std::span<const View> views, Mode mode)
        : tree_(tree), views_(views), mode_(mode) {}

    void run(ManyVisible& visible) {
        constexpr std::size_t kEntryWords = (sizeof(ManyViewsEntry) + 7) / 8;
        const std::size_t items = tree_.boxes().size() + tree::kWidth;
        if (visible.ids_.size() < items) {
            visible.ids_.resize(items);
            visible.masks_.resize(items);
        }
        const std::size_t words = (tree_.height() + 1) * tree::kWidth * kEntryWords;
        if (visible.stack_.size() < words) visible.stack_.resize(words);
        visible.size_ = 0;
        if (views_.empty()) return;
        bool vectors = true;
        KernelView kernel_views[kMaxViews];
        for (std::size_t v = 0; v < views_.size(); ++v) {
            vectors = vectors && is_usable(views_[v].frustum) && has_unit_normals(views_[v].frustum);
            kernel_views[v] = kernel_view_of(views_[v]);
        }
        if (!vectors) return run_one_by_one(visible);
        const auto decide = [](const void* context, std::uint32_t slot, std::uint32_t view) {
            const auto& query = *static_cast<const ManyViewsQuery*>(context);
            const Obb& box = query.tree_.boxes()[query.tree_.slot_items()[slot]];
            return classify_usable(query.views_[view].frustum, box, query.mode_) != Verdict::outside;
        };
        const ManyViewsInput input{tree_.nodes().data(),
                                   tree_.leaves().data(),
                                   tree_.leaf_ranges().data(),
                                   tree_.leaf_counts().data(),
                                   tree_.slot_items().data(),
                                   kernel_views,
                                   static_cast<std::uint32_t>(views_.size()),
                                   mode_ == Mode::exact,
                                   decide,
                                   this};
        ManyViewsOutput output{visible.ids_.data(), visible.masks_.data(),
                               reinterpret_cast<ManyViewsEntry*>(visible.stack_.data()), 0};
        run_many_views_kernel(input, output);
        visible.size_ = output.count;
    }

  private:
    // A view that the kernel cannot take is among them.
    void run_one_by_one(ManyVisible& visible) const {
        for (const ItemId item : tree_.slot_items()) {
            if (item == tree::kNone) continue;
            std::uint32_t mask = 0;
            for (std::size_t v = 0; v < views_.size(); ++v)
                if (tree_.layer_masks()[item] & views_[v].layer_mask &&
                    classify(views_[v].frustum, tree_.boxes()[item], mode_) != Verdict::outside)
                    mask |= 1u << v;
            if (mask == 0) continue;
            visible.ids_[visible.size_] = item;
            visible.masks_[visible.size_++] = mask;
        }
    }

    const tree::BoxTree& tree_;
    std::span<const View> views_;
    Mode mode_;
};

void cull(const tree::BoxTree& tree, std::span<const View> views, ManyVisible& visible, Mode mode) {
    CROFTON_ASSERT(views.size() <= kMaxViews, "at most 32 views fit one pass");
    ManyViewsQuery(tree, views, mode).run(visible);
}

}  // namespace crofton::cull
