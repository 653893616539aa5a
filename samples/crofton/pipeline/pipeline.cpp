// SPDX-License-Identifier: MIT
#include "pipeline.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <crofton/cull/cull.hpp>
#include <glm/geometric.hpp>
#include <utility>

#include "camera_path.hpp"
#include "object_counts.hpp"

namespace crofton::pipeline {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::array<std::pair<const char*, CullMode>, 3> kModes = {
    {{"none", CullMode::none}, {"flat", CullMode::flat}, {"tree", CullMode::tree}}};

constexpr std::uint32_t kColliderLayer = 2;

double microseconds_since(Clock::time_point start) {
    return std::chrono::duration<double, std::micro>(Clock::now() - start).count();
}

}  // namespace

Camera sun_over(const glm::dvec3& center, double half_width, double reach) {
    Camera sun;
    sun.projection = Projection::orthographic;
    sun.forward = glm::normalize(glm::dvec3(0.5, -1.0, 0.3));
    sun.height = 2.0 * half_width;
    sun.aspect = 1.0;
    sun.position = center - 2.0 * reach * sun.forward;
    sun.near_distance = 0.01 * reach;
    sun.far_distance = 4.0 * reach;
    return sun;
}

Result<CullMode> cull_mode_from(const std::string& name) {
    for (const auto& [known, mode] : kModes)
        if (name == known) return mode;
    return fail(ErrorCode::invalid_argument, kNoItem, "cull: '" + name + "' is not one of none, flat, tree");
}

Result<boxtree::Orientation> orientation_from(const std::string& name) {
    using enum boxtree::Orientation;
    for (const boxtree::Orientation orientation : {aligned, oriented, automatic})
        if (name == to_string(orientation)) return orientation;
    return fail(ErrorCode::invalid_argument, kNoItem,
                "tree: '" + name + "' is not one of aligned, oriented, automatic");
}

const char* to_string(boxtree::Orientation orientation) {
    switch (orientation) {
        case boxtree::Orientation::aligned:
            return "aligned";
        case boxtree::Orientation::oriented:
            return "oriented";
        default:
            return "automatic";
    }
}

const char* to_string(CullMode mode) {
    return kModes[static_cast<std::size_t>(mode)].first;
}

struct Pipeline::State {
    const scene::Scene& scene;
    std::vector<scene::InstanceId> movers;
    PipelineOptions options;
    Executor& executor;
    Bounds bounds;
    World world;
    std::vector<ObjectHandle> objects;    // by instance
    std::vector<ObjectHandle> colliders;  // by instance where it collides by another box than it is seen by; else empty
    WorldStatistics tests;                // of the last update in which anything moved: its pairs are still those
    std::shared_ptr<const SceneOccluders> occluders;
    std::vector<ObjectHandle> occluding;  // by node; null: hides nothing. Empty until occlusion is first asked for
    ViewResult visible, not_hidden;
    cull::VisibleSet visible_in_list;  // CullMode::flat
    std::vector<cull::Verdict> verdicts;
    std::vector<scene::InstanceId> visible_ids;
    ObjectCounter counter;
    std::shared_ptr<const SceneClusters> clusters;
    depth::DepthCuller depth_culler, caster_culler;
    std::vector<depth::DepthObject> depth_objects, casters, on_map;
    std::vector<depth::DepthReceiver> receivers;
    ViewResult of_sun;
    std::optional<Camera> sun;

    State(const scene::Scene& the_scene, std::vector<scene::InstanceId> the_movers, const PipelineOptions& the_options,
          Executor& the_executor, std::shared_ptr<const SceneOccluders> the_occluders)
        : scene(the_scene),
          movers(std::move(the_movers)),
          options(the_options),
          executor(the_executor),
          bounds(the_scene, the_options.bounds),
          world({.tree = the_options.tree, .trace = the_options.trace}),
          occluders(std::move(the_occluders)),
          verdicts(the_scene.instance_count(), cull::Verdict::outside) {
        std::sort(movers.begin(), movers.end());
    }

