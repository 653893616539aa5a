// SPDX-License-Identifier: MIT
// Meshes cut into clusters, and the triangles of them that a picture needs.
#include <crofton/capi/modules.h>

#include <algorithm>
#include <crofton/depth/clustered_mesh.hpp>
#include <crofton/depth/depth_culler.hpp>
#include <cstddef>
#include <cstring>
#include <functional>

#include <crofton/capi/call.hpp>
#include <crofton/capi/clustered_mesh.hpp>
#include <crofton/capi/convert.hpp>
#include <crofton/capi/growing.hpp>
#include <crofton/capi/mesh.hpp>
#include <crofton/capi/requests.hpp>
#include "clusters.hpp"

using namespace crofton;
using namespace crofton::capi;

struct crofton_depth_culler {
    static constexpr std::uint32_t kKind = 0x43724f0e;
    Header header;
    depth::DepthCuller culler{};
    Vector<depth::DepthObject> objects{};
    Vector<depth::DepthReceiver> receivers{};
    std::uint32_t width = 0, height = 0;  // of the last picture
};

namespace {

crofton_status add_object(const crofton_depth_object& given, const char* function,
                          Vector<depth::DepthObject>& objects) {
    const SharedUse use(given.mesh, function);
    if (use.failed()) return use.status();
    depth::DepthObject object{&given.mesh->mesh, {}, given.one_sided != 0, given.hides != 0, given.position_error};
    std::copy_n(given.to_clip, 16, &object.to_clip[0][0]);
    objects.push_back(object);
    return CROFTON_OK;
}

// The arguments that find_visible and find_casters share.
struct Asked {
    const crofton_depth_object* objects;
    std::size_t object_count;
    const crofton_picture_view* picture;
    const crofton_jobs* jobs;
    const crofton_visible_cluster** clusters;
    std::size_t* count;
    crofton_depth_statistics* statistics;
    const char* function;
};

crofton_status read(const Asked& asked, crofton_depth_culler& culler, depth::PictureView& view) {
    const char* const function = asked.function;
    CROFTON_CHECK(check_array(asked.objects, asked.object_count, function));
    CROFTON_CHECK(check_pointer(asked.clusters, function));
    CROFTON_CHECK(check_pointer(asked.count, function));
    if (asked.statistics) CROFTON_CHECK(check_growing(asked.statistics, function));
    CROFTON_CHECK(read_picture(asked.picture, function, view));
    CROFTON_CHECK(check_jobs(asked.jobs, function));
    culler.objects.clear();
    for (std::size_t i = 0; i < asked.object_count; ++i) {
        crofton_depth_object given;
        CROFTON_CHECK(of_item(read_growing_at(asked.objects, i, function, given), i));
        CROFTON_CHECK(of_item(add_object(given, function, culler.objects), i));
    }
    return CROFTON_OK;
}

void give(const Asked& asked, crofton_depth_culler& culler, const depth::PictureView& view,
          std::span<const depth::VisibleCluster> found) {
    culler.width = view.width;
    culler.height = view.height;
    *asked.clusters = reinterpret_cast<const crofton_visible_cluster*>(found.data());
    *asked.count = found.size();
    const depth::DepthStatistics& s = culler.culler.statistics();
    if (asked.statistics)
        write_growing({sizeof *asked.statistics, s.objects_listed, s.objects_asked, s.clusters_asked, s.clusters_drawn,
                       s.triangles_drawn, s.triangles_listed},
                      asked.statistics);
}

}  // namespace

crofton_status crofton_clustered_mesh_create(const crofton_mesh* mesh, uint32_t max_triangles,
                                             crofton_clustered_mesh** clustered) {
    CROFTON_CHECK(check_pointer(clustered, __func__));
    CROFTON_CHECK(check_mesh(mesh, __func__));
    return recover(__func__, [&, function = __func__] {
        auto cut = depth::ClusteredMesh::cut(
            std::span(reinterpret_cast<const glm::vec3*>(mesh->positions), mesh->vertex_count),
            std::span(mesh->indices, mesh->index_count), {.max_triangles = max_triangles});
        if (!cut) return report(cut.error(), function);
        return create(clustered, function, std::move(*cut));
    });
}

