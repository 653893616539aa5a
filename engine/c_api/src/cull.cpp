// SPDX-License-Identifier: MIT
#include <crofton/capi/modules.h>
#include <crofton/boxtree/box_tree.hpp>

#include <crofton/cull/cull.hpp>

#include <crofton/capi/tree.hpp>
#include "queries.hpp"

using namespace crofton;
using namespace crofton::capi;

struct crofton_visible_set {
    static constexpr std::uint32_t kKind = 0x43724f03;
    Header header;
    cull::VisibleSet visible{};
    cull::View view{};
};

crofton_status crofton_tree_create(const crofton_box* boxes, const uint32_t* layer_masks, size_t count,
                                   const crofton_jobs* jobs, crofton_tree** tree) {
    CROFTON_CHECK(check_array(boxes, count, __func__));
    CROFTON_CHECK(check_jobs(jobs, __func__));
    CROFTON_CHECK(check_pointer(tree, __func__));
    HostJobs executor(jobs);
    auto built =
        boxtree::BoxTree::build(to_boxes(boxes, count), std::span(layer_masks, layer_masks ? count : 0), {}, executor);
    if (!built) return report(built.error(), __func__);
    return create(tree, __func__, std::move(*built));
}

crofton_status crofton_tree_destroy(crofton_tree* tree) {
    return destroy(tree, __func__);
}

crofton_status crofton_tree_move(crofton_tree* tree, const uint32_t* items, const crofton_box* boxes, size_t count) {
    const ExclusiveUse use(tree, __func__);
    if (use.failed()) return use.status();
    CROFTON_CHECK(check_array(items, count, __func__));
    CROFTON_CHECK(check_array(boxes, count, __func__));
    return status_of(tree->tree.move(std::span(items, count), to_boxes(boxes, count)), __func__);
}

crofton_status crofton_tree_insert(crofton_tree* tree, const crofton_box* box, uint32_t layer_mask, uint32_t* item) {
    const ExclusiveUse use(tree, __func__);
    if (use.failed()) return use.status();
    CROFTON_CHECK(check_pointer(box, __func__));
    CROFTON_CHECK(check_pointer(item, __func__));
    const auto inserted = tree->tree.insert(to_box(box), layer_mask);
    if (!inserted) return report(inserted.error(), __func__);
    *item = *inserted;
    return CROFTON_OK;
}

crofton_status crofton_tree_remove(crofton_tree* tree, uint32_t item) {
    const ExclusiveUse use(tree, __func__);
    if (use.failed()) return use.status();
    return status_of(tree->tree.remove(item), __func__);
}

crofton_status crofton_tree_set_layer_mask(crofton_tree* tree, uint32_t item, uint32_t layer_mask) {
    const ExclusiveUse use(tree, __func__);
    if (use.failed()) return use.status();
    return status_of(tree->tree.set_layer_mask(item, layer_mask), __func__);
}

crofton_status crofton_tree_refit(crofton_tree* tree) {
    const ExclusiveUse use(tree, __func__);
    if (use.failed()) return use.status();
    tree->tree.refit();
    return CROFTON_OK;
}

crofton_status crofton_tree_rebuild_step(crofton_tree* tree, size_t budget) {
    const ExclusiveUse use(tree, __func__);
    if (use.failed()) return use.status();
    tree->tree.rebuild_step(budget);
    return CROFTON_OK;
}

crofton_status crofton_visible_set_create(crofton_visible_set** visible) {
    CROFTON_CHECK(check_pointer(visible, __func__));
    return create(visible, __func__);
}

crofton_status crofton_visible_set_destroy(crofton_visible_set* visible) {
    return destroy(visible, __func__);
}

crofton_status crofton_cull_tree(const crofton_tree* tree, const crofton_view* view,
                                 const crofton_cull_options* options, const crofton_jobs* jobs,
                                 crofton_visible_set* visible) {
    const SharedUse use_tree(tree, __func__);
    if (use_tree.failed()) return use_tree.status();
    const ExclusiveUse use(visible, __func__);
    if (use.failed()) return use.status();
    CullAsked asked;
    CROFTON_CHECK(read_query(view, options, jobs, __func__, asked));
    HostJobs executor(jobs);
    cull::find_visible(tree->tree, set_view(*visible, *view), visible->visible, asked.options, executor);
    return CROFTON_OK;
}

crofton_status crofton_cull_boxes(const crofton_box* boxes, const uint32_t* layer_masks, size_t count,
                                  const crofton_view* view, const crofton_cull_options* options,
                                  const crofton_jobs* jobs, crofton_visible_set* visible) {
    const ExclusiveUse use(visible, __func__);
    if (use.failed()) return use.status();
    CROFTON_CHECK(check_array(boxes, count, __func__));
    CullAsked asked;
    CROFTON_CHECK(read_query(view, options, jobs, __func__, asked));
    HostJobs executor(jobs);
    cull::find_visible(to_boxes(boxes, count), std::span(layer_masks, layer_masks ? count : 0),
                       set_view(*visible, *view), visible->visible, asked.options, executor);
    return CROFTON_OK;
}

crofton_status crofton_visible_set_items(const crofton_visible_set* visible, const uint32_t** ids,
                                         const uint8_t** verdicts, size_t* count) {
    const SharedUse use(visible, __func__);
    if (use.failed()) return use.status();
    return give_seen(visible->visible, ids, count, verdicts, __func__);
}

crofton_status crofton_visible_set_statistics(const crofton_visible_set* visible, crofton_cull_statistics* statistics) {
    const SharedUse use(visible, __func__);
    if (use.failed()) return use.status();
    return give_statistics(visible->visible.statistics(), statistics, __func__);
}

crofton_status crofton_draw_limits_of_camera(const crofton_camera* camera, double picture_height, double pixels,
                                             crofton_draw_limits* limits) {
    CROFTON_CHECK(check_camera(camera, __func__));
    CROFTON_CHECK(check_growing(limits, __func__));
    const auto found = cull::limits_of(to_camera(*camera), picture_height, pixels);
    if (!found) return report(found.error(), __func__);
    crofton_draw_limits result{};
    for (int k = 0; k < 3; ++k) result.eye[k] = found->eye[k];
    if (found->max_distance_in_radii != cull::DrawLimits::kNone)
        result.max_distance_in_radii = found->max_distance_in_radii;
    result.least_radius = found->least_radius;
    write_growing(result, limits);
    return CROFTON_OK;
}

crofton_status crofton_classify(const crofton_frustum* frustum, const crofton_box* boxes, size_t count,
                                uint8_t* verdicts) {
    CROFTON_CHECK(check_frustum(frustum, __func__));
    CROFTON_CHECK(check_array(boxes, count, __func__));
    CROFTON_CHECK(check_array(verdicts, count, __func__));
    Frustum volume;
    copy_frustum(*frustum, volume);
    cull::classify(volume, to_boxes(boxes, count), std::span(reinterpret_cast<cull::Verdict*>(verdicts), count));
    return CROFTON_OK;
}
