// SPDX-License-Identifier: MIT
// Culling by depth on one thread: what it costs along a street path, how many triangles it passes, and what it costs to
// cut meshes into clusters. Scenes may be named; without names they are the town and, where the shared data lies, a
// forest.
#include <algorithm>
#include <cmath>
#include <crofton/crofton.hpp>
#include <crofton/depth/depth_culler.hpp>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <filesystem>
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
        std::vector<scene::InstanceId> visible;
        for (scene::InstanceId i = 0; i < source.scene.instance_count(); ++i) {
            if (pipeline.verdicts()[i] == cull::Verdict::outside) continue;
            visible.push_back(i);
            objects.triangles += source.scene.mesh(source.scene.mesh_of(i)).triangle_count();
        }
        pipeline::append_depth_objects(source.scene, clusters, source.one_sided, visible, camera, objects.list);
    }
    return frames;
}

void walk_street(const std::string& name, const depth::PictureView& view, int repeats) {
    auto source = expect(assets::load_scene(name), name.c_str());
    source.scene.update();
    auto& executor = serial_executor();
    const auto clusters = expect(pipeline::cut_scene(source.scene, executor), "clusters");
    std::size_t mesh_bytes = 0;
    for (scene::MeshId m = 0; m < source.scene.mesh_count(); ++m) mesh_bytes += bytes_of(source.scene.mesh(m));

    const Aabb focus = pipeline::focus_of(source.scene);
    const pipeline::Street street = pipeline::street_of(source, focus);
    pipeline::PathOptions path{.kind = "street", .aspect = static_cast<double>(view.width) / view.height};
    street.set(path);
    const auto cameras = expect(pipeline::make_camera_path(path, focus, street.walk), "path").cameras;
    const auto frames = objects_along(source, clusters, cameras);

    depth::DepthCuller culler;
    double least = HUGE_VAL;
    std::size_t in_frustum = 0, passed = 0;
    for (int r = 0; r < repeats; ++r) {
        in_frustum = passed = 0;
        const double begin = cpu_seconds();
        for (const Objects& objects : frames) {
            (void)expect(culler.find_visible(objects.list, view), "culler");
            in_frustum += objects.triangles;
            passed += culler.statistics().triangles_listed;
        }
        least = std::min(least, cpu_seconds() - begin);
    }
    const auto count = static_cast<double>(frames.size());
    std::printf("%-40s %4ux%-4u %8.0f in the frustum, %6.0f passed, %6.3f ms CPU a frame; clusters %.2f x the mesh\n",
                std::filesystem::path(name).filename().c_str(), view.width, view.height,
                static_cast<double>(in_frustum) / count, static_cast<double>(passed) / count, 1e3 * least / count,
                static_cast<double>(clusters.memory()) / static_cast<double>(mesh_bytes));
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
}

}  // namespace

// bench_depth [--target=NAME] [--repeats=N] [SCENE…]
int main(int argc, char** argv) {
    if (!take_target_option(argc, argv)) return 1;
    int repeats = 5;
    std::vector<std::string> scenes;
    for (int i = 1; i < argc; ++i)
        if (std::strncmp(argv[i], "--repeats=", 10) == 0)
            repeats = std::atoi(argv[i] + 10);
        else
            scenes.emplace_back(argv[i]);
    std::printf("Instruction set: %s\n", target_in_use());
    const bool all = scenes.empty();
    if (all) {
        scenes.emplace_back("town");
        const std::string forest = std::string(CROFTON_SHARED_DATA) + "/scenes/stk_black_forest.glb";
        if (std::filesystem::exists(forest)) scenes.push_back(forest);
    }
    for (const std::string& scene : scenes) walk_street(scene, {1280, 720}, repeats);
    if (all) cut_terrain(700);
    return 0;
}
