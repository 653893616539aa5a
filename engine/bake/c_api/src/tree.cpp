// SPDX-License-Identifier: MIT
#include <crofton/capi/scene.h>

#include <algorithm>
#include <crofton/collide/broadphase.hpp>
#include <crofton/cull/cull.hpp>
#include <limits>

#include <crofton/capi/query_shapes.hpp>
#include <crofton/capi/requests.hpp>
#include "handles.hpp"

using namespace crofton;
using namespace crofton::capi;

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
    CROFTON_CHANGE(tree);
    CROFTON_CHECK(check_array(items, count, __func__));
    CROFTON_CHECK(check_array(boxes, count, __func__));
    return status_of(tree->tree.move(std::span(items, count), to_boxes(boxes, count)), __func__);
}

crofton_status crofton_tree_insert(crofton_tree* tree, const crofton_box* box, uint32_t layer_mask, uint32_t* item) {
    CROFTON_CHANGE(tree);
    CROFTON_CHECK(check_pointer(box, __func__));
    CROFTON_CHECK(check_pointer(item, __func__));
    const auto inserted = tree->tree.insert(to_box(box), layer_mask);
    if (!inserted) return report(inserted.error(), __func__);
    *item = *inserted;
    return CROFTON_OK;
}

crofton_status crofton_tree_remove(crofton_tree* tree, uint32_t item) {
    CROFTON_CHANGE(tree);
    return status_of(tree->tree.remove(item), __func__);
}

crofton_status crofton_tree_set_layer_mask(crofton_tree* tree, uint32_t item, uint32_t layer_mask) {
    CROFTON_CHANGE(tree);
    return status_of(tree->tree.set_layer_mask(item, layer_mask), __func__);
}

crofton_status crofton_tree_refit(crofton_tree* tree, size_t rebuild_budget) {
    CROFTON_CHANGE(tree);
    tree->tree.refit();
    if (rebuild_budget > 0) tree->tree.rebuild_step(rebuild_budget);
    return CROFTON_OK;
}

crofton_status crofton_tree_view(const crofton_tree* tree, const crofton_view_request* request,
                                 const crofton_jobs* jobs, crofton_view_result* result) {
    CROFTON_READ(tree);
    CROFTON_CHANGE(result);
    BoxQuery query;
    CROFTON_CHECK(read_box_request(request, jobs, __func__, *result, query));
    HostJobs executor(jobs);
    cull::find_visible(tree->tree, result->view, result->boxes, query.options, executor);
    return CROFTON_OK;
}

crofton_status crofton_tree_raycast(const crofton_tree* tree, const crofton_ray* rays, size_t count,
                                    uint32_t layer_mask, crofton_ray_hit* hits) {
    CROFTON_READ(tree);
    return answer_rays(rays, count, hits, __func__, [&](const Ray& ray) {
        const auto hit = collide::raycast(ray, tree->tree, layer_mask);
        return hit ? crofton_ray_hit{hit->t, hit->item}
                   : crofton_ray_hit{std::numeric_limits<double>::infinity(), CROFTON_NONE};
    });
}

crofton_status crofton_tree_overlap(const crofton_tree* tree, const crofton_query_shape* shape, uint32_t layer_mask,
                                    uint32_t* items, size_t capacity, size_t* found) {
    CROFTON_READ(tree);
    CROFTON_CHECK(check_room(items, capacity, __func__));
    CROFTON_CHECK(check_pointer(found, __func__));
    return visit_shape(shape, __func__, [&, function = __func__](const auto& asked, const auto&... pose) {
        if constexpr (sizeof...(pose) == 0) {
            Vector<boxtree::ItemId> all;
            collide::overlapping(tree->tree, asked, all, layer_mask);
            std::copy_n(all.data(), std::min(capacity, all.size()), items);
            *found = all.size();
            return CROFTON_OK;
        } else {
            return report(CROFTON_UNSUPPORTED, function, "trees support boxes, spheres and capsules");
        }
    });
}
