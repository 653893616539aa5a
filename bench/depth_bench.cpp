// SPDX-License-Identifier: MIT
// Culling by depth: what it costs along a street path, how many triangles it passes, what 100,000 objects in view cost,
// and what it costs to cut meshes into clusters. Scenes may be named; without names they are the town and, where the
// shared data lies, a forest. One thread is measured by processor time, several by wall time.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <crofton/crofton.hpp>
#include <crofton/depth/depth_culler.hpp>
#include <crofton/sampling/sampling.hpp>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <glm/gtc/matrix_transform.hpp>
#include <string>
#include <vector>

#include "assets/scene_source.hpp"
#include "pipeline/camera_path.hpp"
#include "pipeline/pipeline.hpp"
#include "pipeline/scene_clusters.hpp"
#include "pipeline/street.hpp"
#include "simd_target.hpp"

using namespace crofton;
using namespace crofton::bench;

namespace {

// Returns this thread's processor time, so that other programs do not count.
double cpu_seconds() {
    std::timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// The least times of a frame, of some runs.
struct FrameTime {
    double cpu = HUGE_VAL, wall = HUGE_VAL;

    template <class Frame>
    void run(const Frame& frame) {
        const double cpu_begin = cpu_seconds(), begin = seconds();
        frame();
        cpu = std::min(cpu, cpu_seconds() - cpu_begin), wall = std::min(wall, seconds() - begin);
    }
};

double mean_cpu(const std::vector<FrameTime>& times) {
    double sum = 0.0;
    for (const FrameTime& time : times) sum += time.cpu;
    return 1e3 * sum / static_cast<double>(times.size());
}

template <class T>
T expect(Result<T> result, const char* what) {
    if (result) return std::move(*result);
    std::fprintf(stderr, "bench_depth: %s: %s\n", what, result.error().message.c_str());
    std::exit(1);
}

std::size_t bytes_of(const TriangleMesh& mesh) {
    return mesh.positions.size() * sizeof(mesh.positions[0]) + mesh.indices.size() * sizeof(mesh.indices[0]);
}

struct Objects {
    std::vector<depth::DepthObject> list;
    std::vector<scene::InstanceId> instances;  // of the list
    std::size_t triangles = 0;
};

// Lists the objects in the frustum of each frame.
std::vector<Objects> objects_along(assets::SceneSource& source, const pipeline::SceneClusters& clusters,
                                   const std::vector<Camera>& cameras) {
    auto& executor = serial_executor();
    pipeline::PipelineOptions options;
    options.count_triangles = options.collide = false;
    auto pipeline = expect(pipeline::Pipeline::create(source.scene, {}, options, executor), "pipeline");
    std::vector<Objects> frames;
    for (const Camera& camera : cameras) {
        (void)expect(pipeline.run(camera), "frame");
        Objects& objects = frames.emplace_back();
        std::vector<scene::InstanceId>& visible = objects.instances;
        for (scene::InstanceId i = 0; i < source.scene.instance_count(); ++i) {
            if (pipeline.verdicts()[i] == cull::Verdict::outside) continue;
            visible.push_back(i);
            objects.triangles += source.scene.mesh(source.scene.mesh_of(i)).triangle_count();
        }
        pipeline::append_depth_objects(source.scene, clusters, source.one_sided, visible, camera, objects.list);
    }
    return frames;
}

// Times the casters of a sun's shadow maps of 2048 x 2048 texels: one over the scene, one near the camera.
void cast_shadows(assets::SceneSource& source, const pipeline::SceneClusters& clusters, const Aabb& focus,
                  const std::vector<Camera>& cameras, const std::vector<Objects>& frames,
                  const depth::PictureView& picture, int repeats) {
    const depth::PictureView map{2048, 2048};
    const glm::dvec3 middle = 0.5 * (glm::dvec3(focus.min) + glm::dvec3(focus.max));
    const double reach = 0.5 * glm::length(glm::dvec3(focus.max) - glm::dvec3(focus.min));
    for (const double share : {1.0, 0.125}) {
        std::vector<Camera> suns;
        for (const Camera& camera : cameras) {
            const glm::dvec3 at =
                share == 1.0 ? middle : camera.position + share * reach * glm::normalize(camera.forward);
            suns.push_back(pipeline::sun_over(at, share * reach, reach));
        }
        const auto casters = objects_along(source, clusters, suns);
        depth::DepthCuller culler, alone, with_receivers;
        std::vector<FrameTime> by_light(frames.size()), by_receivers(frames.size());
        std::size_t in_frustum = 0, listed_alone = 0, listed = 0;
        for (std::size_t i = 0; i < frames.size(); ++i) {
            (void)expect(culler.find_visible(frames[i].list, picture), "culler");
            std::vector<depth::DepthObject> on_map;
            pipeline::append_depth_objects(source.scene, clusters, source.one_sided, frames[i].instances, suns[i],
                                           on_map);
            std::vector<depth::DepthReceiver> receivers;
            for (const depth::DepthObject& o : on_map) receivers.push_back({o.mesh, o.to_clip});
            for (int r = 0; r < repeats; ++r) {
                by_light[i].run([&] { (void)expect(alone.find_visible(casters[i].list, map), "map"); });
                by_receivers[i].run([&] {
                    (void)expect(with_receivers.find_casters(casters[i].list, map, {&culler, receivers, 2.0f}),
                                 "casters");
                });
            }
            in_frustum += casters[i].triangles;
            listed_alone += alone.statistics().triangles_listed;
            listed += with_receivers.statistics().triangles_listed;
        }
        const auto count = static_cast<double>(frames.size());
        std::printf(
            "%-28s %s: %8.0f in the frustum, %6.0f by the map's depth in %6.3f ms, %6.0f with receivers in "
            "%6.3f ms CPU\n",
            "", share == 1.0 ? "sun over the scene" : "sun near the camera", static_cast<double>(in_frustum) / count,
            static_cast<double>(listed_alone) / count, mean_cpu(by_light), static_cast<double>(listed) / count,
            mean_cpu(by_receivers));
    }
}

void walk_street(const std::string& name, std::uint32_t instances, const depth::PictureView& view, ThreadPool& pool,
                 bool shadows, int repeats) {
    auto source = expect(assets::load_scene(name, {.instances = instances}), name.c_str());
    source.scene.update();
    auto& executor = serial_executor();
    auto clusters = expect(pipeline::cut_scene(source.scene, executor), "clusters");
    const double own_bytes = static_cast<double>(clusters.memory());
    std::vector<std::vector<std::uint32_t>> lent;
    std::size_t mesh_bytes = 0;
    for (scene::MeshId m = 0; m < source.scene.mesh_count(); ++m) {
        const TriangleMesh& mesh = source.scene.mesh(m);
        mesh_bytes += bytes_of(mesh);
        if (source.scene.is_mesh_removed(m)) continue;
        depth::ClusteredMesh cut = *clusters.meshes[m];
        cut.permute(mesh.indices, lent.emplace_back(mesh.indices.size()));
        if (auto done = cut.lend(mesh.positions, lent.back()); !done) (void)expect(Result<int>(done.error()), "lend");
        clusters.meshes[m] = std::make_shared<const depth::ClusteredMesh>(std::move(cut));
    }

    const Aabb focus = pipeline::focus_of(source.scene);
    const pipeline::Street street = pipeline::street_of(source, focus);
    pipeline::PathOptions path{.kind = "street", .aspect = static_cast<double>(view.width) / view.height};
    street.set(path);
    const auto cameras = expect(pipeline::make_camera_path(path, focus, street.walk), "path").cameras;
    const auto frames = objects_along(source, clusters, cameras);

    depth::DepthCuller culler;
    std::vector<FrameTime> alone(frames.size()), shared(frames.size());
    std::size_t in_frustum = 0, passed = 0;
    for (int r = 0; r < repeats; ++r) {
        in_frustum = passed = 0;
        for (std::size_t i = 0; i < frames.size(); ++i) {
            const Objects& objects = frames[i];
            alone[i].run([&] { (void)expect(culler.find_visible(objects.list, view), "culler"); });
            in_frustum += objects.triangles;
            passed += culler.statistics().triangles_listed;
            if (pool.concurrency() > 1)
                shared[i].run([&] { (void)expect(culler.find_visible(objects.list, view, pool), "culler"); });
        }
    }
    const auto count = static_cast<double>(frames.size());
    const auto mean = [&](const std::vector<FrameTime>& times, double FrameTime::*which) {
        double sum = 0.0;
        for (const FrameTime& time : times) sum += time.*which;
        return 1e3 * sum / count;
    };
    std::printf(
        "%-28s %4ux%-4u %8.0f in the frustum, %6.0f passed, %6.3f ms CPU a frame; clusters %.3f x the mesh, "
        "%.2f x with own vertices\n",
        std::filesystem::path(name).filename().c_str(), view.width, view.height,
        static_cast<double>(in_frustum) / count, static_cast<double>(passed) / count, mean(alone, &FrameTime::cpu),
        static_cast<double>(clusters.memory()) / static_cast<double>(mesh_bytes),
        own_bytes / static_cast<double>(mesh_bytes));
    if (pool.concurrency() > 1)
        std::printf("%-28s %u threads: %6.3f ms, one: %6.3f ms\n", "", pool.concurrency(),
                    mean(shared, &FrameTime::wall), mean(alone, &FrameTime::wall));
    if (shadows) cast_shadows(source, clusters, focus, cameras, frames, view, repeats);
}

// Boxes before a camera, all in its frustum. `walls`: every hundredth is one, and hides what is behind it.
void walk_field(std::size_t count, bool walls, std::uint64_t work_limit, ThreadPool& pool, int repeats) {
    const std::vector<glm::vec3> corners = {{-1, -1, -1}, {1, -1, -1}, {-1, 1, -1}, {1, 1, -1},
                                            {-1, -1, 1},  {1, -1, 1},  {-1, 1, 1},  {1, 1, 1}};
    const std::vector<std::uint32_t> indices = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                                2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
    const auto cube = expect(depth::ClusteredMesh::cut(corners, indices), "cube");
    const Camera camera{.aspect = 16.0 / 9.0, .near_distance = 0.1};
    const glm::dmat4 to_clip = world_to_clip(camera);
    sampling::Random random(7);
    std::vector<depth::DepthObject> objects;
    for (std::size_t i = 0; i < count; ++i) {
        const double z = 10.0 + 990.0 * std::sqrt(random.uniform());
        const double x = random.uniform(-0.9, 0.9) * z, y = random.uniform(-2.0, 10.0);
        const bool wall = walls && i % 100 == 0;
        const double width = wall ? 10.0 : random.uniform(0.2, 1.0), height = wall ? 8.0 : random.uniform(0.2, 1.0);
        const glm::dmat4 place =
            glm::scale(glm::translate(glm::dmat4(1.0), {x, wall ? 4.0 : y, -z}), {width, height, 0.5});
        objects.push_back({.mesh = &cube, .to_clip = glm::mat4(to_clip * place), .one_sided = true, .hides = walls});
    }
    depth::DepthCuller culler;
    FrameTime alone, shared;
    const depth::PictureView view{.width = 1280, .height = 720, .work_limit = work_limit};
    for (int r = 0; r < repeats; ++r) {
        alone.run([&] { (void)expect(culler.find_visible(objects, view), "culler"); });
        if (pool.concurrency() > 1)
            shared.run([&] { (void)expect(culler.find_visible(objects, view, pool), "culler"); });
    }
    const depth::DepthStatistics& s = culler.statistics();
    std::printf("%zu boxes, %s, limit %llu: %llu tested, %llu triangles drawn, %llu passed, %6.3f ms CPU", count,
                walls ? "walls among them" : "nothing hides", static_cast<unsigned long long>(work_limit),
                static_cast<unsigned long long>(s.objects_asked), static_cast<unsigned long long>(s.triangles_drawn),
                static_cast<unsigned long long>(s.triangles_listed), 1e3 * alone.cpu);
    if (pool.concurrency() > 1)
        std::printf("; %u threads: %6.3f ms, one: %6.3f ms", pool.concurrency(), 1e3 * shared.wall, 1e3 * alone.wall);
    std::printf("\n");
}

// Hills of n × n squares.
void cut_terrain(std::uint32_t n) {
    TriangleMesh mesh;
    for (std::uint32_t j = 0; j <= n; ++j)
        for (std::uint32_t i = 0; i <= n; ++i) {
            const auto x = static_cast<float>(i), z = static_cast<float>(j);
            mesh.positions.push_back({x, 20.0f * std::sin(0.05f * x) * std::cos(0.03f * z), z});
        }
    for (std::uint32_t j = 0; j < n; ++j)
        for (std::uint32_t i = 0; i < n; ++i) {
            const std::uint32_t p = j * (n + 1) + i, q = p + n + 1;
            for (const std::uint32_t v : {p, q, q + 1, p, q + 1, p + 1}) mesh.indices.push_back(v);
        }
    const double begin = cpu_seconds();
    const auto cut = expect(depth::ClusteredMesh::cut(mesh.positions, mesh.indices), "terrain");
    const double seconds = cpu_seconds() - begin;
    std::printf("cut: %zu triangles into %zu clusters, %.2f M triangles/s, %.2f x the mesh's memory\n",
                mesh.triangle_count(), cut.clusters().size(),
                1e-6 * static_cast<double>(mesh.triangle_count()) / seconds,
                static_cast<double>(cut.memory()) / static_cast<double>(bytes_of(mesh)));
    FrameTime apart, at_once;
    for (int r = 0; r < 3; ++r) {
        depth::ClusteredMesh moved = cut;
        apart.run([&] {
            if (!moved.refit(mesh.positions, mesh.indices) ||
                !moved.lend(mesh.positions, mesh.indices, depth::IndexOrder::original))
                std::exit(1);
        });
        moved = cut;
        at_once.run([&] {
            if (!moved.refit_lent(mesh.positions, mesh.indices)) std::exit(1);
        });
    }
    std::printf("refit: %.1f ms and a loan, %.1f ms by refit_lent()\n", 1e3 * apart.cpu, 1e3 * at_once.cpu);
}

}  // namespace

// bench_depth [--target=NAME] [--repeats=N] [--threads=N] [--no-shadows] [SCENE…]
int main(int argc, char** argv) {
    if (!take_target_option(argc, argv)) return 1;
    int repeats = 5;
    unsigned threads = 1;
    bool shadows = true;
    std::vector<std::string> scenes;
    for (int i = 1; i < argc; ++i)
        if (std::strncmp(argv[i], "--repeats=", 10) == 0)
            repeats = std::atoi(argv[i] + 10);
        else if (std::strncmp(argv[i], "--threads=", 10) == 0)
            threads = static_cast<unsigned>(std::atoi(argv[i] + 10));
        else if (std::strcmp(argv[i], "--no-shadows") == 0)
            shadows = false;
        else
            scenes.emplace_back(argv[i]);
    std::printf("Instruction set: %s\n", target_in_use());
    const bool all = scenes.empty();
    if (all) {
        scenes.emplace_back("town");
        const std::string forest = std::string(CROFTON_SHARED_DATA) + "/scenes/stk_black_forest.glb";
        if (std::filesystem::exists(forest)) scenes.push_back(forest);
    }
    ThreadPool pool(threads);
    for (const std::string& scene : scenes) walk_street(scene, 0, {1280, 720}, pool, shadows, repeats);
    if (!all) return 0;
    constexpr std::uint32_t kMany = 100'000;
    std::printf("the town with %u objects: ", kMany);
    walk_street("town", kMany, {1280, 720}, pool, false, repeats);
    walk_field(kMany, true, 0, pool, repeats);
    walk_field(kMany, false, 0, pool, repeats);
    walk_field(kMany, false, 20'000, pool, repeats);
    cut_terrain(700);
    return 0;
}
