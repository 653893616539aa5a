// SPDX-License-Identifier: MIT
#include "picture_view.hpp"

#include <algorithm>
#include <bit>
#include <crofton/geometry/model_to_clip.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <numeric>

#include "box_triangles.hpp"

namespace crofton::world {
namespace {

// [-1, 1]³, for objects that have a box alone.
const depth::ClusteredMesh& unit_cube() {
    static const depth::ClusteredMesh kCube = [] {
        Vector<glm::vec3> corners;
        for (unsigned i = 0; i < 8; ++i)
            corners.push_back({(i & 1u) ? 1.0f : -1.0f, (i & 2u) ? 1.0f : -1.0f, (i & 4u) ? 1.0f : -1.0f});
        return std::move(*depth::ClusteredMesh::cut(corners, kBoxTriangles));
    }();
    return kCube;
}

ViewMatrix matrix_of(const ViewRequest& request) {
    if (request.matrix) return *request.matrix;
    const Camera& camera = *request.camera;
    return {view_to_clip(camera, request.picture->depth) * glm::dmat4(world_to_view_rotation(camera)),
            request.picture->depth, camera.position};
}

depth::DepthObject object_of(const PictureView::Drawn& drawn, const ViewMatrix& view) {
    const auto to_clip = [&view](const glm::dmat3& linear, const glm::dvec3& translation) {
        return crofton::detail::model_to_clip(view.to_clip, view.origin, linear, translation);
    };
    if (drawn.clusters == nullptr) {
        glm::dmat3 linear(drawn.box.axes);
        for (int k = 0; k < 3; ++k) linear[k] *= double{drawn.box.half_extents[k]};
        depth::DepthObject asked{&unit_cube(), to_clip(linear, drawn.box.center)};
        asked.hides = false;
        return asked;
    }
    const glm::dmat3& linear = *drawn.placed.linear;
    depth::DepthObject asked{&drawn.clusters->cut, to_clip(linear, drawn.placed.translation)};
    // Mirrored, fronts and backs change places.
    asked.one_sided = drawn.clusters->one_sided && glm::determinant(linear) > 0.0;
    asked.hides = drawn.occludes;
    return asked;
}

}  // namespace

Result<void> check_picture(const ViewRequest& request, std::uint64_t item) {
    if (!request.picture) return {};
    const auto refuse = [&](const char* why) { return fail(ErrorCode::invalid_argument, item, why); };
    if (!request.camera && !request.matrix) return refuse("view: a picture needs a `camera` or a `matrix`");
    if (request.occlusion) return refuse("view: set `occlusion` or `picture`, not both");
    if (request.matrix && request.matrix->depth != request.picture->depth)
        return refuse("view: the matrix and the picture must have the same depth range");
    return request.picture->check(item);
}

// Where objects lie in the shadow map that `view` draws: those of which something is seen.
void PictureView::place_receivers(const PictureView& seen, const ViewMatrix& view, DrawnOf drawn_of) {
    receivers_.assign(seen.objects_.size(), {});
    for (std::size_t i = 0; i < receivers_.size(); ++i) {
        if (seen.seen_[seen.places_[i]] == 0) continue;
        const Drawn drawn = drawn_of(seen.object_ids_[i]);
        const depth::DepthObject in_map = object_of(drawn, view);
        receivers_[i] = {in_map.mesh, in_map.to_clip, drawn.clusters == nullptr};
    }
}

void PictureView::find(const ViewRequest& request, const InFrustum& in_frustum, const PictureView* seen,
                       DrawnOf drawn_of, Executor& executor) {
    const ViewMatrix view = matrix_of(request);
    const std::span<const std::uint32_t> ids = in_frustum.ids;
    // Ascending, so that the answer does not depend on the order that is asked for.
    places_.resize(ids.size());
    std::iota(places_.begin(), places_.end(), 0u);
    if (!std::is_sorted(ids.begin(), ids.end()))
        std::sort(places_.begin(), places_.end(), [&](std::uint32_t a, std::uint32_t b) { return ids[a] < ids[b]; });
    objects_.resize(ids.size());
    object_ids_.resize(ids.size());
    constexpr std::size_t kGrain = 256;
    executor.parallel_for(ids.size(), kGrain, [&](std::size_t begin, std::size_t end, unsigned) {
        for (std::size_t i = begin; i < end; ++i) {
            object_ids_[i] = ids[places_[i]];
            objects_[i] = object_of(drawn_of(object_ids_[i]), view);
        }
    });
    if (seen != nullptr) place_receivers(*seen, view, drawn_of);
    // Sizes, meshes and receivers are checked: nothing can fail.
    const auto found =
        seen == nullptr
            ? culler_.find_visible(objects_, *request.picture, executor)
            : culler_.find_casters(objects_, *request.picture,
                                   {.seen = &seen->culler_, .objects = receivers_, .radius = request.receivers->radius},
                                   executor);
    seen_.assign(ids.size(), 0);
    triangles_.clear();
    statistics_ = culler_.statistics();
    statistics_.objects_listed = statistics_.triangles_listed = 0;
    for (const depth::VisibleCluster& cluster : *found) {
        const std::uint32_t place = places_[cluster.object];
        const bool is_first = seen_[place] == 0;
        seen_[place] = 1;
        if (objects_[cluster.object].mesh == &unit_cube()) continue;
        statistics_.objects_listed += is_first;
        statistics_.triangles_listed += static_cast<std::uint64_t>(std::popcount(cluster.triangles));
        triangles_.push_back({ids[place], cluster.cluster, cluster.triangles});
    }
    ids_.clear();
    verdicts_.clear();
    inside_count_ = 0;
    const std::span<const cull::Verdict> verdicts = in_frustum.verdicts;
    for (std::size_t i = 0; i < ids.size(); ++i) {
        if (seen_[i] == 0) continue;
        ids_.push_back(ids[i]);
        if (!verdicts.empty()) verdicts_.push_back(verdicts[i]);
        inside_count_ += verdicts.empty() ? i < in_frustum.inside_count : verdicts[i] == cull::Verdict::inside;
    }
}

}  // namespace crofton::world
