// SPDX-License-Identifier: MIT
// Which occluders a view drew, and which of them hide an object.
#include <crofton/capi/crofton.h>

#include <algorithm>

#include "view_result.hpp"

using namespace crofton;
using namespace crofton::capi;

namespace {

// Writes what `query` finds for a result that is of one view of this world.
template <class Query>
crofton_status list_occluders(const crofton_world* world, const crofton_view_result* result,
                              crofton_occluder_ref* occluders, size_t capacity, size_t* count, const char* function,
                              const Query& query) {
    const SharedUse use_world(world, function);
    if (use_world.failed()) return use_world.status();
    const SharedUse use(result, function);
    if (use.failed()) return use.status();
    CROFTON_CHECK(check_pointer(count, function));
    CROFTON_CHECK(check_room(occluders, capacity, function));
    CROFTON_CHECK(check_viewed(*result, *world, function));
    if (result->is_many) return report(CROFTON_UNSUPPORTED, function, "the last call viewed many at once");
    Vector<OccluderRef> found;
    CROFTON_CHECK(status_of(query(world->world, result->one, found), function));
    for (std::size_t i = 0; i < std::min(capacity, found.size()); ++i)
        occluders[i] = {{found[i].object.index, found[i].object.generation}, found[i].user, found[i].place, 0};
    *count = found.size();
    return CROFTON_OK;
}

}  // namespace

crofton_status crofton_world_hidden_by(const crofton_world* world, crofton_object object,
                                       const crofton_view_result* result, crofton_occluder_ref* occluders,
                                       size_t capacity, size_t* count) {
    return list_occluders(world, result, occluders, capacity, count, __func__,
                          [&](const World& w, const ViewResult& view, Vector<OccluderRef>& found) {
                              return w.hidden_by(to_handle(object), view, found);
                          });
}

crofton_status crofton_world_drawn_occluders(const crofton_world* world, const crofton_view_result* result,
                                             crofton_occluder_ref* occluders, size_t capacity, size_t* count) {
    return list_occluders(world, result, occluders, capacity, count, __func__,
                          [](const World& w, const ViewResult& view, Vector<OccluderRef>& found) {
                              return w.drawn_occluders(view, found);
                          });
}
