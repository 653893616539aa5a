// SPDX-License-Identifier: MIT
#include <crofton/capi/modules.h>

#include <crofton/fit/fit.hpp>

#include <crofton/capi/call.hpp>
#include <crofton/capi/convert.hpp>

using namespace crofton;
using namespace crofton::capi;

namespace {

measure::Criterion to_criterion(const crofton_criterion& criterion) {
    return {criterion.volume_weight, criterion.area_weight, criterion.mean_curvature_weight};
}

crofton_criterion to_c(const measure::Criterion& criterion) {
    return {criterion.volume_weight, criterion.area_weight, criterion.mean_curvature_weight};
}

crofton_status to_options(const crofton_fit_options* options, const char* function, fit::FitOptions& result) {
    CROFTON_CHECK(check_optional(options, function));
    if (!options) return CROFTON_OK;
    if (options->quality > CROFTON_FIT_EXACT) return report(CROFTON_INVALID_ARGUMENT, function, "unknown quality");
    result.criterion = to_criterion(options->criterion);
    result.quality = static_cast<fit::Quality>(options->quality);
    return status_of(validate(result.criterion), function);
}

crofton_status give(const Result<Obb>& fitted, crofton_box* box, const char* function) {
    if (!fitted) return report(fitted.error(), function);
    *box = *capi::to_c(&*fitted);
    return CROFTON_OK;
}

template <class Point>
Result<Obb> fit_points(const void* points, std::size_t count, const fit::FitOptions& options) {
    return fit::fit_obb(std::span(static_cast<const Point*>(points), count), options);
}

}  // namespace

crofton_status crofton_criterion_for_frustum(const crofton_camera* camera, crofton_criterion* criterion) {
    CROFTON_CHECK(check_camera(camera, __func__));
    CROFTON_CHECK(check_pointer(criterion, __func__));
    const auto result = measure::for_frustum(to_camera(*camera));
    if (!result) return report(result.error(), __func__);
    *criterion = to_c(*result);
    return CROFTON_OK;
}

crofton_status crofton_criterion_for_rays(double length, crofton_criterion* criterion) {
    CROFTON_CHECK(check_pointer(criterion, __func__));
    if (!(length >= 0.0) || length > kMaxCoordinate)
        return report(CROFTON_OUT_OF_RANGE, __func__, "the length must be in [0, 1e30]");
    *criterion = to_c(measure::for_rays(length));
    return CROFTON_OK;
}

crofton_status crofton_fit_points(const void* points, size_t point_count, uint32_t is_double,
                                  const crofton_fit_options* options, crofton_box* box) {
    CROFTON_CHECK(is_double ? check_array(static_cast<const double*>(points), point_count, __func__, 3)
                            : check_array(static_cast<const float*>(points), point_count, __func__, 3));
    CROFTON_CHECK(check_pointer(box, __func__));
    fit::FitOptions choice;
    CROFTON_CHECK(to_options(options, __func__, choice));
    return give(is_double ? fit_points<glm::dvec3>(points, point_count, choice)
                          : fit_points<glm::vec3>(points, point_count, choice),
                box, __func__);
}

crofton_status crofton_fit_boxes(const crofton_box* boxes, size_t count, const crofton_criterion* criterion,
                                 crofton_box* box) {
    CROFTON_CHECK(check_valid_boxes(boxes, count, __func__));
    CROFTON_CHECK(check_pointer(box, __func__));
    const measure::Criterion choice = criterion ? to_criterion(*criterion) : measure::minimal_perimeter();
    CROFTON_CHECK(status_of(validate(choice), __func__));
    return give(fit::merge(to_boxes(boxes, count), choice), box, __func__);
}
