// SPDX-License-Identifier: MIT
// Bodies of a World's objects: contacts that last, and casts.
#include <crofton/capi/crofton.h>

#include <cstddef>
#include <limits>

#include <crofton/capi/bodies.hpp>
#include "world.hpp"

using namespace crofton;
using namespace crofton::capi;

static_assert(sizeof(crofton_body_contact) == sizeof(BodyContact) &&
              offsetof(crofton_body_contact, phase) == offsetof(BodyContact, phase) &&
              offsetof(crofton_body_contact, points) == offsetof(BodyContact, points) &&
              offsetof(crofton_body_contact, point_count) == offsetof(BodyContact, point_count));

crofton_status crofton_world_body_contacts(const crofton_world* world, const crofton_body_contact** contacts,
                                           size_t* count) {
    const SharedUse use(world, __func__);
    if (use.failed()) return use.status();
    CROFTON_CHECK(check_pointer(contacts, __func__));
    CROFTON_CHECK(check_pointer(count, __func__));
    *contacts = reinterpret_cast<const crofton_body_contact*>(world->world.body_contacts().data());
    *count = world->world.body_contacts().size();
    return CROFTON_OK;
}

crofton_status crofton_world_cast(const crofton_world* world, const crofton_placed* shape, const crofton_motion* motion,
                                  const crofton_cast_options* options, uint32_t layer_mask, crofton_body_hit* hit) {
    const SharedUse use(world, __func__);
    if (use.failed()) return use.status();
    CROFTON_CHECK(check_growing(hit, __func__));
    const PlacedBody placed(shape, __func__);
    CROFTON_CHECK(placed.status());
    convex::CastOptions wanted;
    CROFTON_CHECK(to_cast_options(options, __func__, wanted));
    const auto found = world->world.cast(placed.body(), placed.pose(), to_motion(motion), wanted, layer_mask);
    if (!found) return report(found.error(), __func__);
    crofton_body_hit result{};
    result.object.index = CROFTON_NONE;
    result.time = std::numeric_limits<double>::infinity();
    if (*found) {
        const BodyHit& first = **found;
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
