/* SPDX-License-Identifier: MIT */
/* The same from C11. */
#include <crofton/capi/crofton.h>
#include <stdio.h>

int main(void) {
    const crofton_box box = {{0, 0, -5}, {1, 0, 0, 0, 1, 0, 0, 0, 1}, {1, 1, 1}};
    const crofton_camera camera = crofton_default_camera();
    crofton_view_request request = crofton_default_view_request();
    crofton_view_result* visible = NULL;
    const uint32_t* ids = NULL;
    size_t count = 0;
    request.camera = &camera;
    if (crofton_view_result_create(&visible) != CROFTON_OK ||
        crofton_view_boxes(&box, NULL, 1, &request, NULL, visible) != CROFTON_OK ||
        crofton_view_result_ids(visible, &ids, &count, NULL, NULL) != CROFTON_OK) {
        fprintf(stderr, "%s\n", crofton_last_error());
        return 1;
    }
    printf("crofton %s from C: %zu box in view\n", crofton_version_string(), count);
    return crofton_view_result_destroy(visible) == CROFTON_OK && count == 1 ? 0 : 1;
}
