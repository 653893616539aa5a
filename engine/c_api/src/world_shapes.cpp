// SPDX-License-Identifier: MIT
// Casts and contacts of shapes that are no objects of a World, for the C API.
#include <crofton/capi/crofton.h>

#include <limits>

#include <crofton/capi/shapes.hpp>
#include "found.hpp"
#include "world.hpp"

using namespace crofton;
using namespace crofton::capi;

static_assert(sizeof(crofton_object_manifold) == sizeof(ObjectManifold) &&
              offsetof(crofton_object_manifold, user) == offsetof(ObjectManifold, user) &&
              offsetof(crofton_object_manifold, normal) ==
                  offsetof(ObjectManifold, manifold) + offsetof(convex::Manifold, normal) &&
              offsetof(crofton_object_manifold, depth) ==
                  offsetof(ObjectManifold, manifold) + offsetof(convex::Manifold, depth) &&
              offsetof(crofton_object_manifold, point_count) ==
                  offsetof(ObjectManifold, manifold) + offsetof(convex::Manifold, count) &&
              offsetof(crofton_object_manifold, points) ==
                  offsetof(ObjectManifold, manifold) + offsetof(convex::Manifold, points) &&
              sizeof(crofton_shape_point) == sizeof(convex::ContactPoint));

namespace {

crofton_shape_hit to_c_hit(const ShapeHit& hit) {
    crofton_shape_hit result{};
    result.size = sizeof result;
    result.object = {hit.object.index, hit.object.generation};
    result.user = hit.user;
    result.time = hit.time;
    std::memcpy(result.normal, &hit.normal, sizeof result.normal);
    std::memcpy(result.point, &hit.point, sizeof result.point);
    result.triangle = hit.triangle;
    result.child = hit.child;
    result.distance = hit.distance;
    result.result = hit.resolved ? CROFTON_CAST_HIT : CROFTON_CAST_UNRESOLVED;
    return result;
}

// Checks what a query of a shape that is no object asks with, and calls with the shape, the options and the filter.
template <class Given, class Options, class Ask>
crofton_status ask_with(const crofton_placed* probe, const Given* given, const crofton_query_filter* filter,
                        const char* function, crofton_status (*read)(const Given*, const char*, Options&), Ask ask) {
    QueryFilter accepted;
    CROFTON_CHECK(to_filter(filter, function, accepted));
    const PlacedShape placed(probe, function);
    CROFTON_CHECK(placed.status());
    Options options;
    CROFTON_CHECK(read(given, function, options));
    return ask(placed, options, accepted);
}

}  // namespace

crofton_status crofton_world_cast(const crofton_world* world, const crofton_placed* probe, const crofton_motion* motion,
                                  const crofton_cast_options* options, const crofton_query_filter* filter,
                                  crofton_shape_hit* hit) {
    CROFTON_READ(world);
    CROFTON_CHECK(check_growing(hit, __func__));
    const auto ask = [&, function = __func__](const PlacedShape& placed, const convex::CastOptions& wanted,
                                              const QueryFilter& accepted) {
        const auto found = world->world.cast(placed.shape(), placed.pose(), to_motion(motion), wanted, accepted);
        if (!found) return report(found.error(), function);
        crofton_shape_hit result{};
        result.object.index = CROFTON_NONE;
        result.triangle = CROFTON_NONE;
        result.time = std::numeric_limits<double>::infinity();
        if (*found) result = to_c_hit(**found);
        write_growing(result, hit);
        return CROFTON_OK;
    };
    return ask_with(probe, options, filter, __func__, to_cast_options, ask);
}

crofton_status crofton_world_cast_all(const crofton_world* world, const crofton_placed* probe,
                                      const crofton_motion* motion, const crofton_cast_options* options,
                                      const crofton_query_filter* filter, crofton_found* found) {
    CROFTON_READ(world);
    CROFTON_CHANGE(found);
    const auto ask = [&, function = __func__](const PlacedShape& placed, const convex::CastOptions& wanted,
                                              const QueryFilter& accepted) {
        return recover(function, [&] {
            Vector<ShapeHit> hits;
            const auto done =
                world->world.cast_all(placed.shape(), placed.pose(), to_motion(motion), wanted, hits, accepted);
            if (!done) return report(done.error(), function);
            found->clear();
            for (const ShapeHit& hit : hits) found->shape_hits.push_back(to_c_hit(hit));
            return CROFTON_OK;
        });
    };
    return ask_with(probe, options, filter, __func__, to_cast_options, ask);
}

crofton_status crofton_world_manifolds(const crofton_world* world, const crofton_placed* probe,
                                       const crofton_manifold_options* options, const crofton_query_filter* filter,
                                       crofton_found* found) {
    CROFTON_READ(world);
    CROFTON_CHANGE(found);
    const auto ask = [&, function = __func__](const PlacedShape& placed, const convex::ManifoldOptions& wanted,
                                              const QueryFilter& accepted) {
        return recover(function, [&] {
            found->clear();
            const auto done =
                world->world.contact_manifolds(placed.shape(), placed.pose(), wanted, found->manifolds, accepted);
            return done ? CROFTON_OK : report(done.error(), function);
        });
    };
    return ask_with(probe, options, filter, __func__, to_manifold_options, ask);
}

crofton_status crofton_found_shape_hits(const crofton_found* found, const crofton_shape_hit** hits, size_t* count) {
    CROFTON_READ(found);
    return give_list(found->shape_hits, hits, count, __func__);
}

crofton_status crofton_found_manifolds(const crofton_found* found, const crofton_object_manifold** manifolds,
                                       size_t* count) {
    CROFTON_READ(found);
    return give_list(found->manifolds, manifolds, count, __func__);
}
