// SPDX-License-Identifier: MIT
#include "loaded_scene.hpp"

#include <algorithm>

#include <chrono>
#include <crofton/geometry/box.hpp>
#include <glm/geometric.hpp>

#include "assets/retriangulate.hpp"
#include "pipeline/camera_path.hpp"

namespace crofton::viewer {
namespace {

// Spheres and axis-aligned boxes are taken around the vertices; they live with any boxes in the scene.
bool uses_own_boxes(pipeline::BoundsKind kind) {
    return kind == pipeline::BoundsKind::obb_volume || kind == pipeline::BoundsKind::obb_area ||
           kind == pipeline::BoundsKind::obb_frustum;
}

Camera typical_camera() {
    Camera camera;
    camera.far_distance = 200.0;
    return camera;
}

triangulate::Method triangulation_method(Triangulation triangulation) {
    switch (triangulation) {
        case Triangulation::ear:
            return triangulate::Method::ear;
        case Triangulation::delaunay:
            return triangulate::Method::delaunay;
        default:
            return triangulate::Method::minimum_weight;
    }
}

pipeline::PipelineOptions options_of(const Method& method, const Settings& settings) {
    pipeline::PipelineOptions options;
    options.bounds = method.bounds;
    options.cull = method.cull;
    options.tree = method.tree;
    options.mode = settings.exact ? cull::CullMode::exact : cull::CullMode::conservative;
    options.collide = settings.collisions;
    if (method.occlude) options.occlusion.emplace();
    return options;
}

bool same(const pipeline::PipelineOptions& a, const pipeline::PipelineOptions& b) {
    return a.bounds == b.bounds && a.cull == b.cull && a.tree == b.tree && a.mode == b.mode && a.collide == b.collide &&
           a.occlusion.has_value() == b.occlusion.has_value();
}

}  // namespace

Result<std::unique_ptr<LoadedScene>> LoadedScene::load(const SceneRequest& request, const Method& method,
                                                       const Settings& settings, const LoadedScene* like) {
    if (pipeline::holds_regions(request.source)) {
        if (request.unit > 0.0) return fail(ErrorCode::unsupported, kNoItem, "--unit is not for a folder of regions");
        return load_regions(request, settings);
    }
    const auto criterion = pipeline::criterion_for(method.bounds, typical_camera());
    if (!criterion) return criterion.error();
    assets::LoadOptions options;
    options.criterion = *criterion;
    options.map = request.map;
    options.seed = request.seed;
    options.instances = request.instances;
    options.limits = request.limits;
    options.strict = request.strict;
    options.unit = request.unit;
    auto source = assets::load_scene(request.source, options);
    if (!source) return std::move(source.error());
    if (method.triangulation != Triangulation::loaded)
        if (auto cut = assets::retriangulate(*source, options, triangulation_method(method.triangulation)); !cut)
            return std::move(cut.error());
    std::unique_ptr<LoadedScene> loaded(new LoadedScene(std::move(*source)));
    loaded->source_.scene.update();
    loaded->clusters_ = pipeline::take_clusters(loaded->source_);
    const scene::Scene& scene = loaded->source_.scene;
    for (scene::InstanceId i = 0; i < scene.instance_count(); ++i) {
        if (scene.is_removed(i)) continue;
        loaded->extent_.include(aabb_of(scene.world_boxes()[i]));
        loaded->triangle_count_ += scene.mesh(scene.mesh_of(i)).triangle_count();
    }
    loaded->focus_ = pipeline::focus_of(scene);
    loaded->shapes_.emplace(scene);
    if (auto taken = loaded->take_baked(request, method, like); !taken) return std::move(taken.error());
    if (auto configured = loaded->configure(method, settings); !configured) return std::move(configured.error());
    return loaded;
}

Result<std::unique_ptr<LoadedScene>> LoadedScene::load_regions(const SceneRequest& request, const Settings& settings) {
    auto regions = pipeline::RegionPipeline::open(
        request.source,
        {.stream = {.waits = request.waits_for_regions, .largest_file = request.limits.bytes, .sets = true}});
    if (!regions) return std::move(regions.error());
    std::unique_ptr<LoadedScene> loaded(new LoadedScene({request.source, scene::Scene(), {}, {}, {}, {}}));
    loaded->regions_.emplace(std::move(*regions));
    const pipeline::RegionStream& stream = loaded->regions_->stream();
    // Looked at first: the region with the most objects.
    const auto most = std::ranges::max_element(stream.index(), {}, &bake::RegionFile::objects);
    loaded->extent_ = stream.bounds();
    loaded->focus_ = {most->bounds.min + most->origin, most->bounds.max + most->origin};
    loaded->shapes_.emplace(loaded->scene());
    if (auto configured = loaded->configure({}, settings); !configured) return std::move(configured.error());
    return loaded;
}

Result<void> LoadedScene::take_baked(const SceneRequest& request, const Method& method, const LoadedScene* like) {
    // The scene's file may have changed since it was loaded.
    const bool same = like != nullptr && like->method_.triangulation == method.triangulation &&
                      pipeline::same_parts(like->scene(), scene());
    if (same) {
        baked_ = like->baked_;
        if (auto found = like->pipeline_->occluders()) baked_.occluders = std::move(found);
        if (baked_.pvs && !pipeline::is_baked_of(*baked_.pvs, scene())) {
            baked_.pvs = nullptr;
            source_.warnings.push_back(
                "the visible sets are left out: something stands elsewhere than when they were "
                "baked");
        }
    } else if (!request.baked.empty()) {
        auto parts = pipeline::load_baked_parts(request.baked, source_.scene, request.limits);
        if (!parts) return std::move(parts.error());
        // Baked data is for the triangles as they were loaded; other triangulations may have others.
        if (!parts->left_out.empty() && method.triangulation == Triangulation::loaded)
            return std::move(parts->left_out.front());
        for (Error& error : parts->left_out) source_.warnings.push_back(std::move(error.message));
        baked_ = std::move(*parts);
    }
    return {};
}

bool LoadedScene::needs_reload(const Method& method) const {
    if (regions_) return false;
    if (method.triangulation != method_.triangulation) return true;
    if (!uses_own_boxes(method.bounds) && !uses_own_boxes(method_.bounds)) return false;
    return method.bounds != method_.bounds;
}

Result<void> LoadedScene::configure(const Method& method, const Settings& settings) {
    const pipeline::PipelineOptions wanted = options_of(method, settings);
    if (pipeline_ && same(wanted, options_)) return {};
    if (pipeline_ && wanted.bounds == options_.bounds && wanted.tree == options_.tree) {
        if (auto set = pipeline_->set_options(wanted); !set) return set;
    } else {
        const auto occluders = pipeline_ && pipeline_->occluders() ? pipeline_->occluders() : baked_.occluders;
        auto made = pipeline::Pipeline::create(source_.scene, source_.movers, wanted, serial_executor(), occluders);
        if (!made) return std::move(made.error());
        pipeline_.emplace(std::move(*made));
    }
    method_ = method;
    options_ = wanted;
    return {};
}

void LoadedScene::animate(std::uint32_t frame) {
    const auto start = std::chrono::steady_clock::now();
    source_.animate(frame);
    source_.scene.update();
    scene_frame_ = frame;
    update_us_ = std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count();
}

Result<pipeline::FrameStatistics> LoadedScene::run(const Camera& camera) {
    if (regions_) return regions_->run(camera, serial_executor());
    auto frame = pipeline_->run(camera);
    if (!frame) return frame;
    frame->update_us += update_us_;
    occlusion_.apply(source_.scene, *pipeline_, *frame);
    return frame;
}

}  // namespace crofton::viewer
