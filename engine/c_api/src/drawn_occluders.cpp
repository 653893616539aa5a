// SPDX-License-Identifier: MIT
// Which occluders a view drew, and which of them hide an object.
#include <crofton/capi/crofton.h>

#include <algorithm>

#include "view_result.hpp"

using namespace crofton;
using namespace crofton::capi;

namespace {

// `result` is of one view of this world; there is room for occluders of it.
crofton_status check_asked_of(const crofton_world& world, const crofton_view_result& result,
                              const crofton_occluder_ref* occluders, size_t capacity, const size_t* count,
                              const char* function) {
    CROFTON_CHECK(check_pointer(count, function));
    CROFTON_CHECK(check_room(occluders, capacity, function));
    CROFTON_CHECK(check_viewed(result, world, function));
    if (result.is_many) return report(CROFTON_UNSUPPORTED, function, "the last call viewed many at once");
    return CROFTON_OK;
}

void write_occluders(const Vector<OccluderRef>& found, crofton_occluder_ref* occluders, size_t capacity,
                     size_t* count) {
    for (std::size_t i = 0; i < std::min(capacity, found.size()); ++i)
        occluders[i] = {{found[i].object.index, found[i].object.generation}, found[i].user, found[i].place, 0};
    *count = found.size();
}

}  // namespace

crofton_status crofton_world_hidden_by(const crofton_world* world, crofton_object object,
                                       const crofton_view_result* result, crofton_occluder_ref* occluders,
                                       size_t capacity, size_t* count) {
    const SharedUse use_world(world, __func__);
    if (use_world.failed()) return use_world.status();
    const SharedUse use(result, __func__);
    if (use.failed()) return use.status();
    CROFTON_CHECK(check_asked_of(*world, *result, occluders, capacity, count, __func__));
    Vector<OccluderRef> found;
    CROFTON_CHECK(status_of(world->world.hidden_by(to_handle(object), result->one, found), __func__));
    write_occluders(found, occluders, capacity, count);
    return CROFTON_OK;
}

crofton_status crofton_world_drawn_occluders(const crofton_world* world, const crofton_view_result* result,
                                             crofton_occluder_ref* occluders, size_t capacity, size_t* count) {
    const SharedUse use_world(world, __func__);
    if (use_world.failed()) return use_world.status();
    const SharedUse use(result, __func__);
    if (use.failed()) return use.status();
    CROFTON_CHECK(check_asked_of(*world, *result, occluders, capacity, count, __func__));
    Vector<OccluderRef> found;
    CROFTON_CHECK(status_of(world->world.drawn_occluders(result->one, found), __func__));
    write_occluders(found, occluders, capacity, count);
    return CROFTON_OK;
}
