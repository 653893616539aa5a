// SPDX-License-Identifier: MIT
// Results of views; views of plain lists of boxes.
#include <crofton/capi/crofton.h>

#include <span>

#include <crofton/capi/convert.hpp>
#include <crofton/capi/growing.hpp>
#include <crofton/capi/queries.hpp>
#include <crofton/capi/requests.hpp>

using namespace crofton;
using namespace crofton::capi;
using Of = crofton_view_result::Of;

namespace {

std::size_t view_count(const crofton_view_result& result) {
    return result.of == Of::many_of_world ? result.many.view_count() : 1;
}

crofton_status check_view_number(const crofton_view_result& result, std::size_t view, const char* function) {
    if (view < view_count(result)) return CROFTON_OK;
    return report(CROFTON_OUT_OF_RANGE, function, "there are fewer views", view);
}

const occlude::OcclusionBuffer* buffer_of(const crofton_view_result& result, std::size_t view) {
    if (result.of == Of::boxes) return nullptr;
    return result.of == Of::many_of_world ? result.many.occlusion_buffer(view) : result.one.occlusion_buffer();
}

void give_culling(const cull::Statistics& s, crofton_view_info& info) {
    info.nodes_tested = s.nodes_tested;
    info.boxes_tested = s.boxes_tested;
    info.accepted_whole = s.accepted_whole;
    info.straddling = s.straddling;
    info.exact_tests = s.exact_tests;
    info.false_positives = s.false_positives;
}

void give_occlusion(const OcclusionStatistics& s, std::span<const std::uint32_t> occluded,
                    const occlude::OcclusionBuffer* buffer, crofton_view_info& info) {
    info.occluders_drawn = s.occluders_drawn;
    info.occluder_pieces_drawn = s.drawn.pieces_drawn;
    info.occluder_triangles_drawn = s.drawn.triangles_drawn;
    info.occlusion_nodes_tested = s.asked.nodes_tested;
    info.occlusion_nodes_outside = s.asked.nodes_outside;
    info.occlusion_nodes_hidden = s.asked.nodes_hidden;
    info.occlusion_items_tested = s.asked.items_tested;
    info.occlusion_items_hidden = s.asked.items_hidden;
    info.occluded_ids = occluded.empty() ? nullptr : occluded.data();
    info.occluded_count = occluded.size();
    if (!buffer) return;
    info.depth_width = static_cast<std::uint32_t>(buffer->size().width);
    info.depth_height = static_cast<std::uint32_t>(buffer->size().height);
}

void give_picture(const depth::DepthStatistics& s, std::span<const depth::VisibleCluster> triangles,
                  crofton_view_info& info) {
    info.triangles = triangles.empty() ? nullptr : reinterpret_cast<const crofton_visible_cluster*>(triangles.data());
    info.triangle_cluster_count = triangles.size();
    info.objects_listed = s.objects_listed;
    info.objects_asked = s.objects_asked;
    info.clusters_asked = s.clusters_asked;
    info.clusters_drawn = s.clusters_drawn;
    info.triangles_drawn = s.triangles_drawn;
    info.triangles_listed = s.triangles_listed;
}

// The ids and, where there are any, the verdicts of a set that is seen.
template <class Visible>
crofton_status give_seen(const Visible& seen, const uint32_t** ids, size_t* count, const uint8_t** verdicts,
                         size_t* inside_count, const char* function) {
    CROFTON_CHECK(give_ids(seen.ids(), ids, count, function));
    if (verdicts)
        *verdicts = seen.verdicts().empty() ? nullptr : reinterpret_cast<const std::uint8_t*>(seen.verdicts().data());
    if (inside_count) *inside_count = seen.inside_count();
    return CROFTON_OK;
}

}  // namespace

crofton_status crofton_view_result_create(crofton_view_result** result) {
    CROFTON_CHECK(check_pointer(result, __func__));
    return create(result, __func__);
}

crofton_status crofton_view_result_destroy(crofton_view_result* result) {
    return destroy(result, __func__);
}

crofton_status crofton_view_result_ids(const crofton_view_result* result, const uint32_t** ids, size_t* count,
                                       const uint8_t** verdicts, size_t* inside_count) {
    CROFTON_READ(result);
    if (result->of == Of::world) return give_seen(result->one, ids, count, verdicts, inside_count, __func__);
    if (result->of == Of::boxes) return give_seen(result->boxes, ids, count, verdicts, inside_count, __func__);
    CROFTON_CHECK(give_ids(result->many.ids(), ids, count, __func__));
    if (verdicts) *verdicts = nullptr;
    if (inside_count) *inside_count = 0;
    return CROFTON_OK;
}

crofton_status crofton_view_result_get_view(const crofton_view_result* result, size_t view, crofton_view_info* info) {
    CROFTON_READ(result);
    CROFTON_CHECK(check_view_number(*result, view, __func__));
    CROFTON_CHECK(check_growing(info, __func__));
    crofton_view_info found{};
    if (result->of == Of::boxes) {
        give_culling(result->boxes.statistics(), found);
    } else if (result->of == Of::world) {
        if (result->is_counted) give_culling(result->one.statistics(), found);
        give_occlusion(result->one.occlusion_statistics(), result->one.occluded_ids(), buffer_of(*result, view), found);
        give_picture(result->one.picture_statistics(), result->one.triangles(), found);
    } else {
        const MultiViewResult& many = result->many;
        give_occlusion(many.occlusion_statistics(view), many.occluded_ids(view), buffer_of(*result, view), found);
        give_picture(many.picture_statistics(view), many.triangles(view), found);
    }
    write_growing(found, info);
    return CROFTON_OK;
}

crofton_status crofton_view_result_depth(const crofton_view_result* result, size_t view, float* nearness,
                                         size_t capacity) {
    CROFTON_READ(result);
    CROFTON_CHECK(check_view_number(*result, view, __func__));
    const occlude::OcclusionBuffer* const buffer = buffer_of(*result, view);
    if (!buffer) return report(CROFTON_EMPTY, __func__, "the view had no occlusion", view);
    CROFTON_CHECK(check_pointer(nearness, __func__));
    const std::size_t count = std::size_t{buffer->size().width} * buffer->size().height;
    if (capacity < count)
        return report(CROFTON_OUT_OF_RANGE, __func__, "the depth buffer has more pixels than `capacity`", count);
    buffer->read({nearness, count});
    return CROFTON_OK;
}

crofton_status crofton_view_boxes(const crofton_box* boxes, const uint32_t* layer_masks, size_t count,
                                  const crofton_view_request* request, const crofton_jobs* jobs,
                                  crofton_view_result* result) {
    CROFTON_CHANGE(result);
    CROFTON_CHECK(check_array(boxes, count, __func__));
    BoxQuery query;
    CROFTON_CHECK(read_box_request(request, jobs, __func__, *result, query));
    HostJobs executor(jobs);
    cull::find_visible(to_boxes(boxes, count), std::span(layer_masks, layer_masks ? count : 0), result->view,
                       result->boxes, query.options, executor);
    return CROFTON_OK;
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
