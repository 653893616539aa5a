// SPDX-License-Identifier: MIT
// What a frame costs by the way it is drawn, and what predicting its triangle count costs. On lavapipe, or on the
// device that the environment's CROFTON_DEVICE names.
#include <benchmark/benchmark.h>

#include <cmath>
#include <crofton/render/clip_space.hpp>
#include <crofton/render/rasterizer.hpp>
#include <cstdlib>
#include <optional>
#include <random>

using namespace crofton;
using namespace crofton::render;

namespace {

// A sphere of 2·rings·sectors triangles.
TriangleMesh sphere(int rings, int sectors, float radius) {
    TriangleMesh mesh;
    for (int i = 0; i <= rings; ++i) {
        for (int j = 0; j < sectors; ++j) {
            const float theta = 3.14159265f * static_cast<float>(i) / static_cast<float>(rings);
            const float phi = 6.28318531f * static_cast<float>(j) / static_cast<float>(sectors);
            mesh.positions.push_back(
                radius * glm::vec3(std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)));
        }
    }
    const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(i * sectors + j % sectors); };
    for (int i = 0; i < rings; ++i)
        for (int j = 0; j < sectors; ++j)
            for (const std::uint32_t index :
                 {at(i, j), at(i, j + 1), at(i + 1, j), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)})
                mesh.indices.push_back(index);
    return mesh;
}

Camera camera() {
    Camera result;
    result.position = {0.0, 10.0, 0.0};
    result.forward = {0.0, -0.05, -1.0};
    result.far_distance = 500.0;
    return result;
}

// 3,000 spheres of 100 triangles before the camera, each with its own copy in the buffer, like a town baked in tree
// order.
struct Spheres {
    static constexpr std::uint32_t kCount = 3000, kTriangles = 100;
    Vector<Vertex> vertices;
    Vector<std::uint32_t> indices;
    Vector<IndexRange> parts;

    Spheres() {
        std::mt19937_64 random(1);
        std::uniform_real_distribution<float> x(-150.0f, 150.0f), y(0.0f, 25.0f), z(-400.0f, -20.0f);
        for (std::uint32_t i = 0; i < kCount; ++i) {
            TriangleMesh mesh = sphere(5, 10, 2.0f);
            const glm::vec3 offset(x(random), y(random), z(random));
            for (glm::vec3& p : mesh.positions) p += offset;
            parts.push_back(append_mesh(mesh, {0.6f, 0.5f, 0.4f}, vertices, indices));
        }
    }
};

struct Scene {
    Spheres spheres;
    Result<Device> device;
    std::optional<Rasterizer> rasterizer;

    Scene() : device(make_device()) {
        if (!device) return;
        auto made = Rasterizer::create(*device, {1280, 720});
        if (!made || !made->set_geometry(spheres.vertices, spheres.indices)) return;
        rasterizer.emplace(std::move(*made));
    }
    static Result<Device> make_device() {
        DeviceOptions options;
        if (std::getenv("CROFTON_DEVICE") == nullptr) options.kind = DeviceKind::cpu;
        return Device::create(options);
    }
};

Scene& scene() {
    static Scene instance;
    return instance;
}

// How the visible spheres (every other block of `block` of them) reach the device.
void draw_frame(benchmark::State& state, bool own_transforms, bool one_draw, std::uint32_t block) {
    Scene& s = scene();
    if (!s.rasterizer) return state.SkipWithError("no software Vulkan device");
    const ModelToClip to_clip(camera());
    const DrawTransform transform = draw_transform(to_clip(glm::dmat3(1.0), glm::dvec3(0.0)), glm::dmat3(1.0));
    std::vector<DrawTransform> transforms;
    std::vector<DrawRange> ranges;
    std::vector<std::uint32_t> visible;
    for (std::uint32_t i = 0; i < Spheres::kCount; ++i)
        if (i / block % 2 == 0) visible.push_back(i);
    if (one_draw) {
        // The same triangles side by side in a buffer of their own.
        Vector<std::uint32_t> packed;
        for (const std::uint32_t i : visible) {
            const IndexRange& part = s.spheres.parts[i];
            packed.insert(packed.end(), s.spheres.indices.begin() + part.first_index,
                          s.spheres.indices.begin() + part.first_index + part.index_count);
        }
        if (!s.rasterizer->set_geometry(s.spheres.vertices, packed)) return state.SkipWithError("upload failed");
        ranges.push_back({0, static_cast<std::uint32_t>(packed.size()), 0});
    } else {
        if (!s.rasterizer->set_geometry(s.spheres.vertices, s.spheres.indices))
            return state.SkipWithError("upload failed");
        for (const std::uint32_t i : visible)
            ranges.push_back({s.spheres.parts[i].first_index, s.spheres.parts[i].index_count,
                              own_transforms ? static_cast<std::uint32_t>(ranges.size()) : 0});
    }
    transforms.assign(own_transforms ? ranges.size() : 1, transform);
    GpuCounters counters;
    for (auto _ : state) {
        auto drawn = s.rasterizer->draw({camera(), transforms, ranges});
        if (!drawn) return state.SkipWithError("draw failed");
        counters = *drawn;
    }
    state.counters["triangles"] = static_cast<double>(counters.input_assembly_primitives);
    state.counters["clipped"] = static_cast<double>(counters.clipping_primitives);
    state.counters["draws"] = s.rasterizer->draw_count();
}

void draw_visible_in_one_range(benchmark::State& state) {
    draw_frame(state, false, true, 25);
}
void draw_visible_in_blocks_of_25(benchmark::State& state) {
    draw_frame(state, false, false, 25);
}
void draw_visible_one_by_one(benchmark::State& state) {
    draw_frame(state, false, false, 1);
}
void draw_visible_one_by_one_own_transforms(benchmark::State& state) {
    draw_frame(state, true, false, 1);
}
BENCHMARK(draw_visible_in_one_range)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();
BENCHMARK(draw_visible_in_blocks_of_25)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();
BENCHMARK(draw_visible_one_by_one)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();
BENCHMARK(draw_visible_one_by_one_own_transforms)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

void predict(benchmark::State& state, float distance) {
    const TriangleMesh mesh = sphere(50, 100, 10.0f);
    Camera view;
    view.far_distance = 100.0;
    const glm::mat4 matrix = ModelToClip(view)(glm::dmat3(1.0), {0.0, 0.0, -static_cast<double>(distance)});
    ClipPredictor predictor;
    std::uint64_t count = 0;
    for (auto _ : state) benchmark::DoNotOptimize(count = predictor.count(mesh.positions, mesh.indices, matrix));
    state.counters["clipped"] = static_cast<double>(count);
    state.counters["seconds per triangle"] =
        benchmark::Counter(static_cast<double>(mesh.triangle_count()),
                           benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
void predict_inside(benchmark::State& state) {
    predict(state, 50.0f);
}
void predict_around_the_camera(benchmark::State& state) {
    predict(state, 0.0f);
}
void predict_crossing(benchmark::State& state) {
    predict(state, 12.0f);
}
BENCHMARK(predict_inside);
BENCHMARK(predict_crossing);
BENCHMARK(predict_around_the_camera);

}  // namespace
