// SPDX-License-Identifier: MIT
// The examples of docs/notes/occluder_finding.md.
#include <doctest/doctest.h>
#include <crofton/occlude/occluder.hpp>
#include <crofton/occlude/occlusion.hpp>
#include <vector>

#include "view/occlude/found_bodies.hpp"

namespace {

void report(const crofton::Error&) {}

void add_occluders(const crofton::TriangleMesh& mesh, const std::vector<crofton::Transform>& places,
                   crofton::occlude::OccluderSet& set, crofton::occlude::OccluderCandidates& candidates) {
    // clang-format off
const auto found = crofton::occlude::find_occluders(mesh);
if (!found) return report(found.error());
for (const crofton::occlude::FoundOccluder& occluder : found->occluders) {
    const auto shape = occluder.kind == crofton::occlude::OccluderKind::patch
                           ? set.add_surface(occluder.surface, occluder.sides)
                           : set.add_convex(occluder.surface.positions);
    if (!shape) return report(shape.error());
    for (const crofton::Transform& place : places) {
        // Both number what they are given 0, 1, 2, …
        (void)set.place(*shape, place);
        (void)candidates.add(candidate_of(occluder, place));
    }
}
    // clang-format on
}

}  // namespace

TEST_SUITE("occlude/finding_guide") {
    TEST_CASE("occluders are found, placed, chosen and drawn") {
        using namespace crofton;
        std::vector<Transform> places(3);
        for (std::size_t k = 0; k < 3; ++k) places[k].translation = {4.0 * static_cast<double>(k), 0, -20};
        occlude::OccluderSet set;
        occlude::OccluderCandidates candidates;
        add_occluders(testing::box_mesh(glm::vec3(-1), glm::vec3(1)), places, set, candidates);
        REQUIRE(set.size() == 3);
        REQUIRE(candidates.size() == 3);
        for (occlude::OccluderId id = 0; id < 3; ++id) REQUIRE(set.set_enabled(id, false).has_value());
        occlude::OcclusionBuffer buffer = *occlude::OcclusionBuffer::create();
        occlude::OccluderChoice choice;
        const Camera camera;
        const Aabb scene_bounds{glm::dvec3(-30), glm::dvec3(30)};
        // clang-format off
for (const std::uint32_t id : choice.ids) (void)set.set_enabled(id, false);  // of the frame before
if (choose_occluders(candidates, camera, {.max_occluders = 400, .objects = scene_bounds}, choice))
    for (const std::uint32_t id : choice.ids) (void)set.set_enabled(id, true);
buffer.draw(set, *crofton::occlude::occlusion_view_of(camera));
        // clang-format on
        CHECK(choice.ids.size() == 3);
        Obb behind;
        behind.center = {0, 0, -25};
        behind.half_extents = glm::vec3(0.5f);
        CHECK(buffer.hides(behind));
        behind.center.x = 2.5;
        CHECK_FALSE(buffer.hides(behind));
    }
}
