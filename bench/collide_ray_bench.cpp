// SPDX-License-Identifier: MIT
// Rays at meshes beside Embree: kinds of rays, few that stay in the cache and many that do not.
#include <benchmark/benchmark.h>

#include <crofton/core/executor.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <crofton/mesh/mesh_tree.hpp>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <random>
#include <string>
#include <string_view>
#include <utility>

#include "collide_inputs.hpp"
#include "simd_target.hpp"

#if defined(CROFTON_BENCH_ASSETS)
#include "assets/flat_scene.hpp"
#endif

#if defined(CROFTON_HAVE_EMBREE)
#include <embree3/rtcore.h>
#endif

namespace crofton::bench {
namespace {

// From just above random points of the surface into the half space above.
std::vector<Ray> diffuse_rays(const TriangleMesh& mesh, std::size_t count) {
    std::mt19937_64 random(5);
    const auto unit = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
    std::vector<Ray> rays;
    while (rays.size() < count) {
        const std::size_t t = random() % mesh.triangle_count();
        glm::dvec3 p[3];
        for (std::size_t v = 0; v < 3; ++v) p[v] = glm::dvec3(mesh.positions[mesh.indices[3 * t + v]]);
        const glm::dvec3 n = glm::cross(p[1] - p[0], p[2] - p[0]);
        if (!(glm::length(n) > 0.0)) continue;
        const double x = unit(), y = unit();
        const double z = unit();
        glm::dvec3 way = 2.0 * glm::dvec3(x, y, z) - 1.0;
        if (!(glm::length(way) > 0.1)) continue;
        if (glm::dot(way, n) < 0.0) way = -way;
        const glm::dvec3 middle = (p[0] + p[1] + p[2]) / 3.0;
        rays.push_back({middle + 1e-3 * glm::length(p[1] - p[0]) * glm::normalize(n), glm::normalize(way)});
    }
    return rays;
}

// A picture of the mesh, line by line.
std::vector<Ray> camera_rays(const TriangleMesh& mesh, std::size_t count) {
    Aabb bound;
    for (const glm::vec3& p : mesh.positions) bound.include(glm::dvec3(p));
    const auto side = static_cast<std::size_t>(std::sqrt(static_cast<double>(count)));
    const double size = glm::length(bound.half_extents());
    const glm::dvec3 from = bound.center() + glm::dvec3(0.3, 0.2, 2.5) * size;
    std::vector<Ray> rays;
    for (std::size_t i = 0; i < side * side; ++i) {
        const double x = 2.0 * static_cast<double>(i % side) / static_cast<double>(side) - 1.0,
                     y = 2.0 * static_cast<double>(i / side) / static_cast<double>(side) - 1.0;
        rays.push_back({from, glm::normalize(bound.center() + size * glm::dvec3(x, y, 0.0) - from)});
    }
    return rays;
}

// The same picture in tiles of 4 × 4 pixels, so that each sixteen lie together.
std::vector<Ray> tiled_rays(const TriangleMesh& mesh, std::size_t count) {
    const std::vector<Ray> lines = camera_rays(mesh, count);
    const auto side = static_cast<std::size_t>(std::sqrt(static_cast<double>(count))) / 4 * 4;
    const auto width = static_cast<std::size_t>(std::sqrt(static_cast<double>(lines.size())));
    std::vector<Ray> rays;
    for (std::size_t y = 0; y < side; y += 4)
        for (std::size_t x = 0; x < side; x += 4)
            for (std::size_t i = 0; i < 16; ++i) rays.push_back(lines[(y + i / 4) * width + x + i % 4]);
    return rays;
}

// Those of random directions that leave from the sphere around the mesh and pass it by.
std::vector<Ray> missing_rays(const TriangleMesh& mesh, std::size_t count) {
    std::vector<Ray> rays = random_rays(mesh, count);
    for (Ray& ray : rays) ray.direction = glm::normalize(glm::cross(ray.origin, glm::dvec3(0.31, 0.52, 0.79)));
    return rays;
}

// Each twice in a row: the second time its memory is in the caches, while branches are hardly better predicted.
std::vector<Ray> doubled_rays(const TriangleMesh& mesh, std::size_t count) {
    std::vector<Ray> rays;
    for (const Ray& ray : random_rays(mesh, count / 2)) rays.insert(rays.end(), 2, ray);
    return rays;
}

using RayMaker = std::vector<Ray> (*)(const TriangleMesh&, std::size_t);
constexpr struct {
    const char* name;
    RayMaker make;
} kKinds[] = {{"random", random_rays}, {"diffuse", diffuse_rays}, {"camera", camera_rays},
              {"tiles", tiled_rays},   {"missing", missing_rays}, {"doubled", doubled_rays}};

// Each triangle in four, at the middles of its edges.
TriangleMesh in_four(const TriangleMesh& mesh) {
    TriangleMesh result;
    result.positions = mesh.positions;
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
        const auto [place, is_new] =
            middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(result.positions.size()));
        if (is_new) result.positions.push_back(0.5f * (mesh.positions[a] + mesh.positions[b]));
        return place->second;
    };
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        const std::uint32_t a = mesh.indices[i], b = mesh.indices[i + 1], c = mesh.indices[i + 2], ab = middle(a, b),
                            bc = middle(b, c), ca = middle(c, a);
        for (const std::uint32_t v : {a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca}) result.indices.push_back(v);
    }
    return result;
}

