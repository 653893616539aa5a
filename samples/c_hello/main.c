/* SPDX-License-Identifier: MIT */
/* Crofton from plain C: a World of a hundred tetrahedra and a sphere; what a camera sees, what touches, what a ray
 * hits.
 */
#include <crofton/capi/crofton.h>
#include <stdio.h>
#include <stdlib.h>

/* What this program does with any failure. */
static void check(crofton_status status) {
    if (status == CROFTON_OK) return;
    fprintf(stderr, "c_hello: %s\n", crofton_last_error());
    exit(1);
}

/* Ten rows of ten, each of which nearly reaches the next; their numbers are what answers give back. */
static void add_tetrahedra(crofton_world* world) {
    static const float positions[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    static const uint32_t indices[] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
    crofton_mesh_data data = crofton_default_mesh_data();
    data.positions = positions;
    data.position_count = 4;
    data.indices = indices;
    data.index_count = 12;
    crofton_world_mesh mesh;
    check(crofton_world_add_mesh(world, &data, &mesh));
    for (int i = 0; i < 100; ++i) {
        const crofton_transform place = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0.9 * (i % 10) - 4.5, 0.0, -1.5 * (i / 10)}};
        crofton_object_description description = crofton_default_object_description();
        description.user = (uint64_t)i;
        description.transform = &place;
        description.has_mesh = 1;
        description.mesh = mesh;
        crofton_object object;
        check(crofton_world_add(world, &description, &object));
    }
}

/* An object may be a bound alone. */
static crofton_bound sphere_at(double x) {
    return (crofton_bound){.kind = CROFTON_BOUND_SPHERE, .center = {x, 0.2, -3.0}, .radius = 0.5};
}

int main(void) {
    crofton_world* world;
    crofton_view_result* visible;
    const crofton_camera camera = crofton_default_camera();
    crofton_view_request request = crofton_default_view_request();
    crofton_object_hit hit;
    const crofton_object_pair* pairs;
    const uint32_t* ids;
    const crofton_ray ray = {{-4.3, 0.2, 5.0}, {0.0, 0.0, -1.0}, 100.0};
    const crofton_object_contact* contacts;
    crofton_object object;
    crofton_object_description sphere = crofton_default_object_description();
    crofton_world_statistics statistics = {.size = sizeof statistics};
    size_t seen = 0, pair_count = 0, contact_count = 0;
    if (crofton_api_version() != CROFTON_API_VERSION) return 1;
    request.camera = &camera;
    check(crofton_world_create(NULL, &world));
    check(crofton_view_result_create(&visible));
    add_tetrahedra(world);
    crofton_bound bound = sphere_at(-6.0);
    sphere.user = 100;
    sphere.bound = &bound;
    check(crofton_world_add(world, &sphere, &object));
    for (int frame = 0; frame < 10; ++frame) {
        bound = sphere_at(0.5 * frame - 6.0);
        check(crofton_world_set(world, object, CROFTON_SET_BOUND, &sphere));
        check(crofton_world_update(world, NULL)); /* once a frame, before the queries */
        check(crofton_world_view(world, &request, 1, NULL, visible));
        check(crofton_view_result_ids(visible, &ids, &seen, NULL, NULL));
        check(crofton_world_contacts(world, &contacts, &contact_count));
    }
    check(crofton_world_get_statistics(world, &statistics));
    check(crofton_world_pairs(world, &pairs, &pair_count));
    check(crofton_world_raycast(world, &ray, 1, NULL, &hit));
    const size_t count = (size_t)statistics.object_count;
    printf("crofton %s: %zu of %zu objects in view, %zu pairs of bounds meet, %zu of them touch\n",
           crofton_version_string(), seen, count, pair_count, contact_count);
    printf("the ray hits object %llu at %.2f\n", (unsigned long long)hit.user, hit.t);
    check(crofton_view_result_destroy(visible));
    check(crofton_world_destroy(world));
    return seen > 0 && seen < count && pair_count > contact_count && contact_count > 0 && hit.user == 0 ? 0 : 1;
}
