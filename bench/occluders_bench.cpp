// SPDX-License-Identifier: MIT
// Occluders: found in all objects of the generated town on one core, chosen among 10,000 candidates.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <crofton/crofton.hpp>
#include <crofton/occlude/occluder.hpp>
#include <crofton/occlude/occlusion.hpp>
#include <cstdio>
#include <ctime>
#include <map>
#include <random>
#include <vector>

#include "assets/scene_source.hpp"
#include "simd_target.hpp"

using namespace crofton;
using namespace crofton::occlude;
using namespace crofton::bench;

namespace {

// Each kind of object once: meshes on one node make one.
void find_in_town() {
    auto source = *assets::make_town({});
    source.scene.update();
    const scene::Scene& scene = source.scene;
    std::map<scene::NodeId, std::vector<scene::MeshId>> parts;
    for (scene::InstanceId i = 0; i < scene.instance_count(); ++i) parts[scene.node_of(i)].push_back(scene.mesh_of(i));
    std::map<std::vector<scene::MeshId>, TriangleMesh> kinds;
    for (const auto& [node, meshes] : parts)
        if (TriangleMesh& kind = kinds[meshes]; kind.indices.empty())
            for (const scene::MeshId m : meshes) append(kind, scene.mesh(m));
    std::size_t triangles = 0, occluders = 0;
    double shadow = 0.0, covered = 0.0;
    const std::clock_t begin = std::clock();
    for (const auto& [meshes, mesh] : kinds) {
        const auto found = find_occluders(mesh);
        triangles += mesh.triangle_count();
        if (!found) continue;
        occluders += found->occluders.size();
        shadow += found->mean_shadow;
        covered += found->covered;
    }
    const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    std::printf(
        "find: town, %zu objects, %zu triangles: %zu occluders, %.1f %% of the mean shadow, %.3f s of one core\n",
        kinds.size(), triangles, occluders, 100.0 * covered / shadow, seconds);
}

// 10,000 boxes around the eye; with least_cover 0 all in view are sorted.
void choose_candidates(std::size_t count, bool all) {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    OccluderCandidates candidates;
    Aabb bounds;
    for (std::size_t i = 0; i < count; ++i) {
        Obb box;
        box.center = 200.0 * glm::dvec3(unit(random), 0.05 * unit(random), unit(random));
        box.half_extents = glm::vec3(glm::dvec3(2.0 + unit(random), 3.0 + unit(random), 2.0 + unit(random)));
        bounds.include(box.center);
        if (!candidates.add(candidate_of(box))) return;
    }
    Camera camera;
    if (all) {
        camera.projection = Projection::orthographic;
        camera.position = {0, 0, 500};
        camera.height = 1000.0;
        camera.far_distance = 2000.0;
    }
    OccluderChoice choice;
    const ChooseBudget budget{.least_cover = all ? 0.0f : 2e-5f, .objects = bounds};
    std::vector<double> times;
    for (int k = 0; k < 200; ++k) {
        const auto begin = std::chrono::steady_clock::now();
        if (!choose_occluders(candidates, camera, budget, choice)) return;
        times.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    }
    std::sort(times.begin(), times.end());
    std::printf("choose: %zu candidates, %s (%zu worth sorting), %zu chosen: median %.1f us, least %.1f us\n", count,
                all ? "all in view" : "street view", choice.order.size(), choice.ids.size(),
                1e6 * times[times.size() / 2], 1e6 * times[0]);
}

struct Thing {
    ObjectHandle object;
    MeshHandle mesh;
};

// An update in which all objects of the town that have occluders move.
void move_all(World& world, const std::map<std::uint32_t, Thing>& things) {
    std::vector<ObjectHandle> objects;
    std::size_t occluders = 0;
    for (const auto& [index, thing] : things) {
        const std::size_t own = world.occluders_of(thing.mesh).size();
        occluders += own;
        if (own > 0) objects.push_back(thing.object);
    }
    double least = 1e9;
    for (int k = 0; k < 30; ++k) {
        for (const ObjectHandle object : objects) {
            Transform transform = *world.transform_of(object);
            transform.translation.y += k % 2 ? 0.01 : -0.01;
            (void)world.set_transform(object, transform);
        }
        const auto begin = std::chrono::steady_clock::now();
        (void)world.update();
        least = std::min(least, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    }
    std::printf("update: town, %zu objects with %zu occluders move: %.1f us\n", objects.size(), occluders, 1e6 * least);
}

// World::view along the town's street, with occlusion and without: the least times, in turns.
void view_street() {
    auto source = *assets::make_town({});
    source.scene.update();
    const scene::Scene& scene = source.scene;
    std::map<scene::NodeId, std::vector<scene::MeshId>> parts;
    for (scene::InstanceId i = 0; i < scene.instance_count(); ++i) parts[scene.node_of(i)].push_back(scene.mesh_of(i));
    World world{{.pairs = false, .updates_to_rest = 1}};
    std::map<std::vector<scene::MeshId>, MeshHandle> meshes;
    std::map<std::uint32_t, Thing> things;  // by the object's index
    for (const auto& [node, ids] : parts) {
        MeshHandle& mesh = meshes[ids];
        if (mesh.is_null()) {
            TriangleMesh all;
            for (const scene::MeshId id : ids) append(all, scene.mesh(id));
            mesh = *world.add_mesh(
                {.positions = all.positions, .indices = all.indices, .triangles = false, .occluders = true});
        }
        const ObjectHandle object = *world.add({.mesh = mesh, .transform = scene.world(node)});
        things[object.index] = {object, mesh};
    }
    for (int k = 0; k < 4; ++k) (void)world.update();
    Camera camera;
    camera.aspect = 16.0 / 9.0;
    camera.fov_y = 1.0;
    camera.near_distance = 0.1;
    camera.far_distance = 2000.0;
    double with = 0.0, without = 0.0, draw = 0.0, worst = 0.0;
    std::size_t drawn = 0, patches = 0, triangles = 0, seen = 0, in_view = 0;
    ViewResult visible, in_frustum;
    Vector<OccluderRef> occluders;
    const std::size_t legs = source.walk.size();
    for (std::size_t leg = 0; leg < legs; ++leg) {
        camera.position = 0.5 * (source.walk[leg] + source.walk[(leg + 1) % legs]);
        camera.forward = source.walk[(leg + 1) % legs] - source.walk[leg];
        double least[3] = {1e9, 1e9, 1e9};
        for (int k = 0; k < 30; ++k) {
            const auto timed = [&](double& to, const auto& work) {
                const auto begin = std::chrono::steady_clock::now();
                work();
                to = std::min(to, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
            };
            timed(least[0], [&] { (void)world.view({.camera = camera, .occlusion = OcclusionOptions{}}, visible); });
            timed(least[1], [&] { (void)world.view({.camera = camera}, in_frustum); });
        }
        (void)world.drawn_occluders(visible, occluders);
        occlude::OccluderSet set;
        for (const OccluderRef& ref : occluders) {
            const FoundOccluder& found = world.occluders_of(things[ref.object.index].mesh)[ref.place];
            const bool patch = found.kind == OccluderKind::patch;
            patches += patch;
            const auto shape =
                patch ? set.add_surface(found.surface, found.sides) : set.add_convex(found.surface.positions);
            (void)set.place(*shape, *world.transform_of(ref.object));
        }
        auto buffer = *OcclusionBuffer::create(OcclusionOptions{}.size);
        const auto view = *occlusion_view_of(camera);
        for (int k = 0; k < 30; ++k) {
            const auto begin = std::chrono::steady_clock::now();
            buffer.draw(set, view);
            least[2] =
                std::min(least[2], std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
        }
        with += least[0], without += least[1], draw += least[2];
        worst = std::max(worst, least[0]);
        drawn += occluders.size(), triangles += buffer.statistics().triangles_drawn;
        seen += visible.size(), in_view += in_frustum.size();
    }
    const auto n = static_cast<double>(legs);
    const auto mean = [n](std::size_t count) { return static_cast<double>(count) / n; };
    std::printf(
        "view: town, means of %zu places in the street: %.0f occluders drawn, %.0f of them patches, %.0f triangles one "
        "by one; %.0f of %.0f objects seen; with occlusion %.1f us (worst place %.1f), without %.1f us, drawing %.1f "
        "us\n",
        legs, mean(drawn), mean(patches), mean(triangles), mean(seen), mean(in_view), 1e6 * with / n, 1e6 * worst,
        1e6 * without / n, 1e6 * draw / n);
    move_all(world, things);
}

}  // namespace

int main(int argc, char** argv) {
    if (!take_target_option(argc, argv)) return 1;
    std::printf("Instruction set: %s\n", target_in_use());
    find_in_town();
    choose_candidates(10'000, false);
    choose_candidates(10'000, true);
    view_street();
    return 0;
}