// The samples' town, its triangles without common vertices.
TriangleMesh town() {
    TriangleMesh mesh;
#if defined(CROFTON_BENCH_ASSETS)
    auto source = assets::load_scene("town");
    source->scene.update();
    mesh = assets::flat_scene(*source).value().mesh;
#endif
    return mesh;
}

// "NAME in four" is the shared mesh NAME with four times the triangles, "in sixteen" with sixteen times as many.
const TriangleMesh& mesh_of(const char* name) {
    static std::map<std::string, TriangleMesh> meshes;
    const auto [place, is_new] = meshes.try_emplace(name);
    if (!is_new) return place->second;
    const std::string whole = name;
    const std::size_t part = whole.find(" in ");
    place->second = whole == "town" ? town() : shared_mesh(whole.substr(0, part));
    if (part != std::string::npos) place->second = in_four(place->second);
    if (whole.ends_with(" in sixteen")) place->second = in_four(place->second);
    return place->second;
}

void count_rays(benchmark::State& state, std::size_t rays, int hits) {
    state.counters["hits"] = hits;
    state.counters["ns/ray"] = benchmark::Counter(
        static_cast<double>(rays) * 1e-9, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

const mesh::MeshTree* tree_of(const char* name, bool prepared) {
    static std::map<std::string, mesh::MeshTree> trees;
    const auto [place, is_new] = trees.try_emplace(name + std::to_string(prepared));
    if (is_new)
        if (auto built = mesh::MeshTree::build(mesh_of(name), {.rays = prepared})) place->second = std::move(*built);
    return place->second.triangle_count() == 0 ? nullptr : &place->second;
}

// Casts one ray after the other; `is_hit(ray)`.
template <class IsHit>
void one_by_one(benchmark::State& state, const std::vector<Ray>& rays, const IsHit& is_hit) {
    int hits = 0;
    for (auto _ : state) {
        hits = 0;
        for (const Ray& ray : rays) hits += is_hit(ray);
    }
    count_rays(state, rays.size(), hits);
}

void single_rays(benchmark::State& state, const char* name, RayMaker make, std::size_t count, bool prepared) {
    const mesh::MeshTree* const tree = tree_of(name, prepared);
    if (tree == nullptr) return state.SkipWithError("shared data is absent");
    one_by_one(state, make(mesh_of(name), count),
               [&](const Ray& ray) { return mesh::raycast(ray, *tree).has_value(); });
}

// Whether anything is hit, as shadows ask.
void any_hits(benchmark::State& state, const char* name, RayMaker make, std::size_t count) {
    const mesh::MeshTree* const tree = tree_of(name, true);
    if (tree == nullptr) return state.SkipWithError("shared data is absent");
    one_by_one(state, make(mesh_of(name), count), [&](const Ray& ray) { return mesh::hits_any(ray, *tree); });
}

// All at once, beside Embree's packets of 8 and 16.
void many_rays(benchmark::State& state, const char* name, RayMaker make, std::size_t count) {
    const mesh::MeshTree* const tree = tree_of(name, true);
    if (tree == nullptr) return state.SkipWithError("shared data is absent");
    const auto rays = make(mesh_of(name), count);
    std::vector<std::optional<mesh::TriangleHit>> found(rays.size());
    for (auto _ : state) mesh::raycast(rays, *tree, found);
    int hits = 0;
    for (const auto& hit : found) hits += hit.has_value();
    count_rays(state, rays.size(), hits);
}

// The tree and its hierarchy for rays.
void ray_build(benchmark::State& state, const char* name, unsigned threads) {
    ThreadPool pool(threads);
    const TriangleMesh& mesh = mesh_of(name);
    if (mesh.indices.empty()) return state.SkipWithError("shared data is absent");
    for (auto _ : state) benchmark::DoNotOptimize(mesh::MeshTree::build(mesh, {.rays = true}, pool).value());
}

#if defined(CROFTON_HAVE_EMBREE)

RTCScene build_embree_scene(const TriangleMesh& mesh) {
    // On the instruction set that ours is restricted to.
    static const bool avx2 = std::string_view(target_in_use()) == "AVX2";
    static const RTCDevice device = rtcNewDevice(avx2 ? "threads=1,isa=avx2" : "threads=1");
    const RTCScene scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    void* points =
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, mesh.positions.size());
    std::copy(mesh.positions.begin(), mesh.positions.end(), static_cast<glm::vec3*>(points));
    void* indices =
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, mesh.triangle_count());
    std::copy(mesh.indices.begin(), mesh.indices.end(), static_cast<std::uint32_t*>(indices));
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene);
    return scene;
}

