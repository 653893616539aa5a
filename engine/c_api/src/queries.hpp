// SPDX-License-Identifier: MIT
// What queries are asked with, checked: views, rays and bodies.
#pragma once
#include <crofton/capi/modules.h>

#include <crofton/cull/cull.hpp>
#include <crofton/geometry/shapes.hpp>
#include <span>

#include <crofton/capi/call.hpp>
#include <crofton/capi/convert.hpp>
#include <crofton/capi/numbers.hpp>
#include "growing.hpp"

namespace crofton::capi {

[[nodiscard]] inline crofton_status check_frustum(const crofton_frustum* frustum, const char* function) {
    CROFTON_CHECK(check_struct(frustum, function));
    if (frustum->plane_count > CROFTON_MAX_PLANES)
        return report(CROFTON_OUT_OF_RANGE, function, "a frustum has more planes than CROFTON_MAX_PLANES");
    return CROFTON_OK;
}

[[nodiscard]] inline crofton_status check_view(const crofton_view* view, const char* function) {
    CROFTON_CHECK(check_struct(view, function));
    return check_frustum(&view->frustum, function);
}

// What a query is asked with. `options` points to `limits` where there are any.
struct CullAsked {
    cull::CullOptions options;
    cull::DrawLimits limits;

    CullAsked() = default;
    CullAsked(const CullAsked&) = delete;
    CullAsked& operator=(const CullAsked&) = delete;
};

[[nodiscard]] inline crofton_status read_limits(const crofton_draw_limits& argument, const char* function,
                                                cull::DrawLimits& limits) {
    crofton_draw_limits given;
    CROFTON_CHECK(read_growing(&argument, function, given));
    CROFTON_CHECK(check_array(given.item_distances, given.item_count, function));
    CROFTON_CHECK(check_array(given.drawn_before, given.drawn_word_count, function));
    if (given.hysteresis != 0.0 && !(given.hysteresis >= 1.0))
        return report(CROFTON_OUT_OF_RANGE, function, "draw limits: `hysteresis` is less than 1 or NaN");
    limits = {.eye = to_vector(given.eye),
              .max_distance_in_radii =
                  given.max_distance_in_radii != 0.0 ? given.max_distance_in_radii : cull::DrawLimits::kNone,
              .least_radius = given.least_radius,
              .layer_distances = std::span(given.layer_distances, given.layer_distances ? 32 : 0),
              .item_distances = std::span(given.item_distances, given.item_count),
              .drawn_before = std::span(given.drawn_before, given.drawn_word_count),
              .hysteresis = given.hysteresis != 0.0 ? given.hysteresis : 1.0};
    return CROFTON_OK;
}

// `options` or NULL.
[[nodiscard]] inline crofton_status read_options(const crofton_cull_options* options, const char* function,
                                                 CullAsked& asked) {
    if (!options) return CROFTON_OK;
    crofton_cull_options given;
    CROFTON_CHECK(read_growing(options, function, given));
    CROFTON_CHECK(check_array(given.candidate_mask, given.candidate_words, function));
    asked.options = {
        .mode = given.conservative ? cull::CullMode::conservative : cull::CullMode::exact,
        .order = given.tree_order ? cull::ResultOrder::tree : cull::ResultOrder::ascending,
        .candidate_mask = std::span(given.candidate_mask, given.candidate_mask ? given.candidate_words : 0)};
    if (!given.limits) return CROFTON_OK;
    asked.options.limits = &asked.limits;
    return read_limits(*given.limits, function, asked.limits);
}

[[nodiscard]] inline crofton_status read_query(const crofton_view* view, const crofton_cull_options* options,
                                               const crofton_jobs* jobs, const char* function, CullAsked& asked) {
    CROFTON_CHECK(check_view(view, function));
    CROFTON_CHECK(read_options(options, function, asked));
    return check_jobs(jobs, function);
}

// Requires a view that has been checked.
inline void copy_view(const crofton_view& view, cull::View& result) {
    copy_frustum(view.frustum, result.frustum);
    result.layer_mask = view.layer_mask;
}

// What a query is asked with. It stays in the result's object, so that a query need not clear planes that it does not
// use.
template <class Result>
[[nodiscard]] const cull::View& set_view(Result& result, const crofton_view& view) {
    copy_view(view, result.view);
    return result.view;
}

[[nodiscard]] inline crofton_status give_ids(std::span<const std::uint32_t> from, const std::uint32_t** ids,
                                             std::size_t* count, const char* function) {
    CROFTON_CHECK(check_pointer(ids, function));
    CROFTON_CHECK(check_pointer(count, function));
    *ids = from.data();
    *count = from.size();
    return CROFTON_OK;
}

// The ids and, where there are any, the verdicts of a set that is seen. `verdicts` may be null.
template <class Visible>
[[nodiscard]] crofton_status give_seen(const Visible& seen, const std::uint32_t** ids, std::size_t* count,
                                       const std::uint8_t** verdicts, const char* function) {
    CROFTON_CHECK(give_ids(seen.ids(), ids, count, function));
    if (verdicts)
        *verdicts = seen.verdicts().empty() ? nullptr : reinterpret_cast<const std::uint8_t*>(seen.verdicts().data());
    return CROFTON_OK;
}

[[nodiscard]] inline crofton_status give_statistics(const cull::Statistics& s, crofton_cull_statistics* statistics,
                                                    const char* function) {
    CROFTON_CHECK(check_struct(statistics, function));
    *statistics = {sizeof *statistics, s.nodes_tested, s.boxes_tested,   s.accepted_whole,
                   s.straddling,       s.exact_tests,  s.false_positives};
    return CROFTON_OK;
}

[[nodiscard]] inline crofton_status to_ray(const crofton_ray& ray, const char* function, std::uint64_t item,
                                           Ray& result) {
    result = {to_vector(ray.origin), to_vector(ray.direction), ray.max_t};
    return status_of(validate(result, item), function);
}

[[nodiscard]] inline crofton_status to_sphere(const double* center, double radius, const char* function,
                                              Sphere& result) {
    CROFTON_CHECK(check_place(center, "center", function));
    CROFTON_CHECK(check_length(radius, "radius", function));
    result = {to_vector(center), radius};
    return CROFTON_OK;
}

}  // namespace crofton::capi
