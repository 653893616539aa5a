// SPDX-License-Identifier: MIT
#include <crofton/capi/bake.h>

#include <cerrno>
#include <crofton/bake/baked_scene.hpp>
#include <cstdio>
#include <cstring>
#include <string>

#include "call.hpp"
#include "convert.hpp"
#include "scene.hpp"
#include "tree.hpp"

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

crofton_status write_file(const char* path, std::span<const std::byte> bytes, const char* function) {
    std::FILE* file = std::fopen(path, "wb");
    bool written = file != nullptr && std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size();
    int reason = errno;
    if (file != nullptr && std::fclose(file) != 0 && written) {
        written = false;
        reason = errno;
    }
    if (written) return CROFTON_OK;
    if (file != nullptr) std::remove(path);
    return report(CROFTON_IO, function, (std::string(path) + ": " + std::strerror(reason)).c_str());
}

// Gives an array where the call has all it needs.
template <class From, class To>
crofton_status give(std::span<const From> from, const To** array, std::size_t* count, const char* function) {
    CROFTON_CHECK(check_pointer(array, function));
    CROFTON_CHECK(check_pointer(count, function));
    *array = reinterpret_cast<const To*>(from.data());
    *count = from.size();
    return CROFTON_OK;
}

}  // namespace

crofton_status crofton_scene_bake(const crofton_scene* scene, const char* path, const crofton_jobs* jobs) {
    const SharedUse use(scene, __func__);
    if (use.failed()) return use.status();
    CROFTON_CHECK(check_pointer(path, __func__));
    CROFTON_CHECK(check_jobs(jobs, __func__));
    HostJobs executor(jobs);
    const auto bytes = bake::bake(scene->scene, executor);
    if (!bytes) return report(bytes.error(), __func__);
    return write_file(path, *bytes, __func__);
}

crofton_status crofton_baked_scene_open(const char* path, const crofton_jobs* jobs, crofton_baked_scene** baked,
                                        crofton_tree** tree) {
    CROFTON_CHECK(check_pointer(path, __func__));
    CROFTON_CHECK(check_jobs(jobs, __func__));
    CROFTON_CHECK(check_pointer(baked, __func__));
    CROFTON_CHECK(check_pointer(tree, __func__));
    HostJobs executor(jobs);
    auto opened = bake::BakedScene::open(path, executor);
    if (!opened) return report(opened.error(), __func__);
    *tree = create<crofton_tree>(std::move(opened->tree()));
    *baked = create<crofton_baked_scene>(std::move(*opened));
    return CROFTON_OK;
}

crofton_status crofton_baked_scene_destroy(crofton_baked_scene* baked) {
    return destroy(baked, __func__);
}

crofton_status crofton_baked_scene_mesh_count(const crofton_baked_scene* baked, size_t* count) {
    const SharedUse use(baked, __func__);
    if (use.failed()) return use.status();
    CROFTON_CHECK(check_pointer(count, __func__));
    *count = baked->scene.mesh_count();
    return CROFTON_OK;
}

crofton_status crofton_baked_scene_mesh(const crofton_baked_scene* baked, uint32_t mesh_id, crofton_baked_mesh* mesh) {
    const SharedUse use(baked, __func__);
    if (use.failed()) return use.status();
    CROFTON_CHECK(check_struct(mesh, __func__));
    if (mesh_id >= baked->scene.mesh_count())
        return report(CROFTON_OUT_OF_RANGE, __func__, "there is no such mesh", mesh_id);
    const bake::MeshView view = baked->scene.mesh(mesh_id);
    *mesh = {sizeof *mesh,          reinterpret_cast<const float*>(view.positions.data()),
             view.positions.size(), view.colors.empty() ? nullptr : reinterpret_cast<const float*>(view.colors.data()),
             view.indices.data(),   view.indices.size(),
             view.name.data(),      view.name.size(),
             *to_c(&view.box)};
    return CROFTON_OK;
}

crofton_status crofton_baked_scene_instances(const crofton_baked_scene* baked, const crofton_baked_instance** instances,
                                             size_t* count) {
    const SharedUse use(baked, __func__);
    if (use.failed()) return use.status();
    return give(baked->scene.instances(), instances, count, __func__);
}

crofton_status crofton_baked_scene_nodes(const crofton_baked_scene* baked, const crofton_baked_node** nodes,
                                         size_t* count) {
    const SharedUse use(baked, __func__);
    if (use.failed()) return use.status();
    return give(baked->scene.nodes(), nodes, count, __func__);
}
