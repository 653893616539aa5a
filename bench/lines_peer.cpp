// SPDX-License-Identifier: MIT
#include "lines_peer.hpp"

#include <algorithm>
#include <cstring>
#include <glm/geometric.hpp>
#include <vector>

#if defined(CROFTON_HAVE_EMBREE)
#include <embree3/rtcore.h>

namespace crofton::bench {

namespace {

// One for all scenes: making it takes as long as building a small scene.
RTCDevice the_device() {
    static const RTCDevice device = rtcNewDevice("threads=1");
    return device;
}

}  // namespace

struct EmbreeScene::Data {
    RTCScene scene = nullptr;
    float start = 0.0f;
};

bool EmbreeScene::available() {
    return true;
}

EmbreeScene::EmbreeScene(const TriangleMesh& mesh) : data_(std::make_unique<Data>()) {
    data_->scene = rtcNewScene(the_device());
    // High quality cuts triangles in two, which a filter would then count twice.
    rtcSetSceneBuildQuality(data_->scene, RTC_BUILD_QUALITY_MEDIUM);
    rtcSetSceneFlags(data_->scene, RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
    const RTCGeometry geometry = rtcNewGeometry(the_device(), RTC_GEOMETRY_TYPE_TRIANGLE);
    void* positions =
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, mesh.positions.size());
    std::memcpy(positions, mesh.positions.data(), mesh.positions.size() * 12);
    void* indices =
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, mesh.triangle_count());
    std::memcpy(indices, mesh.indices.data(), mesh.indices.size() * 4);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(data_->scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(data_->scene);
    RTCBounds bounds;
    rtcGetSceneBounds(data_->scene, &bounds);
    data_->start = 1e-6f * std::max({bounds.upper_x - bounds.lower_x, bounds.upper_y - bounds.lower_y,
                                     bounds.upper_z - bounds.lower_z});
}

EmbreeScene::~EmbreeScene() {
    rtcReleaseScene(data_->scene);
}

namespace {

struct Recorder {
    RTCIntersectContext context;  // the first member: Embree hands it on
    std::vector<lines::Hit> hits[16];
};

void record(const RTCFilterFunctionNArguments* arguments) {
    auto* recorder = reinterpret_cast<Recorder*>(arguments->context);
    const unsigned n = arguments->N;
    for (unsigned i = 0; i < n; ++i) {
        if (arguments->valid[i] != -1) continue;
        const glm::vec3 normal(RTCHitN_Ng_x(arguments->hit, n, i), RTCHitN_Ng_y(arguments->hit, n, i),
                               RTCHitN_Ng_z(arguments->hit, n, i));
        const glm::vec3 direction(RTCRayN_dir_x(arguments->ray, n, i), RTCRayN_dir_y(arguments->ray, n, i),
                                  RTCRayN_dir_z(arguments->ray, n, i));
        recorder->hits[RTCRayN_id(arguments->ray, n, i)].push_back({RTCRayN_tfar(arguments->ray, n, i),
                                                                    RTCHitN_primID(arguments->hit, n, i),
                                                                    glm::dot(normal, direction) < 0.0f});
        arguments->valid[i] = 0;  // on with the ray
    }
}

}  // namespace

void EmbreeScene::all_hits(std::span<const Line> lines, lines::LineHits& result) const {
    static thread_local Recorder recorder;
    result.hits.clear();
    result.ends.clear();
    for (std::size_t begin = 0; begin < lines.size(); begin += 16) {
        const std::size_t count = std::min<std::size_t>(16, lines.size() - begin);
        alignas(64) int valid[16];
        RTCRayHit16 packet;
        for (std::size_t i = 0; i < 16; ++i) {
            valid[i] = i < count ? -1 : 0;
            const Line& line = lines[begin + std::min(i, count - 1)];
            const glm::dvec3 start = line.point - 1e3 * static_cast<double>(data_->start) * line.direction;
            packet.ray.org_x[i] = static_cast<float>(start.x);
            packet.ray.org_y[i] = static_cast<float>(start.y);
            packet.ray.org_z[i] = static_cast<float>(start.z);
            packet.ray.dir_x[i] = static_cast<float>(line.direction.x);
            packet.ray.dir_y[i] = static_cast<float>(line.direction.y);
            packet.ray.dir_z[i] = static_cast<float>(line.direction.z);
            packet.ray.tnear[i] = 0.0f;
            packet.ray.tfar[i] = 1e30f;
            packet.ray.time[i] = 0.0f;
            packet.ray.mask[i] = ~0u;
            packet.ray.flags[i] = 0;
            packet.ray.id[i] = static_cast<unsigned>(i);
            packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
            packet.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
            recorder.hits[i].clear();
        }
        rtcInitIntersectContext(&recorder.context);
        recorder.context.filter = record;
        rtcIntersect16(valid, data_->scene, &recorder.context, &packet);
        for (std::size_t i = 0; i < count; ++i) {
            auto& hits = recorder.hits[i];
            std::sort(hits.begin(), hits.end(), [](const lines::Hit& a, const lines::Hit& b) { return a.t < b.t; });
            result.hits.insert(result.hits.end(), hits.begin(), hits.end());
            result.ends.push_back(static_cast<std::uint32_t>(result.hits.size()));
        }
    }
}

}  // namespace crofton::bench
#else
namespace crofton::bench {

struct EmbreeScene::Data {};
bool EmbreeScene::available() {
    return false;
}
EmbreeScene::EmbreeScene(const TriangleMesh&) {}
EmbreeScene::~EmbreeScene() = default;
void EmbreeScene::all_hits(std::span<const Line>, lines::LineHits&) const {}

}  // namespace crofton::bench
#endif
