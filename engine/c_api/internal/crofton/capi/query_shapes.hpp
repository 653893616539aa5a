// SPDX-License-Identifier: MIT
// What a query asks with: boxes, spheres, capsules, shapes.
#pragma once
#include <crofton/capi/modules.h>

#include <crofton/collide/narrow_phase.hpp>

#include <crofton/capi/queries.hpp>
#include <crofton/capi/shapes.hpp>

namespace crofton::capi {

// Calls with the box, sphere or capsule, or with the shape and its pose, once it is checked.
template <class Visit>
[[nodiscard]] crofton_status visit_shape(const crofton_query_shape* probe, const char* function, Visit visit) {
    CROFTON_CHECK(check_pointer(probe, function));
    switch (probe->kind) {
        case CROFTON_QUERY_SHAPE_BOX:
            CROFTON_CHECK(status_of(validate(to_box(&probe->box)), function));
            return visit(to_box(&probe->box));
        case CROFTON_QUERY_SHAPE_SPHERE: {
            Sphere sphere;
            CROFTON_CHECK(to_sphere(probe->begin, probe->radius, function, sphere));
            return visit(sphere);
        }
        case CROFTON_QUERY_SHAPE_CAPSULE: {
            Sphere begin, end;
            CROFTON_CHECK(to_sphere(probe->begin, probe->radius, function, begin));
            CROFTON_CHECK(to_sphere(probe->end, probe->radius, function, end));
            return visit(collide::Capsule{begin.center, end.center, probe->radius});
        }
        case CROFTON_QUERY_SHAPE_SHAPE: {
            const PlacedShape placed(&probe->shape, function);
            CROFTON_CHECK(placed.status());
            if (placed.shape().kind() == convex::Kind::half_space)
                return report(CROFTON_UNSUPPORTED, function,
                              "a half-space overlaps nearly everything; use a bounded shape");
            return visit(placed.shape(), placed.pose());
        }
        default:
            return report(CROFTON_INVALID_ARGUMENT, function, "unknown kind of probe");
    }
}

}  // namespace crofton::capi
