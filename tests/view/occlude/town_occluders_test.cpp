// SPDX-License-Identifier: MIT
// Occluders of the generated town: found in all its meshes, chosen at street level, against full information.
#include <doctest/doctest.h>
#include <crofton/cull/classify.hpp>
#include <crofton/occlude/occluder.hpp>
#include <crofton/occlude/occlusion.hpp>
#include <map>

#include "assets/scene_source.hpp"
#include "view/occlude/found_bodies.hpp"
#include "view/occlude/hidden_area.hpp"

using namespace crofton;
using namespace crofton::occlude;
using namespace crofton::testing;

namespace {

struct TownCandidate {
    const FoundOccluder* found;
    scene::NodeId node;
    EyeLimits limits;
};

struct Town {
    assets::SceneSource source;
    // Meshes on one node make one object, as houses of seven parts do: occluders are found in all of them together.
    std::map<std::vector<scene::MeshId>, FoundOccluders> found;
    std::vector<TownCandidate> given;
    OccluderCandidates candidates;
    Aabb bounds;
};

FoundOccluders found_in_parts(const scene::Scene& scene, const std::vector<scene::MeshId>& parts) {
    TriangleMesh mesh;
    for (const scene::MeshId part : parts) append(mesh, scene.mesh(part));
    return *find_occluders(mesh);
}

Town make_candidates() {
    Town town{*assets::make_town({}), {}, {}, {}, {}};
    scene::Scene& scene = town.source.scene;
    scene.update();
    std::map<scene::NodeId, std::vector<scene::MeshId>> parts;
    for (scene::InstanceId i = 0; i < scene.instance_count(); ++i) {
        town.bounds.include(aabb_of(scene.world_boxes()[i]));
        parts[scene.node_of(i)].push_back(scene.mesh_of(i));
    }
    for (const auto& [node, meshes] : parts) {
        if (town.found.find(meshes) == town.found.end()) town.found.emplace(meshes, found_in_parts(scene, meshes));
        for (const FoundOccluder& found : town.found.at(meshes).occluders) {
            const OccluderCandidate candidate = candidate_of(found, scene.world(node));
            REQUIRE(town.candidates.add(candidate).has_value());
            town.given.push_back({&found, node, candidate.limits});
        }
    }
    return town;
}

// The first occluder, then ever the one that hides most that is not hidden yet: what it hides is at least 1 − 1/e of
// the best choice, since gains only fall (Nemhauser, Wolsey, Fisher 1978).
std::size_t greedy_with_full_information(HiddenArea& area, const std::vector<Footprint>& footprints,
                                         std::size_t count) {
    std::vector<std::size_t> bound(footprints.size(), ~std::size_t{0});
    std::size_t sum = 0;
    for (std::size_t round = 0; round < count; ++round) {
        std::size_t best = 0, chosen = footprints.size();
        for (std::size_t i = 0; i < footprints.size(); ++i) {
            if (bound[i] <= best) continue;
            bound[i] = area.gain(footprints[i], false);
            if (bound[i] <= best) continue;
            best = bound[i];
            chosen = i;
        }
        if (chosen == footprints.size()) break;
        sum += area.gain(footprints[chosen], true);
        bound[chosen] = 0;
    }
    area.reset();
    return sum;
}

Camera camera_on_walk(const std::vector<glm::dvec3>& walk, int view, int views) {
    const std::size_t leg = std::size_t(view) % walk.size();
    const glm::dvec3 a = walk[leg], b = walk[(leg + 1) % walk.size()];
    Camera camera;
    camera.position = a + (view < views / 2 ? 0.15 : 0.6) * (b - a);
    camera.forward = b - a;
    return camera;
}

OccluderSet place_all(const Town& town) {
    OccluderSet set;
    std::map<const FoundOccluder*, ShapeId> shapes;
    for (const TownCandidate& c : town.given) {
        if (shapes.find(c.found) == shapes.end())
            shapes[c.found] = c.found->kind == OccluderKind::patch
                                  ? set.add_surface(c.found->surface, c.found->sides).value()
                                  : set.add_convex(c.found->surface.positions).value();
        REQUIRE(set.place(shapes[c.found], town.source.scene.world(c.node)).has_value());
    }
    return set;
}

// Objects that are the nearest in a pixel, by more than a thousandth of the way.
std::vector<bool> owners_of_pixels(const scene::Scene& scene, const Camera& camera, int width, int height) {
    constexpr float kFar = std::numeric_limits<float>::infinity();
    Picture picture(camera, width, height);
    std::vector<std::array<float, 2>> nearest(std::size_t(width * height), {kFar, kFar});
    std::vector<scene::InstanceId> owner(nearest.size(), scene::kNone);
    for (scene::InstanceId i = 0; i < scene.instance_count(); ++i)
        for (const auto& [pixel, depth] :
             picture.draw(scene.mesh(scene.mesh_of(i)), scene.world(scene.node_of(i)), true).pixels) {
            auto& [first, second] = nearest[pixel];
            second = std::min(second, std::max(first, depth));
            if (depth < first) owner[pixel] = i;
            first = std::min(first, depth);
        }
    std::vector<bool> owns(scene.instance_count(), false);
    for (std::size_t p = 0; p < owner.size(); ++p)
        if (owner[p] != scene::kNone && nearest[p][0] < 0.999f * nearest[p][1]) owns[owner[p]] = true;
    return owns;
}

}  // namespace

