// SPDX-License-Identifier: MIT
#include <crofton/capi/bake.h>

#include <crofton/bake/baked_scene.hpp>

#include <crofton/capi/call.hpp>
#include <crofton/capi/clustered_mesh.hpp>
#include <crofton/capi/convert.hpp>
#include "handles.hpp"

using namespace crofton;
using namespace crofton::capi;

static_assert(sizeof(crofton_baked_instance) == sizeof(bake::InstanceRecord) &&
              offsetof(crofton_baked_instance, node) == offsetof(bake::InstanceRecord, node));
static_assert(sizeof(crofton_baked_node) == sizeof(bake::NodeRecord) &&
              offsetof(crofton_baked_node, parent) == offsetof(bake::NodeRecord, parent));

struct crofton_baked_scene {
    static constexpr std::uint32_t kKind = 0x43724f07;
    Header header;
    bake::BakedScene scene;  // its tree has been given away
};

namespace {

// Gives an array where the call has all it needs.
template <class From, class To>
crofton_status give(std::span<const From> from, const To** array, std::size_t* count, const char* function) {
    CROFTON_CHECK(check_pointer(array, function));
    CROFTON_CHECK(check_pointer(count, function));
    *array = reinterpret_cast<const To*>(from.data());
    *count = from.size();
    return CROFTON_OK;
}

crofton_status open_file(const char* path, const crofton_jobs* jobs, bake::FileAccess access,
                         crofton_baked_scene** baked, crofton_tree** tree, const char* function) {
    CROFTON_CHECK(check_pointer(path, function));
    CROFTON_CHECK(check_jobs(jobs, function));
    CROFTON_CHECK(check_pointer(baked, function));
    CROFTON_CHECK(check_pointer(tree, function));
    HostJobs executor(jobs);
    return recover(function, [&] {
        auto opened = bake::BakedScene::open(path, executor, {.access = access});
        if (!opened) return report(opened.error(), function);
        crofton_tree* made = nullptr;
        CROFTON_CHECK(create(&made, function, std::move(opened->tree())));
        if (const crofton_status status = create(baked, function, std::move(*opened)); status != CROFTON_OK) {
            static_cast<void>(destroy(made, function));
            return status;
        }
        *tree = made;
        return CROFTON_OK;
    });
}

}  // namespace

crofton_status crofton_scene_bake(const crofton_scene* scene, const char* path, const crofton_jobs* jobs) {
    CROFTON_READ(scene);
    CROFTON_CHECK(check_pointer(path, __func__));
    CROFTON_CHECK(check_jobs(jobs, __func__));
    HostJobs executor(jobs);
    const char* const function = __func__;
    return recover(function, [&] {
        const auto bytes = bake::bake(scene->scene, executor);
        return bytes ? status_of(bake::write_file(path, *bytes), function) : report(bytes.error(), function);
    });
}

crofton_status crofton_baked_scene_open(const char* path, const crofton_jobs* jobs, crofton_baked_scene** baked,
                                        crofton_tree** tree) {
    return open_file(path, jobs, bake::FileAccess::map, baked, tree, __func__);
}

crofton_status crofton_baked_scene_read(const char* path, const crofton_jobs* jobs, crofton_baked_scene** baked,
                                        crofton_tree** tree) {
    return open_file(path, jobs, bake::FileAccess::read, baked, tree, __func__);
}

crofton_status crofton_baked_scene_destroy(crofton_baked_scene* baked) {
    return destroy(baked, __func__);
}

crofton_status crofton_baked_scene_mesh_count(const crofton_baked_scene* baked, size_t* count) {
    CROFTON_READ(baked);
    CROFTON_CHECK(check_pointer(count, __func__));
    *count = baked->scene.mesh_count();
    return CROFTON_OK;
}

crofton_status crofton_baked_scene_mesh(const crofton_baked_scene* baked, uint32_t mesh_id, crofton_baked_mesh* mesh) {
    CROFTON_READ(baked);
    CROFTON_CHECK(check_struct(mesh, __func__));
    if (mesh_id >= baked->scene.mesh_count())
        return report(CROFTON_OUT_OF_RANGE, __func__, "there is no such mesh", mesh_id);
    const bake::MeshView view = baked->scene.mesh(mesh_id);
    *mesh = {sizeof *mesh,
             reinterpret_cast<const float*>(view.positions.data()),
             view.positions.size(),
             view.colors.empty() ? nullptr : reinterpret_cast<const float*>(view.colors.data()),
             view.indices.data(),
             view.indices.size(),
             view.name.data(),
             view.name.size(),
             *to_c(&view.box),
             view.look.one_sided,
             view.look.flat,
             view.look.unlit,
             0};
    return CROFTON_OK;
}

crofton_status crofton_baked_scene_clusters(const crofton_baked_scene* baked, uint32_t mesh_id,
                                            crofton_clustered_mesh** clustered) {
    CROFTON_READ(baked);
    CROFTON_CHECK(check_pointer(clustered, __func__));
    if (mesh_id >= baked->scene.mesh_count())
        return report(CROFTON_OUT_OF_RANGE, __func__, "there is no such mesh", mesh_id);
    const depth::ClusteredMesh* const clusters = baked->scene.clusters(mesh_id);
    if (clusters == nullptr) return report(CROFTON_EMPTY, __func__, "the mesh was baked without clusters", mesh_id);
    return recover(__func__, [&, function = __func__] { return create(clustered, function, *clusters); });
}

crofton_status crofton_baked_scene_instances(const crofton_baked_scene* baked, const crofton_baked_instance** instances,
                                             size_t* count) {
    CROFTON_READ(baked);
    return give(baked->scene.instances(), instances, count, __func__);
}

crofton_status crofton_baked_scene_nodes(const crofton_baked_scene* baked, const crofton_baked_node** nodes,
                                         size_t* count) {
    CROFTON_READ(baked);
    return give(baked->scene.nodes(), nodes, count, __func__);
}
