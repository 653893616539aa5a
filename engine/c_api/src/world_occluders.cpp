// SPDX-License-Identifier: MIT
// Sets, reads and finds a World's occluders, for the C API.
#include <crofton/capi/crofton.h>

#include <crofton/occlude/occluder.hpp>

#include <crofton/capi/convert.hpp>
#include <crofton/capi/growing.hpp>
#include <crofton/geometry/mesh_counts.hpp>
#include "world.hpp"

using namespace crofton;
using namespace crofton::capi;
using occlude::FoundOccluder;

static_assert(CROFTON_OCCLUDER_PATCH == static_cast<int>(occlude::OccluderKind::patch));
static_assert(CROFTON_OCCLUDER_WALLED == static_cast<int>(occlude::OccluderKind::walled));

namespace {

Aabb to_bounds(const double (&min)[3], const double (&max)[3]) {
    return {to_vector(min), to_vector(max)};
}
void copy_bounds(const Aabb& bounds, double (&min)[3], double (&max)[3]) {
    for (int k = 0; k < 3; ++k) {
        min[k] = bounds.min[k];
        max[k] = bounds.max[k];
    }
}

crofton_status check_occluder(const crofton_occluder& given, const char* function) {
    if (given.kind > CROFTON_OCCLUDER_PATCH)
        return report(CROFTON_INVALID_ARGUMENT, function, "unknown kind of occluder");
    CROFTON_CHECK(check_array(given.positions, given.position_count, function, 3));
    CROFTON_CHECK(check_array(given.indices, given.index_count, function));
    return status_of(detail::check_mesh_counts(given.position_count, given.index_count), function);
}

FoundOccluder to_occluder(const crofton_occluder& given) {
    FoundOccluder result;
    result.kind = static_cast<occlude::OccluderKind>(given.kind);
    result.sides = given.is_one_sided ? occlude::Sides::front : occlude::Sides::both;
    result.box = to_box(&given.box);
    result.surface.positions.resize(given.position_count);
    for (std::size_t i = 0; i < given.position_count; ++i) {
        const float* p = given.positions + 3 * i;
        result.surface.positions[i] = {p[0], p[1], p[2]};
    }
    result.surface.indices.assign(given.indices, given.indices + given.index_count);
    result.edges = given.edges;
    if (given.has_piece) result.piece_bounds = to_bounds(given.piece_min, given.piece_max);
    if (given.has_eyes) result.eyes_within = to_bounds(given.eyes_min, given.eyes_max);
    result.mean_shadow = given.mean_shadow;
    result.gain = given.gain;
    return result;
}

occlude::FindOptions to_find_options(const crofton_find_options& given) {
    occlude::FindOptions options;
    if (given.is_two_sided) options.sides = occlude::Sides::both;
    if (given.max_occluders) options.max_occluders = given.max_occluders;
    if (given.max_edges) options.max_edges = given.max_edges;
    if (given.max_boxes_a_piece) options.max_boxes_a_piece = given.max_boxes_a_piece;
    if (given.grid) options.grid = given.grid;
    if (given.least_gain != 0.0) options.least_gain = given.least_gain;
    if (given.flatness != 0.0) options.flatness = given.flatness;
    if (given.max_patch_triangles) options.max_patch_triangles = given.max_patch_triangles;
    options.level_triangles = given.level_triangles;
    return options;
}

}  // namespace

crofton_status crofton_world_find_occluders(crofton_world* world, crofton_world_mesh mesh,
                                            const crofton_find_options* options) {
    CROFTON_CHANGE(world);
    crofton_find_options given{};
    if (options) CROFTON_CHECK(read_growing(options, __func__, given));
    return status_of(world->world.find_occluders(to_handle(mesh), to_find_options(given)), __func__);
}

crofton_status crofton_world_set_occluders(crofton_world* world, crofton_world_mesh mesh,
                                           const crofton_occluder* occluders, size_t count) {
    CROFTON_CHANGE(world);
    CROFTON_CHECK(check_array(occluders, count, __func__));
    Vector<FoundOccluder> given;
    for (std::size_t i = 0; i < count; ++i) {
        crofton_occluder occluder;
        CROFTON_CHECK(of_item(read_growing_at(occluders, i, __func__, occluder), i));
        CROFTON_CHECK(of_item(check_occluder(occluder, __func__), i));
        given.push_back(to_occluder(occluder));
    }
    return status_of(world->world.set_occluders(to_handle(mesh), given), __func__);
}

crofton_status crofton_world_get_occluder(const crofton_world* world, crofton_world_mesh mesh, size_t place,
                                          crofton_occluder* occluder) {
    CROFTON_READ(world);
    CROFTON_CHECK(check_growing(occluder, __func__));
    CROFTON_CHECK(check_mesh(*world, mesh, __func__));
    const auto all = world->world.occluders_of(to_handle(mesh));
    if (place >= all.size()) return report(CROFTON_OUT_OF_RANGE, __func__, "the mesh has fewer occluders", place);
    const FoundOccluder& found = all[place];
    crofton_occluder result{};
    result.kind = static_cast<std::uint32_t>(found.kind);
    result.is_one_sided = found.sides == occlude::Sides::front ? 1u : 0u;
    result.positions = found.surface.positions.empty() ? nullptr : &found.surface.positions[0].x;
    result.position_count = found.surface.positions.size();
    result.indices = found.surface.indices.data();
    result.index_count = found.surface.indices.size();
    std::memcpy(&result.box, static_cast<const void*>(&found.box), sizeof result.box);
    result.edges = found.edges;
    result.has_piece = found.piece_bounds.is_empty() ? 0u : 1u;
    if (result.has_piece) copy_bounds(found.piece_bounds, result.piece_min, result.piece_max);
    result.has_eyes = 1u;
    copy_bounds(found.eyes_within, result.eyes_min, result.eyes_max);
    result.mean_shadow = found.mean_shadow;
    result.gain = found.gain;
    write_growing(result, occluder);
    return CROFTON_OK;
}