TEST_SUITE("occlude/town") {
    TEST_CASE("64 occluders chosen by what they cover hide at least 80 % of what 64 chosen with full information do") {
        Town town = make_candidates();
        const scene::Scene& scene = town.source.scene;
        constexpr int kWidth = 160, kHeight = 90, kViews = 8;
        double worst = 1.0, ours_sum = 0.0, best_sum = 0.0;
        for (int v = 0; v < kViews; ++v) {
            const Camera camera = camera_on_walk(town.source.walk, v, kViews);
            Picture picture(camera, kWidth, kHeight);
            HiddenArea area(kWidth * kHeight);
            for (scene::InstanceId i = 0; i < scene.instance_count(); ++i)
                area.add(picture.draw(scene.mesh(scene.mesh_of(i)), scene.world(scene.node_of(i)), true));
            area.finish();
            std::vector<Footprint> footprints;
            for (const TownCandidate& c : town.given)
                footprints.push_back(may_use(c.limits, camera)
                                         ? picture.draw(c.found->surface, scene.world(c.node), true)
                                         : Footprint{});
            OccluderChoice choice;
            const ChooseBudget budget{.max_occluders = 64, .objects = town.bounds};
            REQUIRE(choose_occluders(town.candidates, camera, budget, choice).has_value());
            std::size_t ours = 0;
            for (const std::uint32_t id : choice.ids) ours += area.gain(footprints[id], true);
            area.reset();
            const std::size_t best = greedy_with_full_information(area, footprints, 64);
            MESSAGE("view ", v, ": ours ", ours, ", full information ", best, ", share ", double(ours) / double(best));
            worst = std::min(worst, double(ours) / double(best));
            ours_sum += double(ours);
            best_sum += double(best);
        }
        MESSAGE("candidates ", town.candidates.size(), ", mean share ", ours_sum / best_sum, ", worst ", worst);
        CHECK(ours_sum >= 0.8 * best_sum);
    }

    TEST_CASE("no object that owns a pixel of the street is hidden by the occluders chosen") {
        Town town = make_candidates();
        const scene::Scene& scene = town.source.scene;
        OccluderSet set = place_all(town);
        OcclusionBuffer buffer = *OcclusionBuffer::create();
        constexpr int kViews = 8;
        std::array<std::size_t, 2> in_view{}, owning{}, drawn{}, drawn_without_walled{};  // objects, triangles
        for (int v = 0; v < kViews; ++v) {
            const Camera camera = camera_on_walk(town.source.walk, v, kViews);
            const std::vector<bool> owns = owners_of_pixels(scene, camera, 640, 360);
            OccluderChoice choice;
            REQUIRE(choose_occluders(town.candidates, camera, {.max_occluders = 400, .objects = town.bounds}, choice)
                        .has_value());
            const Frustum frustum = *frustum_of(camera);
            for (const bool with_walled : {false, true}) {
                for (OccluderId id = 0; id < set.size(); ++id) REQUIRE(set.set_enabled(id, false).has_value());
                for (const std::uint32_t id : choice.ids)
                    if (with_walled || town.given[id].found->kind != OccluderKind::walled)
                        REQUIRE(set.set_enabled(id, true).has_value());
                buffer.draw(set, *occlusion_view_of(camera));
                for (scene::InstanceId i = 0; i < scene.instance_count(); ++i) {
                    const Obb& box = scene.world_boxes()[i];
                    if (cull::classify(frustum, box) == cull::Verdict::outside) continue;
                    const bool hidden = buffer.hides(box);
                    CHECK_FALSE((hidden && owns[i]));
                    const std::size_t triangles = scene.mesh(scene.mesh_of(i)).triangle_count();
                    const auto count = [&](std::array<std::size_t, 2>& sum) {
                        sum[0] += 1;
                        sum[1] += triangles;
                    };
                    if (with_walled) count(in_view);
                    if (with_walled && owns[i]) count(owning);
                    if (!hidden) count(with_walled ? drawn : drawn_without_walled);
                }
            }
        }
        MESSAGE("in view ", in_view[0], " objects, ", in_view[1], " triangles; own a pixel ", owning[0], ", ",
                owning[1], "; drawn ", drawn[0], ", ", drawn[1], "; without boxes behind walls ",
                drawn_without_walled[0], ", ", drawn_without_walled[1]);
        CHECK(drawn[1] < drawn_without_walled[1]);
    }
}