    // Movers collide by their oriented boxes, whatever bound they are seen by: by an object of their own where the two
    // differ.
    [[nodiscard]] bool collides_apart() const {
        return options.bounds == BoundsKind::sphere || options.bounds == BoundsKind::aabb;
    }
    [[nodiscard]] std::uint32_t collider_layer(scene::InstanceId instance) const {
        return !collides_apart() && std::binary_search(movers.begin(), movers.end(), instance) ? kColliderLayer : 0;
    }
    [[nodiscard]] std::uint32_t collides_with(std::uint32_t layer) const { return options.collide ? layer : 0; }
    [[nodiscard]] std::uint32_t layers_of(scene::InstanceId instance) const {
        return (scene.layer_masks()[instance] != 0 ? kSeenLayer : 0) | collider_layer(instance);
    }

    // An object for each instance, with a bound alone: nodes and meshes are the scene's.
    Result<void> add_objects() {
        for (scene::InstanceId i = 0; i < scene.instance_count(); ++i) {
            const bool removed = scene.is_removed(i);
            const auto object = world.add({.bound = removed ? Obb{} : bounds.boxes()[i],
                                           .user = i,
                                           .layers = removed ? 0 : layers_of(i),
                                           .collides_with = collides_with(collider_layer(i))});
            if (!object) return fail(object.error().code, i, object.error().message);
            objects.push_back(*object);
        }
        return {};
    }

    Result<void> add_colliders() {
        if (!collides_apart()) return {};
        colliders.resize(objects.size());
        for (const scene::InstanceId mover : movers) {
            if (scene.is_removed(mover)) continue;
            const auto object = world.add({.bound = scene.world_boxes()[mover],
                                           .user = mover,
                                           .layers = kColliderLayer,
                                           .collides_with = collides_with(kColliderLayer)});
            if (!object) return fail(object.error().code, mover, object.error().message);
            colliders[mover] = *object;
        }
        return {};
    }

    // Objects that hide others and are in no answer: instances are seen by their bounds, nodes hide as a whole.
    Result<void> add_occluders() {
        if (!options.occlusion || !occluding.empty()) return {};
        if (!occluders) occluders = std::make_shared<const SceneOccluders>(find_scene_occluders(scene, executor));
        std::vector<MeshHandle> meshes(occluders->kinds.size());
        occluding.resize(scene.node_count());
        for (const SceneOccluders::Object& object : occluders->objects) {
            const SceneOccluders::Kind& kind = occluders->kinds[object.kind];
            MeshHandle& mesh = meshes[object.kind];
            if (mesh.is_null()) {
                const auto added = world.add_mesh(
                    {.positions = kind.mesh.positions, .indices = kind.mesh.indices, .triangles = false});
                if (!added) return added.error();
                mesh = *added;
                if (auto set = world.set_occluders(mesh, kind.found.occluders); !set) return set;
            }
            const auto added = world.add({.mesh = mesh,
                                          .transform = scene.world(object.node),
                                          .user = object.node,
                                          .layers = kSeenLayer,
                                          .collides_with = 0,
                                          .only_occludes = true});
            if (!added) return added.error();
            occluding[object.node] = *added;
        }
        return {};
    }

    Result<void> add_clusters() {
        if (!options.picture || clusters) return {};
        clusters = options.clusters;
        if (clusters) return {};
        auto cut = cut_scene(scene, executor);
        if (!cut) return cut.error();
        clusters = std::make_shared<const SceneClusters>(std::move(*cut));
        return {};
    }

    // Movers are in pairs only while collisions are of interest.
    Result<void> set_collide() {
        for (const scene::InstanceId mover : movers) {
            const ObjectHandle object = colliders.empty() ? objects[mover] : colliders[mover];
            if (object.is_null() || scene.is_removed(mover)) continue;
            if (auto set = world.set_collides_with(object, collides_with(kColliderLayer)); !set) return set;
        }
        auto updated = update_world();
        tests = world.statistics();
        return updated;
    }

