// SPDX-License-Identifier: MIT
// Occluders: found in all objects of the generated town on one core, chosen among 10,000 candidates.
#include <algorithm>
#include <chrono>
#include <cmath>
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

}  // namespace

int main(int argc, char** argv) {
    if (!take_target_option(argc, argv)) return 1;
    std::printf("Instruction set: %s\n", target_in_use());
    find_in_town();
    choose_candidates(10'000, false);
    choose_candidates(10'000, true);
    return 0;
}
