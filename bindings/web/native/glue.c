/* SPDX-License-Identifier: MIT */
/* Holds the layout that js/ writes by hand to what the headers say, and turns 64-bit results into numbers. */
#include <crofton/capi/bake.h>
#include <crofton/capi/crofton.h>

#define AT(type, member, place) _Static_assert(offsetof(type, member) == (place), #type "." #member " has moved")
#define SIZE(type, bytes) _Static_assert(sizeof(type) == (bytes), #type " has another size")

SIZE(crofton_box, 72);
AT(crofton_box, axes, 24);
AT(crofton_box, half_extents, 60);
SIZE(crofton_transform, 96);
SIZE(crofton_camera, 128);
AT(crofton_camera, position, 8);
AT(crofton_camera, projection, 80);
AT(crofton_camera, fov_y, 88);
SIZE(crofton_frustum, 416);
AT(crofton_frustum, origin, 8);
AT(crofton_frustum, planes, 32);
SIZE(crofton_fit_options, 32);
AT(crofton_fit_options, criterion, 8);
SIZE(crofton_polygon, 20);
SIZE(crofton_triangulation, 40);
AT(crofton_triangulation, weight, 16);
AT(crofton_triangulation, optimal, 32);
SIZE(crofton_mesh_data, 48);
AT(crofton_mesh_data, clusters, 36);
SIZE(crofton_world_options, 56);
AT(crofton_world_options, pairs, 4);
SIZE(crofton_bound, 160);
AT(crofton_bound, box, 8);
AT(crofton_bound, center, 128);
SIZE(crofton_object_description, 72);
AT(crofton_object_description, layers, 48);
AT(crofton_object_description, occludes, 56);
AT(crofton_object_description, user, 8);
AT(crofton_object_description, bound, 16);
AT(crofton_object_description, mesh, 32);
AT(crofton_object_description, hidden, 68);
SIZE(crofton_object_info, 192);
SIZE(crofton_world_statistics, 80);
AT(crofton_world_statistics, object_count, 64);
SIZE(crofton_mesh_info, 24);
AT(crofton_mesh_info, clusters, 8);
SIZE(crofton_cluster, 8);
_Static_assert(CROFTON_SET_USER == 1 && CROFTON_SET_LAYERS == 2 && CROFTON_SET_HIDDEN == 8 && CROFTON_SET_BOUND == 64,
               "a member has moved");
SIZE(crofton_ray, 56);
SIZE(crofton_object_hit, 88);
AT(crofton_object_hit, t, 16);
AT(crofton_object_hit, triangle, 48);
AT(crofton_object_hit, normal, 56);
AT(crofton_object_hit, started_inside, 80);
SIZE(crofton_query_shape, 144);
AT(crofton_query_shape, box, 8);
AT(crofton_query_shape, begin, 80);
AT(crofton_query_shape, radius, 128);
SIZE(crofton_object_ref, 16);
SIZE(crofton_closest_object, 80);
AT(crofton_closest_object, object, 4);
AT(crofton_closest_object, user, 16);
AT(crofton_closest_object, on_object, 56);
SIZE(crofton_occlusion_options, 24);
AT(crofton_occlusion_options, width, 4);
AT(crofton_occlusion_options, list_occluded, 16);
AT(crofton_occlusion_options, least_cover, 20);
SIZE(crofton_view_matrix, 48);
AT(crofton_view_matrix, depth, 16);
AT(crofton_view_matrix, origin, 24);
SIZE(crofton_draw_limits, 80);
AT(crofton_draw_limits, eye, 8);
AT(crofton_draw_limits, layer_distances, 48);
AT(crofton_draw_limits, drawn_word_count, 64);
AT(crofton_draw_limits, hysteresis, 72);
SIZE(crofton_picture_view, 32);
SIZE(crofton_view_request, 52);
AT(crofton_view_request, picture, 44);
AT(crofton_view_request, receivers, 48);
SIZE(crofton_shadow_receivers, 16);
AT(crofton_shadow_receivers, seen, 4);
AT(crofton_shadow_receivers, radius, 8);
AT(crofton_view_request, limits, 24);
AT(crofton_view_request, candidate_mask, 28);
AT(crofton_view_request, conservative, 36);
AT(crofton_view_request, camera, 4);
AT(crofton_view_request, volume, 12);
AT(crofton_view_request, layers, 16);
AT(crofton_view_request, occlusion, 20);
SIZE(crofton_occluder, 232);
AT(crofton_occluder, box, 32);
SIZE(crofton_view_info, 192);
AT(crofton_view_info, nodes_tested, 8);
AT(crofton_view_info, occluders_drawn, 56);
AT(crofton_view_info, occluded_ids, 120);
AT(crofton_view_info, triangles, 136);
SIZE(crofton_visible_cluster, 16);

/* The item of the last error; -1: none in particular. */
double crofton_web_error_item(void) {
    const uint64_t item = crofton_last_error_item();
    return item == CROFTON_NO_ITEM ? -1.0 : (double)item;
}
