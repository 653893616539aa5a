// SPDX-License-Identifier: MIT
// What queries are asked with, checked: views, rays and shapes.
#pragma once
#include <crofton/capi/modules.h>

#include <crofton/cull/cull.hpp>
#include <crofton/geometry/shapes.hpp>
#include <span>

#include <crofton/capi/call.hpp>
#include <crofton/capi/convert.hpp>
#include <crofton/capi/growing.hpp>
#include <crofton/capi/numbers.hpp>

namespace crofton::capi {

[[nodiscard]] inline crofton_status check_frustum(const crofton_frustum* frustum, const char* function) {
    CROFTON_CHECK(check_struct(frustum, function));
    if (frustum->plane_count > CROFTON_MAX_PLANES)
        return report(CROFTON_OUT_OF_RANGE, function, "a frustum has more planes than CROFTON_MAX_PLANES");
    return CROFTON_OK;
}

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

[[nodiscard]] inline crofton_status give_ids(std::span<const std::uint32_t> from, const std::uint32_t** ids,
                                             std::size_t* count, const char* function) {
    CROFTON_CHECK(check_pointer(ids, function));
    CROFTON_CHECK(check_pointer(count, function));
    *ids = from.data();
    *count = from.size();
    return CROFTON_OK;
}

[[nodiscard]] inline crofton_status to_ray(const crofton_ray& ray, const char* function, std::uint64_t item,
                                           Ray& result) {
    result = {to_vector(ray.origin), to_vector(ray.direction), ray.max_t};
    return status_of(validate(result, item), function);
}

// Answers each ray. A bad ray is an error, and then no hit is written.
template <class Hit, class Answer>
[[nodiscard]] crofton_status answer_rays(const crofton_ray* rays, std::size_t count, Hit* hits, const char* function,
                                         const Answer& answer) {
    CROFTON_CHECK(check_array(rays, count, function));
    CROFTON_CHECK(check_array(hits, count, function));
    Ray ray;
    for (std::size_t i = 0; i < count; ++i) CROFTON_CHECK(to_ray(rays[i], function, i, ray));
    for (std::size_t i = 0; i < count; ++i) {
        ray = {to_vector(rays[i].origin), to_vector(rays[i].direction), rays[i].max_t};
        hits[i] = answer(ray);
    }
    return CROFTON_OK;
}

[[nodiscard]] inline crofton_status to_sphere(const double* center, double radius, const char* function,
                                              Sphere& result) {
    CROFTON_CHECK(check_place(center, "center", function));
    CROFTON_CHECK(check_length(radius, "radius", function));
    result = {to_vector(center), radius};
    return CROFTON_OK;
}

}  // namespace crofton::capi