crofton_status crofton_clustered_mesh_destroy(crofton_clustered_mesh* clustered) {
    return destroy(clustered, __func__);
}

crofton_status crofton_clustered_mesh_serialise(const crofton_clustered_mesh* clustered, uint8_t* bytes,
                                                size_t capacity, size_t* count) {
    CROFTON_READ(clustered);
    CROFTON_CHECK(check_pointer(count, __func__));
    CROFTON_CHECK(check_array(bytes, capacity, __func__));
    return recover(__func__, [&] {
        const Vector<std::byte> stored = clustered->mesh.serialise();
        if (stored.size() <= capacity) std::memcpy(bytes, stored.data(), stored.size());
        *count = stored.size();
        return CROFTON_OK;
    });
}

crofton_status crofton_clustered_mesh_deserialise(const uint8_t* bytes, size_t count,
                                                  crofton_clustered_mesh** clustered) {
    CROFTON_CHECK(check_pointer(clustered, __func__));
    CROFTON_CHECK(check_array(bytes, count, __func__));
    return recover(__func__, [&, function = __func__] {
        auto made = depth::ClusteredMesh::deserialise(std::as_bytes(std::span(bytes, count)));
        if (!made) return report(made.error(), function);
        return create(clustered, function, std::move(*made));
    });
}

crofton_status crofton_clustered_mesh_lend(crofton_clustered_mesh* clustered, const crofton_mesh* mesh,
                                           uint32_t order) {
    CROFTON_CHANGE(clustered);
    CROFTON_CHECK(check_struct(mesh, __func__));
    CROFTON_CHECK(check_array(mesh->positions, mesh->vertex_count, __func__, 3));
    CROFTON_CHECK(check_array(mesh->indices, mesh->index_count, __func__));
    if (order > CROFTON_INDEX_ORDER_ORIGINAL)
        return report(CROFTON_INVALID_ARGUMENT, __func__, "order is no crofton_index_order");
    return recover(__func__, [&, function = __func__] {
        const auto lent =
            clustered->mesh.lend(std::span(reinterpret_cast<const glm::vec3*>(mesh->positions), mesh->vertex_count),
                                 std::span(mesh->indices, mesh->index_count), static_cast<depth::IndexOrder>(order));
        return lent ? CROFTON_OK : report(lent.error(), function);
    });
}

crofton_status crofton_clustered_mesh_get(const crofton_clustered_mesh* clustered, crofton_clusters* clusters) {
    CROFTON_READ(clustered);
    CROFTON_CHECK(check_pointer(clusters, __func__));
    return recover(__func__, [&] {
        const std::lock_guard lock(clustered->mutex);
        *clusters = to_c_clusters(clustered->mesh, clustered->ranges);
        return CROFTON_OK;
    });
}

crofton_status crofton_clustered_mesh_box(const crofton_clustered_mesh* clustered, size_t cluster,
                                          crofton_cluster_box* box) {
    CROFTON_READ(clustered);
    CROFTON_CHECK(check_pointer(box, __func__));
    if (cluster >= clustered->mesh.clusters().size())
        return report(CROFTON_OUT_OF_RANGE, __func__, "no such cluster", cluster);
    const depth::ClusterBox of = clustered->mesh.box_of(cluster);
    std::memcpy(box, &of, sizeof of);
    return CROFTON_OK;
}

crofton_status crofton_permute_triangles(const crofton_clusters* clusters, const uint32_t* indices, size_t index_count,
                                         uint32_t* permuted) {
    CROFTON_CHECK(check_pointer(clusters, __func__));
    CROFTON_CHECK(check_array(clusters->triangle_order, clusters->triangle_count, __func__));
    CROFTON_CHECK(check_array(indices, index_count, __func__));
    CROFTON_CHECK(check_room(permuted, index_count, __func__));
    if (index_count % 3 != 0 || index_count / 3 != clusters->triangle_count)
        return report(CROFTON_INVALID_ARGUMENT, __func__, "index_count is not that of the mesh");
    const std::less<const std::uint32_t*> before;
    if (before(permuted, indices + index_count) && before(indices, permuted + index_count))
        return report(CROFTON_INVALID_ARGUMENT, __func__, "the arrays overlap");
    const std::span order(clusters->triangle_order, clusters->triangle_count);
    for (std::size_t k = 0; k < order.size(); ++k)
        if (order[k] >= order.size())
            return report(CROFTON_OUT_OF_RANGE, __func__, "the order contains a number that is not a triangle", k);
    for (std::size_t k = 0; k < order.size(); ++k)
        std::copy_n(indices + std::size_t{3} * order[k], 3, permuted + 3 * k);
    return CROFTON_OK;
}

