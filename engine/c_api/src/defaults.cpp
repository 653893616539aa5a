// SPDX-License-Identifier: MIT
// Fills the descriptions and options of the C API with their defaults.
#include <crofton/capi/crofton.h>

#include <algorithm>
#include <crofton/depth/depth_culler.hpp>
#include <crofton/fit/fit.hpp>
#include <crofton/world/world.hpp>

using namespace crofton;

namespace {

template <class Struct>
Struct sized() {
    Struct result{};
    result.size = sizeof result;
    return result;
}

}  // namespace

crofton_world_options crofton_default_world_options(void) {
    const WorldOptions options;
    auto result = sized<crofton_world_options>();
    result.pairs = options.pairs;
    result.contacts = options.contacts;
    result.containment = options.containment;
    result.mesh_depth = options.mesh_depth;
    result.max_pairs = options.max_pairs;
    result.rebuild_budget = CROFTON_AUTOMATIC;
    result.updates_to_rest = options.updates_to_rest;
    result.contact_margin = options.contact_margin;
    return result;
}

crofton_mesh_data crofton_default_mesh_data(void) {
    auto result = sized<crofton_mesh_data>();
    result.triangles = 1;
    return result;
}

crofton_object_description crofton_default_object_description(void) {
    const ObjectDescription description;
    auto result = sized<crofton_object_description>();
    result.layers = description.layers;
    result.collides_with = description.collides_with;
    result.occludes = description.occludes;
    result.only_occludes = description.only_occludes;
    result.hidden = description.hidden;
    return result;
}

crofton_region_object crofton_default_region_object(void) {
    const RegionObject object;
    crofton_region_object result{};
    result.layers = object.layers;
    result.collides_with = object.collides_with;
    result.mesh = object.mesh;
    result.occludes = object.occludes;
    return result;
}

crofton_region_options crofton_default_region_options(void) {
    auto result = sized<crofton_region_options>();
    result.max_objects = RegionOptions().max_objects;
    result.max_origin = RegionOptions().max_origin;
    return result;
}

crofton_occlusion_options crofton_default_occlusion_options(void) {
    const OcclusionOptions options;
    auto result = sized<crofton_occlusion_options>();
    result.width = static_cast<std::uint32_t>(options.size.width);
    result.height = static_cast<std::uint32_t>(options.size.height);
    result.max_occluders = options.max_occluders;
    result.list_occluded = options.list_occluded;
    result.least_cover = options.least_cover;
    return result;
}

crofton_view_matrix crofton_default_view_matrix(void) {
    return sized<crofton_view_matrix>();
}

crofton_view_request crofton_default_view_request(void) {
    auto result = sized<crofton_view_request>();
    result.layers = ViewRequest().layers;
    return result;
}

crofton_find_options crofton_default_find_options(void) {
    return sized<crofton_find_options>();
}

crofton_draw_limits crofton_default_draw_limits(void) {
    return sized<crofton_draw_limits>();
}

crofton_depth_object crofton_default_depth_object(void) {
    const depth::DepthObject object;
    auto result = sized<crofton_depth_object>();
    std::copy_n(&object.to_clip[0][0], 16, result.to_clip);
    result.one_sided = object.one_sided;
    result.hides = object.hides;
    result.position_error = object.position_error;
    return result;
}

crofton_picture_view crofton_default_picture_view(void) {
    const depth::PictureView view;
    auto result = sized<crofton_picture_view>();
    result.width = view.width;
    result.height = view.height;
    result.depth = static_cast<std::uint32_t>(view.depth);
    result.samples = view.samples;
    result.work_limit = view.work_limit;
    return result;
}

crofton_shadow_receivers crofton_default_shadow_receivers(void) {
    auto result = sized<crofton_shadow_receivers>();
    result.radius = double{ShadowReceivers().radius};
    return result;
}

crofton_depth_receivers crofton_default_depth_receivers(void) {
    auto result = sized<crofton_depth_receivers>();
    result.radius = double{depth::DepthReceivers().radius};
    return result;
}

crofton_shape_description crofton_default_shape_description(void) {
    return sized<crofton_shape_description>();
}

crofton_manifold_options crofton_default_manifold_options(void) {
    return sized<crofton_manifold_options>();
}

crofton_cast_options crofton_default_cast_options(void) {
    auto result = sized<crofton_cast_options>();
    result.duration = 1.0;
    return result;
}

crofton_query_filter crofton_default_query_filter(void) {
    auto result = sized<crofton_query_filter>();
    result.layers = ~0u;
    return result;
}

crofton_fit_options crofton_default_fit_options(void) {
    const fit::FitOptions options;
    auto result = sized<crofton_fit_options>();
    result.quality = CROFTON_FIT_TIGHT;
    result.criterion = {options.criterion.volume_weight, options.criterion.area_weight,
                        options.criterion.mean_curvature_weight};
    return result;
}
