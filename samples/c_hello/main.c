/* SPDX-License-Identifier: MIT */
/* Crofton from plain C: a scene of a hundred tetrahedra, what a camera sees of it, and which of them
 * touch; then the same frame of a World, which does all of it in one place. */
#include <crofton/capi/crofton.h>
#include <stdio.h>
#include <stdlib.h>

/* What this program does with any failure. */
static void check(crofton_status status) {
    if (status == CROFTON_OK) return;
    fprintf(stderr, "c_hello: %s\n", crofton_last_error());
    exit(1);
}

static uint32_t add_tetrahedron(crofton_scene* scene) {
    static const float positions[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    static const uint32_t indices[] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
    const crofton_mesh mesh = {sizeof mesh, positions, 4, indices, 12, "tetrahedron"};
    uint32_t id;
    check(crofton_scene_add_mesh(scene, &mesh, &id));
    return id;
}

static void add_instances(crofton_scene* scene, uint32_t mesh, int count) {
    for (int i = 0; i < count; ++i) {
        const crofton_transform place = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0.9 * (i % 10) - 4.5, 0.0, -1.5 * (i / 10)}};
        uint32_t node, instance;
        check(crofton_scene_add_node(scene, CROFTON_NONE, &place, ~0u, &node));
        check(crofton_scene_add_instance(scene, node, mesh, &instance));
    }
}

static size_t count_seen(const crofton_box* boxes, const uint32_t* layers, size_t count) {
    crofton_camera camera = {.size = sizeof camera};
    crofton_view view = {.size = sizeof view, .layer_mask = ~0u, .frustum = {.size = sizeof view.frustum}};
    crofton_tree* tree;
    crofton_visible_set* visible;
    const uint32_t* ids;
    size_t seen;
    check(crofton_camera_default(&camera));
    check(crofton_frustum_from_camera(&camera, &view.frustum));
    check(crofton_tree_create(boxes, layers, count, NULL, &tree));
    check(crofton_visible_set_create(&visible));
    check(crofton_cull_tree(tree, &view, NULL, NULL, visible)); /* the one call of every frame */
    check(crofton_visible_set_items(visible, &ids, NULL, &seen));
    check(crofton_visible_set_destroy(visible));
    check(crofton_tree_destroy(tree));
    return seen;
}

static size_t count_pairs(const crofton_box* boxes, size_t count) {
    crofton_broadphase* broadphase;
    const crofton_pair* pairs;
    size_t pair_count;
    check(crofton_broadphase_create(&broadphase));
    check(crofton_broadphase_update(broadphase, boxes, NULL, count, NULL));
    check(crofton_broadphase_pairs(broadphase, CROFTON_PAIRS_ALL, &pairs, &pair_count));
    check(crofton_broadphase_destroy(broadphase));
    return pair_count;
}

/* A frame of World: ten balls in a row, each of which touches the next, and one behind the camera. */
static int show_world(void) {
    crofton_world* world;
    crofton_visible_objects* visible;
    crofton_object object;
    crofton_camera camera = {.size = sizeof camera};
    crofton_object_hit hit;
    const crofton_ray ray = {{-3.2, 0.0, 0.0}, {0.0, 0.0, -1.0}, 100.0};
    const uint32_t* ids;
    size_t seen, contacts;
    check(crofton_world_create(NULL, &world));
    for (int i = 0; i < 11; ++i) {
        const crofton_bound bound = {
            .kind = CROFTON_BOUND_BALL, .center = {0.8 * i - 4.0, 0.0, i < 10 ? -10.0 : 50.0}, .radius = 0.5};
        const crofton_object_description description = {
            .size = sizeof description, .user = 100 + (uint64_t)i, .bound = &bound};
        check(crofton_world_add(world, &description, &object));
    }
    check(crofton_world_update(world, NULL)); /* once a frame; then ask */
    check(crofton_camera_default(&camera));
    check(crofton_visible_objects_create(&visible));
    check(crofton_world_view_camera(world, &camera, NULL, NULL, visible));
    check(crofton_visible_objects_ids(visible, &ids, &seen, NULL, NULL));
    check(crofton_world_contact_count(world, &contacts));
    check(crofton_world_raycast(world, &ray, 1, ~0u, &hit));
    printf("world: %zu of 11 objects in view, %zu contacts, the ray hits object %llu\n", seen, contacts,
           (unsigned long long)hit.user);
    check(crofton_visible_objects_destroy(visible));
    check(crofton_world_destroy(world));
    return seen == 10 && contacts == 9 && hit.user == 101;
}

int main(void) {
    crofton_scene* scene;
    const crofton_box* boxes;
    const uint32_t* layers;
    size_t count;
    if (crofton_api_version() != CROFTON_API_VERSION) return 1;
    check(crofton_scene_create(&scene));
    add_instances(scene, add_tetrahedron(scene), 100);
    check(crofton_scene_update(scene, NULL, NULL));
    check(crofton_scene_boxes(scene, &boxes, &layers, &count));
    const size_t seen = count_seen(boxes, layers, count), pairs = count_pairs(boxes, count);
    printf("crofton %s: %zu of %zu instances in view, %zu pairs of boxes touch\n", crofton_version_string(), seen,
           count, pairs);
    check(crofton_scene_destroy(scene));
    return seen > 0 && seen < count && pairs > 0 && show_world() ? 0 : 1;
}