    [[nodiscard]] ObjectHandle occluder_of(scene::InstanceId instance) const {
        return occluding.empty() ? ObjectHandle{} : occluding[scene.node_of(instance)];
    }

    Result<void> update_world() {
        auto updated = world.update(executor);
        if (world.statistics().boxes_changed > 0) tests = world.statistics();
        return updated;
    }

    Result<void> follow_scene() {
        bounds.update();
        for (const scene::InstanceId i : scene.relayered_instances()) {
            if (auto set = world.set_layers(objects[i], layers_of(i)); !set) return set;
            // An object that is not drawn whole any more hides nothing more.
            const ObjectHandle occluder = occluder_of(i);
            if (scene.layer_masks()[i] != 0 || occluder.is_null()) continue;
            if (auto set = world.set_hidden(occluder, true); !set) return set;
        }
        for (const scene::InstanceId i : scene.moved_instances()) {
            if (auto set = world.set_bound(objects[i], bounds.boxes()[i]); !set) return set;
            if (!colliders.empty() && !colliders[i].is_null())
                if (auto set = world.set_bound(colliders[i], scene.world_boxes()[i]); !set) return set;
            if (const ObjectHandle occluder = occluder_of(i); !occluder.is_null())
                if (auto set = world.set_transform(occluder, scene.world(scene.node_of(i))); !set) return set;
        }
        return update_world();
    }

    // Without culling every bound is all of space, and that straddles. What is hidden stays so.
    void list_all() {
        for (scene::InstanceId i = 0; i < scene.instance_count(); ++i)
            if (!scene.is_removed(i) && scene.layer_masks()[i] != 0) visible_ids.push_back(i);
        for (const scene::InstanceId i : visible_ids) verdicts[i] = cull::Verdict::straddling;
    }

    void list(const Frustum& frustum, std::span<const std::uint32_t> ids, std::span<const cull::Verdict> found) {
        visible_ids.assign(ids.begin(), ids.end());
        for (std::size_t k = 0; k < ids.size(); ++k) verdicts[ids[k]] = found[k];
        if (!bounds.spheres().empty()) decide_by_spheres(frustum);
    }

    // By planes alone: near the frustum's edges one outside may pass, which is one reason for boxes.
    void decide_by_spheres(const Frustum& frustum) {
        for (const scene::InstanceId i : visible_ids)
            verdicts[i] = cull::classify(frustum, bounds.spheres()[i], cull::CullMode::conservative);
        std::erase_if(visible_ids, [&](scene::InstanceId i) { return verdicts[i] == cull::Verdict::outside; });
    }

    void list_visible(const Frustum& frustum) {
        for (const scene::InstanceId i : visible_ids) verdicts[i] = cull::Verdict::outside;
        visible_ids.clear();
        switch (options.cull) {
            case CullMode::none:
                return list_all();
            case CullMode::flat:
                cull::find_visible(bounds.boxes(), scene.layer_masks(), {frustum}, visible_in_list,
                                   {.mode = options.mode}, executor);
                return list(frustum, visible_in_list.ids(), visible_in_list.verdicts());
            case CullMode::tree:
                (void)world.view({.volume = frustum, .layers = kSeenLayer, .mode = options.mode}, visible, executor);
                return list(frustum, visible.ids(), visible.verdicts());
        }
    }

    Result<void> find_not_hidden(const Camera& camera, const Frustum& frustum, OccludedFrame& frame) {
        const auto start = Clock::now();
        const ViewRequest request{
            .camera = camera, .layers = kSeenLayer, .occlusion = options.occlusion, .mode = options.mode};
        if (auto seen = world.view(request, not_hidden, executor); !seen) return seen;
        frame.occlude_us = microseconds_since(start);
        frame.occluders = not_hidden.occlusion_statistics().occluders_drawn;
        for (const std::uint32_t id : not_hidden.ids())
            if (verdicts[id] != cull::Verdict::outside) frame.visible_ids.push_back(id);
        frame.visible = frame.visible_ids.size();
        if (!options.count_triangles) return {};
        const ObjectCounts counts = counter.count(SceneDrawables(scene), frustum, frame.visible_ids, verdicts);
        frame.triangles_submitted = counts.triangles_submitted;
        frame.triangles_passed = counts.triangles_passed;
        return {};
    }

