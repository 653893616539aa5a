// SPDX-License-Identifier: MIT
// What a query asks with: boxes, spheres, capsules, bodies.
#pragma once
#include <crofton/capi/modules.h>

#include <crofton/collide/narrow_phase.hpp>

#include <crofton/capi/bodies.hpp>
#include <crofton/capi/queries.hpp>

namespace crofton::capi {

// Calls with the box, sphere or capsule, or with the body and its pose, once it is checked.
template <class Visit>
[[nodiscard]] crofton_status visit_shape(const crofton_shape* shape, const char* function, Visit visit) {
    CROFTON_CHECK(check_pointer(shape, function));
    switch (shape->kind) {
        case CROFTON_SHAPE_BOX:
            CROFTON_CHECK(status_of(validate(to_box(&shape->box)), function));
            return visit(to_box(&shape->box));
        case CROFTON_SHAPE_SPHERE: {
            Sphere sphere;
            CROFTON_CHECK(to_sphere(shape->begin, shape->radius, function, sphere));
            return visit(sphere);
        }
        case CROFTON_SHAPE_CAPSULE: {
            Sphere begin, end;
            CROFTON_CHECK(to_sphere(shape->begin, shape->radius, function, begin));
            CROFTON_CHECK(to_sphere(shape->end, shape->radius, function, end));
            return visit(collide::Capsule{begin.center, end.center, shape->radius});
        }
        case CROFTON_SHAPE_BODY: {
            const PlacedBody placed(&shape->body, function);
            CROFTON_CHECK(placed.status());
            if (placed.body().kind() == convex::Kind::half_space)
                return report(CROFTON_UNSUPPORTED, function,
                              "a half-space overlaps nearly everything; use a bounded body");
            return visit(placed.body(), placed.pose());
        }
        default:
            return report(CROFTON_INVALID_ARGUMENT, function, "unknown kind of shape");
    }
}

}  // namespace crofton::capi
