// SPDX-License-Identifier: MIT
#include <cmath>
#include <crofton/crofton.hpp>
#include <crofton/sampling/sampling.hpp>
#include <cstdio>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <map>

#include "pipeline/scene_occluders.hpp"

#include "topics.hpp"

namespace crofton::cli {
namespace {

using sampling::Random;

constexpr std::size_t kThings = 1000;
constexpr int kRaysPerView = 4096, kThingsEvery = 16;
constexpr occlude::BufferSize kSceneSizes[] = {{160, 90}, {320, 180}, {480, 270}, {640, 360}};

// Small boxes beside what the scene has, all under one node that moves the scene.
struct Stage {
    World world{{.pairs = false, .updates_to_rest = 1}};
    NodeHandle root = world.add_node().value();
    std::vector<glm::dvec3> walk;
    Aabb bounds;
    std::vector<ObjectHandle> things;
    std::vector<Obb> boxes = std::vector<Obb>(kThings);
    glm::dvec3 offset{0.0};
};

// Adds a node of many meshes. The node itself is in no answer; its meshes are.
Result<void> add_level(scene::Scene& scene, scene::NodeId node, const std::vector<scene::MeshId>& ids, Stage& stage) {
    TriangleMesh all;
    for (const scene::MeshId id : ids) append(all, scene.mesh(id));
    const auto mesh = stage.world.add_mesh({.positions = all.positions, .indices = all.indices, .triangles = false});
    if (!mesh) return mesh.error();
    const occlude::FindOptions how{.sides = occlude::Sides::both, .level_triangles = pipeline::kLevelTriangles};
    if (auto found = stage.world.find_occluders(*mesh, how); !found) return found;
    const auto object =
        stage.world.add({.mesh = *mesh, .node = stage.root, .transform = scene.world(node), .only_occludes = true});
    if (!object) return object.error();
    return {};
}

// Few meshes of a node are one object: a house of seven parts has better occluders as a whole. Rays meet both sides of
// a triangle, so both sides are drawn.
Result<Stage> stage_of(assets::SceneSource& source) {
    Stage stage;
    scene::Scene& scene = source.scene;
    scene.update();
    std::map<scene::NodeId, std::vector<scene::MeshId>> parts;
    for (scene::InstanceId i = 0; i < scene.instance_count(); ++i) {
        if (scene.is_removed(i) || scene.layer_masks()[i] == 0) continue;
        parts[scene.node_of(i)].push_back(scene.mesh_of(i));
        stage.bounds.include(aabb_of(scene.world_boxes()[i]));
    }
    std::vector<std::pair<scene::NodeId, std::vector<scene::MeshId>>> objects;
    for (const auto& [node, ids] : parts) {
        if (ids.size() <= pipeline::kMostParts) objects.emplace_back(node, ids);
        if (ids.size() <= pipeline::kMostParts) continue;
        for (const scene::MeshId id : ids) objects.push_back({node, {id}});
        if (auto added = add_level(scene, node, ids, stage); !added) return added.error();
    }
    std::map<std::vector<scene::MeshId>, MeshHandle> meshes;
    for (const auto& [node, ids] : objects) {
        MeshHandle& mesh = meshes[ids];
        if (mesh.is_null()) {
            TriangleMesh all;
            for (const scene::MeshId id : ids) append(all, scene.mesh(id));
            const auto added = stage.world.add_mesh({.positions = all.positions, .indices = all.indices});
            if (!added) return added.error();
            mesh = *added;
            // Large patches, too: they are drawn in a way of their own.
            const occlude::FindOptions how{.sides = occlude::Sides::both, .max_patch_triangles = 1000};
            if (auto found = stage.world.find_occluders(mesh, how); !found) return found.error();
        }
        const auto object = stage.world.add({.mesh = mesh, .node = stage.root, .transform = scene.world(node)});
        if (!object) return object.error();
    }
    for (Obb& box : stage.boxes) stage.things.push_back(stage.world.add({.bound = box}).value());
    stage.walk = source.walk;
    return stage;
}

glm::dvec3 place(Random& random, const Stage& stage) {
    if (stage.walk.size() > 1 && random.uniform() < 0.8) {
        const std::size_t leg = random.bits() % stage.walk.size();
        const glm::dvec3 a = stage.walk[leg], b = stage.walk[(leg + 1) % stage.walk.size()];
        const double along = random.uniform(), x = random.uniform(-3.0, 3.0), z = random.uniform(-3.0, 3.0);
        return stage.offset + a + along * (b - a) + glm::dvec3(x, random.uniform(-0.5, 1.0), z);
    }
    const glm::dvec3 size = stage.bounds.max - stage.bounds.min;
    const double x = random.uniform(), y = random.uniform(), z = random.uniform();
    return stage.offset + stage.bounds.min + glm::dvec3(x, y * y, z) * size;
}

void move(Random& random, double offset, Stage& stage) {
    stage.offset = offset * glm::dvec3(1.0, -0.75, 0.25);
    const double scale = glm::length(stage.bounds.max - stage.bounds.min);
    for (Obb& box : stage.boxes) {
        box.center = place(random, stage);
        box.axes = glm::mat3(sampling::rotation(random.point<3>()));
        box.half_extents = glm::vec3(static_cast<float>(scale * 1e-4 * std::pow(20.0, random.uniform())));
    }
    (void)stage.world.set_transform(stage.root, {glm::dmat3(1.0), stage.offset});
    (void)stage.world.set_bounds(stage.things, stage.boxes);
    (void)stage.world.update();
    // Rays ask each moving object in turn, so the things come to rest, but for every eighth time.
    if (random.bits() % 8 == 0) return;
    for (int i = 0; i < 16 && stage.world.statistics().moving > 0; ++i) (void)stage.world.update();
}

Camera camera_in(Random& random, const Stage& stage) {
    const double scale = glm::length(stage.bounds.max - stage.bounds.min);
    Camera camera;
    camera.position = place(random, stage);
    const double x = random.uniform(-1.0, 1.0), y = random.uniform(-0.3, 0.3), z = random.uniform(-1.0, 1.0);
    camera.forward = {x, y, z + 1e-3};
    camera.near_distance = scale * 1e-5 * std::pow(100.0, random.uniform());
    camera.far_distance = 2.0 * scale;
    camera.fov_y = random.uniform(0.3, 2.0);
    camera.aspect = random.uniform(0.7, 2.0);
    if (random.uniform() > 0.15) return camera;
    camera.projection = Projection::orthographic;
    camera.height = scale * random.uniform(0.02, 0.5);
    return camera;
}

struct SceneCounts {
    std::uint64_t rays = 0, witnesses = 0, culled = 0, in_view = 0, hidden = 0;
};

// From the near plane through a random point of the picture.
Ray random_ray(Random& random, const Camera& camera) {
    const glm::dmat3 to_world = glm::transpose(world_to_view_rotation(camera));
    const double u = 0.9999 * random.uniform(-1.0, 1.0), v = 0.9999 * random.uniform(-1.0, 1.0);
    if (camera.projection == Projection::perspective) {
        const double half = std::tan(0.5 * camera.fov_y);
        const glm::dvec3 along = to_world * glm::dvec3(u * half * camera.aspect, v * half, -1.0);
        return {camera.position + 1.0001 * camera.near_distance * along, along, camera.far_distance * 0.999};
    }
    const double half = 0.5 * camera.height;
    const glm::dvec3 ahead = glm::normalize(camera.forward);
    const glm::dvec3 from = camera.position + to_world * glm::dvec3(u * half * camera.aspect, v * half, 0.0);
    return {from + 1.0001 * camera.near_distance * ahead, ahead, camera.far_distance * 0.999};
}

void look(Random& random, const Stage& stage, ViewResult& visible, std::vector<bool>& seen, SceneCounts& counts) {
    const Camera camera = camera_in(random, stage);
    const OcclusionOptions occlusion{.size = kSceneSizes[random.bits() % 4], .list_occluded = true};
    if (!stage.world.view({.camera = camera, .occlusion = occlusion}, visible)) {
        counts.rays += kRaysPerView;  // none is a witness
        return;
    }
    counts.hidden += visible.occluded_ids().size();
    counts.in_view += visible.occluded_ids().size() + visible.size();
    for (const std::uint32_t id : visible.ids()) seen[id] = true;
    const int rays = stage.world.statistics().moving > 0 ? kRaysPerView / 16 : kRaysPerView;
    for (int n = 0; n < rays; ++n) {
        ++counts.rays;
        const auto hit = stage.world.raycast(random_ray(random, camera));
        if (!hit) continue;
        ++counts.witnesses;
        counts.culled += !seen[hit->object.index];
    }
    for (const std::uint32_t id : visible.ids()) seen[id] = false;
}

}  // namespace

Result<std::vector<VerifyRow>> verify_occluded_scene(const std::string& name, const assets::LoadOptions& which,
                                                     const VerifyOptions& options) {
    auto source = assets::load_scene(name, which);
    if (!source) return source.error();
    auto stage = stage_of(*source);
    if (!stage) return stage.error();
    std::vector<VerifyRow> rows;
    const std::string level = which.map.empty() ? "" : " " + which.map;
    ViewResult visible;
    std::vector<bool> seen(stage->world.object_count(), false);
    for (const double offset : {0.0, 1e3, 1e5, 1e7}) {
        Random random(options.seed);
        SceneCounts counts;
        for (int view = 0; counts.rays < options.trials; ++view) {
            if (view % kThingsEvery == 0) move(random, offset, *stage);
            look(random, *stage, visible, seen, counts);
        }
        char claim[240];
        std::snprintf(claim, sizeof claim,
                      "%s%s, %zu objects, offset %g: of %llu rays that witness an object none has it culled "
                      "(%.1f %% of the objects in view hidden)",
                      name.substr(name.find_last_of('/') + 1).c_str(), level.c_str(), stage->world.object_count(),
                      offset, static_cast<unsigned long long>(counts.witnesses),
                      100.0 * static_cast<double>(counts.hidden) /
                          static_cast<double>(std::max<std::uint64_t>(1, counts.in_view)));
        rows.push_back(none_row(claim, "docs/notes/occlude.md", counts.witnesses, counts.culled));
    }
    return rows;
}

std::vector<VerifyRow> verify_occlude(const VerifyOptions& options) {
    auto rows = verify_occluded_scene("town", {}, options);
    if (rows) return std::move(*rows);
    return {untried_row("the town: " + rows.error().message, "docs/notes/occlude.md")};
}

}  // namespace crofton::cli