RTCScene embree_scene(const char* name) {
    static std::map<std::string, RTCScene> scenes;
    const auto [place, is_new] = scenes.try_emplace(name);
    if (is_new) place->second = build_embree_scene(mesh_of(name));
    return place->second;
}

void embree_build(benchmark::State& state, const char* name) {
    if (mesh_of(name).indices.empty()) return state.SkipWithError("shared data is absent");
    for (auto _ : state) rtcReleaseScene(build_embree_scene(mesh_of(name)));
}

RTCRay embree_ray(const Ray& ray) {
    return {float(ray.origin.x),
            float(ray.origin.y),
            float(ray.origin.z),
            0.0f,
            float(ray.direction.x),
            float(ray.direction.y),
            float(ray.direction.z),
            0.0f,
            INFINITY,
            ~0u,
            0,
            0};
}

void embree_rays(benchmark::State& state, const char* name, RayMaker make, std::size_t count) {
    if (mesh_of(name).indices.empty()) return state.SkipWithError("shared data is absent");
    const RTCScene scene = embree_scene(name);
    one_by_one(state, make(mesh_of(name), count), [&](const Ray& ray) {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        RTCRayHit query{};
        query.ray = embree_ray(ray);
        query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(scene, &context, &query);
        return query.hit.geomID != RTC_INVALID_GEOMETRY_ID;
    });
}

void embree_any_hits(benchmark::State& state, const char* name, RayMaker make, std::size_t count) {
    if (mesh_of(name).indices.empty()) return state.SkipWithError("shared data is absent");
    const RTCScene scene = embree_scene(name);
    one_by_one(state, make(mesh_of(name), count), [&](const Ray& ray) {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        RTCRay query = embree_ray(ray);
        rtcOccluded1(scene, &context, &query);
        return query.tfar < 0.0f;
    });
}

template <int Width>
struct EmbreePacket;
template <>
struct EmbreePacket<8> {
    using Type = RTCRayHit8;
    static void intersect(const int* valid, RTCScene scene, RTCIntersectContext* context, Type* rays) {
        rtcIntersect8(valid, scene, context, rays);
    }
};
template <>
struct EmbreePacket<16> {
    using Type = RTCRayHit16;
    static void intersect(const int* valid, RTCScene scene, RTCIntersectContext* context, Type* rays) {
        rtcIntersect16(valid, scene, context, rays);
    }
};