crofton_status crofton_depth_culler_create(crofton_depth_culler** culler) {
    CROFTON_CHECK(check_pointer(culler, __func__));
    return create(culler, __func__);
}

crofton_status crofton_depth_culler_destroy(crofton_depth_culler* culler) {
    return destroy(culler, __func__);
}

crofton_status crofton_depth_culler_find_visible(crofton_depth_culler* culler, const crofton_depth_object* objects,
                                                 size_t object_count, const crofton_picture_view* picture,
                                                 const crofton_jobs* jobs, const crofton_visible_cluster** clusters,
                                                 size_t* count, crofton_depth_statistics* statistics) {
    CROFTON_CHANGE(culler);
    depth::PictureView view;
    const Asked asked{objects, object_count, picture, jobs, clusters, count, statistics, __func__};
    CROFTON_CHECK(read(asked, *culler, view));
    HostJobs executor(jobs);
    const auto found = culler->culler.find_visible(culler->objects, view, executor);
    if (!found) return report(found.error(), __func__);
    give(asked, *culler, view, *found);
    return CROFTON_OK;
}

crofton_status crofton_depth_culler_find_casters(crofton_depth_culler* culler, const crofton_depth_object* objects,
                                                 size_t object_count, const crofton_picture_view* map,
                                                 const crofton_depth_receivers* receivers, const crofton_jobs* jobs,
                                                 const crofton_visible_cluster** clusters, size_t* count,
                                                 crofton_depth_statistics* statistics) {
    CROFTON_CHANGE(culler);
    crofton_depth_receivers given;
    CROFTON_CHECK(read_growing(receivers, __func__, given));
    if (given.seen == culler)  // which this call has for itself
        return report(CROFTON_INVALID_ARGUMENT, __func__,
                      "depth: casters need another culler, whose last answer is what the camera sees");
    const SharedUse use_seen(given.seen, __func__);
    if (use_seen.failed()) return use_seen.status();
    CROFTON_CHECK(check_array(given.objects, given.object_count, __func__));
    depth::PictureView view;
    const Asked asked{objects, object_count, map, jobs, clusters, count, statistics, __func__};
    CROFTON_CHECK(read(asked, *culler, view));
    culler->receivers.clear();
    for (std::size_t i = 0; i < given.object_count; ++i) {
        const crofton_depth_receiver& r = given.objects[i];
        depth::DepthReceiver& receiver = culler->receivers.emplace_back();
        if (r.mesh) {
            const SharedUse use_mesh(r.mesh, __func__);
            if (use_mesh.failed()) return of_item(use_mesh.status(), i);
            receiver.mesh = &r.mesh->mesh;
        }
        std::copy_n(r.to_map, 16, &receiver.to_map[0][0]);
        receiver.solid = r.solid != 0;
    }
    HostJobs executor(jobs);
    const auto found = culler->culler.find_casters(
        culler->objects, view,
        {.seen = &given.seen->culler, .objects = culler->receivers, .radius = static_cast<float>(given.radius)},
        executor);
    if (!found) return report(found.error(), __func__);
    give(asked, *culler, view, *found);
    return CROFTON_OK;
}

crofton_status crofton_depth_culler_nearness(const crofton_depth_culler* culler, uint32_t x, uint32_t y,
                                             float* nearness) {
    CROFTON_READ(culler);
    CROFTON_CHECK(check_pointer(nearness, __func__));
    if (x >= culler->width || y >= culler->height)
        return report(CROFTON_OUT_OF_RANGE, __func__, "not a pixel of the last picture");
    *nearness = culler->culler.nearness(x, y);
    return CROFTON_OK;
}