    // By the depth of what is drawn.
    Result<void> find_triangles(const Camera& camera, const Frustum& frustum, OccludedFrame& frame) {
        const auto start = Clock::now();
        depth_objects.clear();
        append_depth_objects(scene, *clusters, options.one_sided, visible_ids, camera, depth_objects);
        const auto found = depth_culler.find_visible(depth_objects, *options.picture, executor);
        if (!found) return found.error();
        frame.by_depth = true;
        frame.clusters.assign(found->begin(), found->end());
        for (depth::VisibleCluster& cluster : frame.clusters) {
            cluster.object = visible_ids[cluster.object];
            if (frame.visible_ids.empty() || frame.visible_ids.back() != cluster.object)
                frame.visible_ids.push_back(cluster.object);
        }
        frame.occlude_us = microseconds_since(start);
        frame.visible = frame.visible_ids.size();
        frame.triangles_submitted = depth_culler.statistics().triangles_listed;
        if (options.count_triangles)
            frame.triangles_passed = counter.count(SceneDrawables(scene), frustum, *clusters, frame.clusters);
        return {};
    }

    // After find_triangles().
    Result<void> find_casters(ShadowFrame& frame) {
        if (!sun) {
            const Aabb focus = focus_of(scene);
            const double reach = glm::length(focus.half_extents());
            sun = sun_over(focus.center(), reach, reach);
        }
        const auto start = Clock::now();
        if (auto seen = world.view({.camera = *sun, .layers = kSeenLayer}, of_sun, executor); !seen) return seen;
        casters.clear(), on_map.clear(), receivers.clear();
        append_depth_objects(scene, *clusters, options.one_sided, of_sun.ids(), *sun, casters);
        append_depth_objects(scene, *clusters, options.one_sided, visible_ids, *sun, on_map);
        for (const depth::DepthObject& o : on_map) receivers.push_back({o.mesh, o.to_clip});
        // Looked up by 3 x 3 bilinear comparisons.
        const auto found = caster_culler.find_casters(casters, {options.shadow_map, options.shadow_map},
                                                      {&depth_culler, receivers, 2.0f}, executor);
        if (!found) return found.error();
        frame.find_us = microseconds_since(start);
        frame.casters = casters.size();
        for (const depth::DepthObject& o : casters) frame.triangles += o.mesh->triangle_count();
        frame.casters_listed = caster_culler.statistics().objects_listed;
        frame.triangles_listed = caster_culler.statistics().triangles_listed;
        return {};
    }

    [[nodiscard]] std::uint64_t nodes_tested() const {
        return options.cull == CullMode::tree ? visible.statistics().nodes_tested : 0;
    }

    void count_pairs(FrameStatistics& frame) const {
        for (const ObjectPair& pair : world.pairs())
            frame.colliding_ids.emplace_back(static_cast<std::uint32_t>(pair.first.user),
                                             static_cast<std::uint32_t>(pair.second.user));
        for (const Contact& contact : world.contacts()) frame.contacts += contact.points.size();
        frame.colliding_pairs = frame.colliding_ids.size();
        frame.pairs_tested = tests.box_pairs_tested;
        frame.separated_by_face_a = tests.box_tests.separated_by_face_a;
        frame.separated_by_face_b = tests.box_tests.separated_by_face_b;
        frame.separated_by_edges = tests.box_tests.separated_by_edges;
        frame.pairs_refined = tests.box_tests.refined;
        frame.collide_us = world.statistics().contacts_us;
    }
};