template <int Width>
void embree_packets(benchmark::State& state, const char* name, RayMaker make, std::size_t count, bool coherent) {
    if (mesh_of(name).indices.empty()) return state.SkipWithError("shared data is absent");
    const RTCScene scene = embree_scene(name);
    const auto rays = make(mesh_of(name), count);
    int hits = 0;
    for (auto _ : state) {
        hits = 0;
        for (std::size_t begin = 0; begin < rays.size(); begin += Width) {
            RTCIntersectContext context;
            rtcInitIntersectContext(&context);
            if (coherent) context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
            typename EmbreePacket<Width>::Type query;
            alignas(64) int valid[Width];
            for (int i = 0; i < Width; ++i) {
                const std::size_t r = begin + static_cast<std::size_t>(i);
                valid[i] = r < rays.size() ? -1 : 0;
                const Ray& ray = rays[r < rays.size() ? r : begin];
                query.ray.org_x[i] = float(ray.origin.x), query.ray.org_y[i] = float(ray.origin.y);
                query.ray.org_z[i] = float(ray.origin.z), query.ray.tnear[i] = 0.0f;
                query.ray.dir_x[i] = float(ray.direction.x), query.ray.dir_y[i] = float(ray.direction.y);
                query.ray.dir_z[i] = float(ray.direction.z), query.ray.time[i] = 0.0f;
                query.ray.tfar[i] = INFINITY, query.ray.mask[i] = ~0u;
                query.ray.id[i] = query.ray.flags[i] = 0;
                query.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
            }
            EmbreePacket<Width>::intersect(valid, scene, &context, &query);
            for (int i = 0; i < Width; ++i) hits += valid[i] != 0 && query.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
        }
    }
    count_rays(state, rays.size(), hits);
}

#endif

void ray_benchmarks() {
    for (const char* mesh : {"bunny", "armadillo", "armadillo in four", "bunny in sixteen", "town"}) {
        const std::string build = std::string("ray build/") + mesh + "/";
        benchmark::RegisterBenchmark((build + "crofton").c_str(), ray_build, mesh, 1u)->Unit(benchmark::kMillisecond);
        benchmark::RegisterBenchmark((build + "two threads").c_str(), ray_build, mesh, 2u)
            ->Unit(benchmark::kMillisecond)
            ->UseRealTime();
#if defined(CROFTON_HAVE_EMBREE)
        benchmark::RegisterBenchmark((build + "embree").c_str(), embree_build, mesh)->Unit(benchmark::kMillisecond);
#endif
        for (const auto& kind : kKinds)
            for (const std::size_t count : {std::size_t{256}, std::size_t{20'000}, std::size_t{100'000}}) {
                const std::string name =
                    std::string("rays/") + mesh + " " + kind.name + " " + std::to_string(count) + "/";
                benchmark::RegisterBenchmark((name + "crofton").c_str(), single_rays, mesh, kind.make, count, true)
                    ->Unit(benchmark::kMicrosecond);
                benchmark::RegisterBenchmark((name + "not prepared").c_str(), single_rays, mesh, kind.make, count,
                                             false)
                    ->Unit(benchmark::kMicrosecond);
                benchmark::RegisterBenchmark(("any " + name + "crofton").c_str(), any_hits, mesh, kind.make, count)
                    ->Unit(benchmark::kMicrosecond);
#if defined(CROFTON_HAVE_EMBREE)
                benchmark::RegisterBenchmark((name + "embree").c_str(), embree_rays, mesh, kind.make, count)
                    ->Unit(benchmark::kMicrosecond);
                benchmark::RegisterBenchmark(("any " + name + "embree").c_str(), embree_any_hits, mesh, kind.make,
                                             count)
                    ->Unit(benchmark::kMicrosecond);
#endif
                const std::string many = "many " + name;
                benchmark::RegisterBenchmark((many + "crofton").c_str(), many_rays, mesh, kind.make, count)
                    ->Unit(benchmark::kMicrosecond);
#if defined(CROFTON_HAVE_EMBREE)
                const bool coherent = kind.make == camera_rays || kind.make == tiled_rays;
                benchmark::RegisterBenchmark((many + "embree 8").c_str(), embree_packets<8>, mesh, kind.make, count,
                                             coherent)
                    ->Unit(benchmark::kMicrosecond);
                benchmark::RegisterBenchmark((many + "embree 16").c_str(), embree_packets<16>, mesh, kind.make, count,
                                             coherent)
                    ->Unit(benchmark::kMicrosecond);
#endif
            }
    }
}
const bool registered = (ray_benchmarks(), true);

}  // namespace
}  // namespace crofton::bench
