// SPDX-License-Identifier: MIT
#include "occlude_peer.hpp"

#include <MaskedOcclusionCulling.h>

#include <algorithm>
#include <glm/mat4x4.hpp>
#include <utility>
#include <vector>

namespace crofton::bench {
namespace {

MaskedOcclusionCulling* culling(void* pointer) {
    return static_cast<MaskedOcclusionCulling*>(pointer);
}

// Clockwise, as this library culls the other side.
constexpr unsigned kTriangles[36] = {1, 3, 7, 1, 7, 5, 0, 4, 6, 0, 6, 2, 2, 6, 7, 2, 7, 3,
                                     0, 1, 5, 0, 5, 4, 4, 5, 7, 4, 7, 6, 0, 2, 3, 0, 3, 1};

struct Corners {
    float x[8], y[8], z[8];
};
Corners corners_of(const Obb& box, const double (&origin)[3]) {
    Corners result;
    float c[3], e[3][3];
    for (int j = 0; j < 3; ++j) c[j] = static_cast<float>(box.center[j] - origin[j]);
    for (int k = 0; k < 3; ++k)
        for (int j = 0; j < 3; ++j) e[k][j] = box.axes[k][j] * box.half_extents[k];
    for (unsigned i = 0; i < 8; ++i) {
        float p[3];
        for (int j = 0; j < 3; ++j)
            p[j] = c[j] + (i & 1u ? e[0][j] : -e[0][j]) + (i & 2u ? e[1][j] : -e[1][j]) + (i & 4u ? e[2][j] : -e[2][j]);
        result.x[i] = p[0];
        result.y[i] = p[1];
        result.z[i] = p[2];
    }
    return result;
}

}  // namespace

MaskedPeer::MaskedPeer(unsigned width, unsigned height)
    : culling_(MaskedOcclusionCulling::Create(MaskedOcclusionCulling::AVX2)) {
    culling(culling_)->SetResolution(width, height);
}
MaskedPeer::~MaskedPeer() {
    MaskedOcclusionCulling::Destroy(culling(culling_));
}

void MaskedPeer::draw(std::span<const Obb> boxes, const Camera& camera) {
    const glm::dmat3 rotation = world_to_view_rotation(camera);
    const glm::dmat4 to_clip = view_to_clip(camera, DepthRange::minus_one_to_one) * glm::dmat4(rotation);
    for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 4; ++r) to_clip_[4 * c + r] = static_cast<float>(to_clip[c][r]);
    for (int j = 0; j < 3; ++j) origin_[j] = camera.position[j];
    MaskedOcclusionCulling* const m = culling(culling_);
    m->SetNearClipPlane(static_cast<float>(camera.near_distance));
    m->ClearBuffer();
    // Front to back, as its documentation advises.
    std::vector<std::pair<double, const Obb*>> order;
    for (const Obb& box : boxes) {
        const glm::dvec3 d = box.center - camera.position;
        order.push_back({d.x * d.x + d.y * d.y + d.z * d.z, &box});
    }
    std::sort(order.begin(), order.end());
    for (const auto& [distance, box] : order) {
        const Corners corners = corners_of(*box, origin_);
        float vertices[8][4];
        for (unsigned i = 0; i < 8; ++i) {
            vertices[i][0] = corners.x[i];
            vertices[i][1] = corners.y[i];
            vertices[i][2] = corners.z[i];
            vertices[i][3] = 1.0f;
        }
        m->RenderTriangles(&vertices[0][0], kTriangles, 12, to_clip_, MaskedOcclusionCulling::BACKFACE_CCW,
                           MaskedOcclusionCulling::CLIP_PLANE_ALL, MaskedOcclusionCulling::VertexLayout(16, 4, 8));
    }
}

void MaskedPeer::find_hidden(std::span<const Obb> boxes, std::span<std::uint64_t> hidden) {
    std::fill(hidden.begin(), hidden.end(), std::uint64_t{0});
    for (std::size_t n = 0; n < boxes.size(); ++n) {
        const Corners corners = corners_of(boxes[n], origin_);
        float low_x = 1e30f, low_y = 1e30f, high_x = -1e30f, high_y = -1e30f, low_w = 1e30f;
        for (unsigned i = 0; i < 8; ++i) {
            const float* m = to_clip_;
            const float x = m[0] * corners.x[i] + m[4] * corners.y[i] + m[8] * corners.z[i];
            const float y = m[1] * corners.x[i] + m[5] * corners.y[i] + m[9] * corners.z[i];
            const float w = m[3] * corners.x[i] + m[7] * corners.y[i] + m[11] * corners.z[i];
            low_x = std::min(low_x, x / w), high_x = std::max(high_x, x / w);
            low_y = std::min(low_y, y / w), high_y = std::max(high_y, y / w);
            low_w = std::min(low_w, w);
        }
        if (!(low_w > 0.0f)) continue;
        if (culling(culling_)->TestRect(low_x, low_y, high_x, high_y, low_w) == MaskedOcclusionCulling::OCCLUDED)
            hidden[n / 64] |= std::uint64_t{1} << (n % 64);
    }
}

}  // namespace crofton::bench
