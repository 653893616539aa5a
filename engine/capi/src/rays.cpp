#include <crofton/capi/rays.h>

#include <crofton/collide/ray.hpp>
#include <limits>

#include "collider.hpp"
#include "convert.hpp"

using namespace crofton;
using namespace crofton::capi;

namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

crofton_status to_ray(const crofton_ray& ray, const char* function, std::uint64_t item, collide::Ray& result) {
    result = {to_vector(ray.origin), to_vector(ray.direction), ray.max_t};
    return status_of(validate(result, item), function);
}

}  // namespace

crofton_status crofton_box_raycast(const crofton_box* box, const crofton_ray* ray, double* t) {
    CROFTON_CHECK(check_pointer(box, __func__));
    CROFTON_CHECK(check_pointer(ray, __func__));
    CROFTON_CHECK(check_pointer(t, __func__));
    CROFTON_CHECK(status_of(validate(to_box(box), 0), __func__));
    collide::Ray checked;
    CROFTON_CHECK(to_ray(*ray, __func__, kNoItem, checked));
    *t = collide::raycast(checked, to_box(box)).value_or(kNever);
    return CROFTON_OK;
}

crofton_status crofton_collider_raycast(const crofton_collider* collider, const crofton_ray* rays, size_t count,
                                        crofton_ray_hit* hits) {
    const SharedUse use(collider, __func__);
    if (use.failed()) return use.status();
    CROFTON_CHECK(check_array(rays, count, __func__));
    CROFTON_CHECK(check_array(hits, count, __func__));
    collide::Ray ray;
    for (std::size_t i = 0; i < count; ++i) CROFTON_CHECK(to_ray(rays[i], __func__, i, ray));
    for (std::size_t i = 0; i < count; ++i) {
        ray = {to_vector(rays[i].origin), to_vector(rays[i].direction), rays[i].max_t};
        const auto hit = collide::raycast(ray, collider->tree);
        hits[i] = hit ? crofton_ray_hit{hit->t, hit->triangle} : crofton_ray_hit{kNever, CROFTON_NONE};
    }
    return CROFTON_OK;
}

crofton_status crofton_collider_hits_any(const crofton_collider* collider, const crofton_ray* ray, int* hit) {
    const SharedUse use(collider, __func__);
    if (use.failed()) return use.status();
    CROFTON_CHECK(check_pointer(ray, __func__));
    CROFTON_CHECK(check_pointer(hit, __func__));
    collide::Ray checked;
    CROFTON_CHECK(to_ray(*ray, __func__, kNoItem, checked));
    *hit = collide::hits_any(checked, collider->tree) ? 1 : 0;
    return CROFTON_OK;
}