Pipeline::Pipeline(std::unique_ptr<State> state) : state_(std::move(state)) {}
Pipeline::~Pipeline() = default;
Pipeline::Pipeline(Pipeline&&) noexcept = default;
Pipeline& Pipeline::operator=(Pipeline&&) noexcept = default;

Result<Pipeline> Pipeline::create(const scene::Scene& scene, std::vector<scene::InstanceId> movers,
                                  const PipelineOptions& options, Executor& executor,
                                  std::shared_ptr<const SceneOccluders> occluders) {
    for (const scene::InstanceId mover : movers)
        if (mover >= scene.instance_count())
            return fail(ErrorCode::out_of_range, mover, "pipeline: a mover is not an instance");
    auto state = std::make_unique<State>(scene, std::move(movers), options, executor, std::move(occluders));
    for (const auto step : {&State::add_objects, &State::add_colliders, &State::add_occluders, &State::add_clusters,
                            &State::update_world})
        if (auto done = (*state.*step)(); !done) return done.error();
    return Pipeline(std::move(state));
}

Result<void> Pipeline::set_options(const PipelineOptions& options) {
    State& s = *state_;
    const PipelineOptions old = s.options;
    s.options = options;
    s.options.bounds = old.bounds, s.options.tree = old.tree, s.options.trace = old.trace;
    auto done = s.add_occluders();
    if (done) done = s.add_clusters();
    if (done && options.collide != old.collide) done = s.set_collide();
    return done ? s.update_world() : done;
}

std::shared_ptr<const SceneOccluders> Pipeline::occluders() const {
    return state_->occluders;
}
std::shared_ptr<const SceneClusters> Pipeline::clusters() const {
    return state_->clusters;
}

Result<FrameStatistics> Pipeline::run(const Camera& camera) {
    State& s = *state_;
    const auto frustum = frustum_of(camera);
    if (!frustum) return frustum.error();
    FrameStatistics frame;
    frame.camera = camera;
    const auto start = Clock::now();
    if (auto followed = s.follow_scene(); !followed) return followed.error();
    frame.update_us = microseconds_since(start);
    if (s.options.collide) s.count_pairs(frame);
    frame.update_us -= frame.collide_us;

    const auto cull_start = Clock::now();
    s.list_visible(*frustum);
    frame.cull_us = microseconds_since(cull_start);

    for (scene::InstanceId i = 0; i < s.scene.instance_count(); ++i) frame.instances += !s.scene.is_removed(i);
    frame.visible = s.visible_ids.size();
    for (const scene::InstanceId i : s.visible_ids) frame.inside += s.verdicts[i] == cull::Verdict::inside;
    frame.straddling = frame.visible - frame.inside;
    frame.nodes_tested = s.nodes_tested();
    frame.visible_ids = s.visible_ids;
    if (s.options.count_triangles) {
        const ObjectCounts counts = s.counter.count(SceneDrawables(s.scene), *frustum, s.visible_ids, s.verdicts);
        frame.triangles_submitted = counts.triangles_submitted;
        frame.triangles_passed = counts.triangles_passed;
        frame.improper = counts.improper;
    }
    if (s.options.picture) {
        if (auto found = s.find_triangles(camera, *frustum, frame.occlusion.emplace()); !found) return found.error();
        if (s.options.shadow_map != 0)
            if (auto found = s.find_casters(frame.shadow.emplace()); !found) return found.error();
    } else if (s.options.occlusion)
        if (auto found = s.find_not_hidden(camera, *frustum, frame.occlusion.emplace()); !found) return found.error();
    return frame;
}

std::span<const cull::Verdict> Pipeline::verdicts() const {
    return state_->verdicts;
}
const Bounds& Pipeline::bounds() const {
    return state_->bounds;
}
std::span<const scene::InstanceId> Pipeline::movers() const {
    return state_->movers;
}
const World& Pipeline::world() const {
    return state_->world;
}
const ViewResult& Pipeline::not_hidden() const {
    return state_->not_hidden;
}

}  // namespace crofton::pipeline
