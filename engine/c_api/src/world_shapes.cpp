// SPDX-License-Identifier: MIT
// Casts of shapes in a World.
#include <crofton/capi/crofton.h>

#include <limits>

#include <crofton/capi/shapes.hpp>
#include "world.hpp"

using namespace crofton;
using namespace crofton::capi;

crofton_status crofton_world_cast(const crofton_world* world, const crofton_placed* probe, const crofton_motion* motion,
                                  const crofton_cast_options* options, const crofton_query_filter* filter,
                                  crofton_shape_hit* hit) {
    const SharedUse use(world, __func__);
    if (use.failed()) return use.status();
    QueryFilter accepted;
    CROFTON_CHECK(to_filter(filter, __func__, accepted));
    CROFTON_CHECK(check_growing(hit, __func__));
    const PlacedShape placed(probe, __func__);
    CROFTON_CHECK(placed.status());
    convex::CastOptions wanted;
    CROFTON_CHECK(to_cast_options(options, __func__, wanted));
    const auto found = world->world.cast(placed.shape(), placed.pose(), to_motion(motion), wanted, accepted);
    if (!found) return report(found.error(), __func__);
    crofton_shape_hit result{};
    result.object.index = CROFTON_NONE;
    result.time = std::numeric_limits<double>::infinity();
    if (*found) {
        const ShapeHit& first = **found;
        result.object = {first.object.index, first.object.generation};
        result.user = first.user;
        result.time = first.time;
        std::memcpy(result.normal, &first.normal, sizeof result.normal);
        std::memcpy(result.point, &first.point, sizeof result.point);
        result.triangle = first.triangle;
        result.distance = first.distance;
        result.result = first.resolved ? CROFTON_CAST_HIT : CROFTON_CAST_UNRESOLVED;
    }
    write_growing(result, hit);
    return CROFTON_OK;
}
