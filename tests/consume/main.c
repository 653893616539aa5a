/* SPDX-License-Identifier: MIT */
/* The same from C11. */
#include <crofton/capi/crofton.h>
#include <stdio.h>

int main(void) {
    const crofton_box box = {{0, 0, -5}, {1, 0, 0, 0, 1, 0, 0, 0, 1}, {1, 1, 1}};
    const crofton_camera camera = crofton_default_camera();
    crofton_view view = {.size = sizeof view, .layer_mask = 1, .frustum = {.size = sizeof view.frustum}};
    crofton_visible_set* visible = NULL;
    const uint32_t* ids = NULL;
    size_t count = 0;
    if (crofton_frustum_from_camera(&camera, &view.frustum) != CROFTON_OK ||
        crofton_visible_set_create(&visible) != CROFTON_OK ||
        crofton_cull_boxes(&box, NULL, 1, &view, NULL, NULL, visible) != CROFTON_OK ||
        crofton_visible_set_items(visible, &ids, NULL, &count) != CROFTON_OK) {
        fprintf(stderr, "%s\n", crofton_last_error());
        return 1;
    }
    printf("crofton %s from C: %zu box in view\n", crofton_version_string(), count);
    return crofton_visible_set_destroy(visible) == CROFTON_OK && count == 1 ? 0 : 1;
}
