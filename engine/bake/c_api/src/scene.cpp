// SPDX-License-Identifier: MIT
#include <crofton/capi/scene.h>

#include <crofton/capi/convert.hpp>
#include <crofton/capi/mesh.hpp>
#include "handles.hpp"

using namespace crofton;
using namespace crofton::capi;

namespace {

// Writes an id where the call succeeded.
crofton_status give(const Result<std::uint32_t>& result, std::uint32_t* id, const char* function) {
    if (!result) return report(result.error(), function);
    *id = *result;
    return CROFTON_OK;
}

}  // namespace

crofton_status crofton_scene_create(crofton_scene** scene) {
    CROFTON_CHECK(check_pointer(scene, __func__));
    return create(scene, __func__);
}

crofton_status crofton_scene_destroy(crofton_scene* scene) {
    return destroy(scene, __func__);
}

crofton_status crofton_scene_add_mesh(crofton_scene* scene, const crofton_mesh* mesh, uint32_t* mesh_id) {
    CROFTON_CHANGE(scene);
    CROFTON_CHECK(check_pointer(mesh_id, __func__));
    TriangleMesh copy;
    CROFTON_CHECK(to_mesh(mesh, __func__, copy));
    return give(scene->scene.add_mesh(std::move(copy), mesh->name ? mesh->name : ""), mesh_id, __func__);
}

crofton_status crofton_scene_add_node(crofton_scene* scene, uint32_t parent, const crofton_transform* local,
                                      uint32_t layer_mask, uint32_t* node_id) {
    CROFTON_CHANGE(scene);
    CROFTON_CHECK(check_pointer(node_id, __func__));
    const Transform transform = local ? to_transform(*local) : Transform();
    return give(scene->scene.add_node(parent, transform, layer_mask), node_id, __func__);
}

crofton_status crofton_scene_add_instance(crofton_scene* scene, uint32_t node, uint32_t mesh, uint32_t* instance_id) {
    CROFTON_CHANGE(scene);
    CROFTON_CHECK(check_pointer(instance_id, __func__));
    return give(scene->scene.add_instance(node, mesh), instance_id, __func__);
}

crofton_status crofton_scene_set_local(crofton_scene* scene, uint32_t node, const crofton_transform* local) {
    CROFTON_CHANGE(scene);
    CROFTON_CHECK(check_pointer(local, __func__));
    return status_of(scene->scene.set_local(node, to_transform(*local)), __func__);
}

crofton_status crofton_scene_set_layer_mask(crofton_scene* scene, uint32_t node, uint32_t layer_mask) {
    CROFTON_CHANGE(scene);
    return status_of(scene->scene.set_layer_mask(node, layer_mask), __func__);
}

crofton_status crofton_scene_remove_instance(crofton_scene* scene, uint32_t instance) {
    CROFTON_CHANGE(scene);
    return status_of(scene->scene.remove_instance(instance), __func__);
}

crofton_status crofton_scene_update(crofton_scene* scene, const crofton_jobs* jobs,
                                    crofton_update_statistics* statistics) {
    CROFTON_CHANGE(scene);
    CROFTON_CHECK(check_jobs(jobs, __func__));
    CROFTON_CHECK(check_optional(statistics, __func__));
    HostJobs executor(jobs);
    const scene::UpdateStatistics done = scene->scene.update(executor);
    if (statistics)
        *statistics = {sizeof *statistics, done.nodes_updated, done.instances_updated, done.instances_invalid};
    return CROFTON_OK;
}

crofton_status crofton_scene_boxes(const crofton_scene* scene, const crofton_box** boxes, const uint32_t** layer_masks,
                                   size_t* count) {
    CROFTON_READ(scene);
    CROFTON_CHECK(check_pointer(boxes, __func__));
    CROFTON_CHECK(check_pointer(layer_masks, __func__));
    CROFTON_CHECK(check_pointer(count, __func__));
    *boxes = to_c(scene->scene.world_boxes().data());
    *layer_masks = scene->scene.layer_masks().data();
    *count = scene->scene.world_boxes().size();
    return CROFTON_OK;
}

crofton_status crofton_scene_moved(const crofton_scene* scene, const uint32_t** instances, size_t* count) {
    CROFTON_READ(scene);
    CROFTON_CHECK(check_pointer(instances, __func__));
    CROFTON_CHECK(check_pointer(count, __func__));
    *instances = scene->scene.moved_instances().data();
    *count = scene->scene.moved_instances().size();
    return CROFTON_OK;
}
