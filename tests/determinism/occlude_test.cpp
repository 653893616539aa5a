// SPDX-License-Identifier: MIT
// Depth buffers, what is hidden, which occluders are found and chosen, in the same bits everywhere.
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/occlude/occlusion.hpp>
#include <glm/geometric.hpp>
#include <oracle/witness_rays.hpp>

#include "crowd.hpp"
#include "digest.hpp"
#include "everywhere.hpp"

using namespace crofton;
using namespace crofton::test;

namespace {

struct HidingScene {
    Camera camera;
    std::vector<Obb> walls, objects;
    TriangleMesh solid;  // a bent block of sixteen boxes' worth of triangles
    occlude::OccluderSet set;
    occlude::OccluderCandidates candidates;
};

// Upright or turned; one draw a statement.
Obb box_between(Random& random, double near, double far, double smallest, double largest) {
    Obb box;
    const double z = random.uniform(near, far), x = random.uniform(-0.8, 0.8), y = random.uniform(-0.5, 0.5);
    box.center = glm::dvec3(1e5, 50.0, -2e4) + glm::dvec3(z * x, z * y, -z);
    if (random.uniform() < 0.5) box.axes = glm::mat3(sampling::rotation(random.point<3>()));
    for (int k = 0; k < 3; ++k) box.half_extents[k] = static_cast<float>(random.uniform(smallest, largest));
    return box;
}

// A closed tube along z with n sides, bent.
TriangleMesh tube() {
    TriangleMesh mesh;
    constexpr std::uint32_t kSides = 8, kRings = 9;
    constexpr float kCorners[kSides][2] = {{1, 0},  {0.7f, 0.7f},   {0, 1},  {-0.7f, 0.7f},
                                           {-1, 0}, {-0.7f, -0.7f}, {0, -1}, {0.7f, -0.7f}};
    for (std::uint32_t r = 0; r < kRings; ++r) {
        const float z = static_cast<float>(r) - 4.0f;
        for (const auto& c : kCorners) mesh.positions.push_back({2.0f * c[0] + 0.1f * z * z, 2.0f * c[1], 1.5f * z});
    }
    for (std::uint32_t r = 0; r + 1 < kRings; ++r)
        for (std::uint32_t s = 0; s < kSides; ++s) {
            const std::uint32_t a = r * kSides + s, b = r * kSides + (s + 1) % kSides;
            for (const std::uint32_t i : {a, b, b + kSides, a, b + kSides, a + kSides}) mesh.indices.push_back(i);
        }
    const std::uint32_t last = (kRings - 1) * kSides;
    for (std::uint32_t s = 1; s + 1 < kSides; ++s) {
        for (const std::uint32_t i : {0u, s + 1, s}) mesh.indices.push_back(i);
        for (const std::uint32_t i : {last, last + s, last + s + 1}) mesh.indices.push_back(i);
    }
    return mesh;
}

HidingScene hiding_scene(std::uint64_t seed) {
    HidingScene scene;
    Random random(seed);
    scene.camera.position = {1e5, 50.0, -2e4};
    scene.camera.far_distance = 500.0;
    for (int i = 0; i < 120; ++i) {
        scene.walls.push_back(box_between(random, 8.0, 60.0, 0.3, 4.0));
        (void)scene.set.place(scene.walls.back());
        (void)scene.candidates.add(occlude::candidate_of(scene.walls.back()));
    }
    for (int i = 0; i < 3000; ++i) scene.objects.push_back(box_between(random, 5.0, 120.0, 0.05, 0.6));
    scene.solid = tube();
    return scene;
}

// With a mesh and a surface among the occluders.
std::uint64_t hidden_objects(Executor& executor) {
    Digest digest;
    HidingScene scene = hiding_scene(61);
    const auto view = occlude::occlusion_view_of(scene.camera).value();
    const auto mesh = scene.set.add_mesh(scene.solid).value();
    const auto surface = scene.set.add_surface(scene.solid, occlude::Sides::both).value();
    (void)scene.set.place(mesh, {glm::dmat3(1.0), scene.camera.position + glm::dvec3(6.0, 0.0, -20.0)});
    (void)scene.set.place(surface, {glm::dmat3(1.0), scene.camera.position + glm::dvec3(-8.0, 1.0, -25.0)});
    auto buffer = occlude::OcclusionBuffer::create({200, 120}).value();
    buffer.draw(scene.set, view, executor);
    std::vector<float> pixels(200 * 120);
    buffer.read(pixels);
    digest.add(pixels);
    const auto tree = boxtree::BoxTree::build(scene.objects).value();
    occlude::VisibleSet visible;
    occlude::find_visible(tree, buffer, visible);
    digest.add(visible.ids());
    for (const cull::Verdict verdict : visible.verdicts()) digest.add(static_cast<std::uint32_t>(verdict));
    std::vector<std::uint64_t> bits((scene.objects.size() + 63) / 64);
    buffer.find_hidden(scene.objects, bits, executor);
    digest.add(bits);
    cull::BoxSet set;
    set.assign(scene.objects);
    occlude::OcclusionBits verdicts;
    occlude::find_visible(set, scene.objects, buffer, verdicts, cull::CullMode::exact, executor);
    for (std::size_t i = 0; i < scene.objects.size(); ++i) digest.add(static_cast<std::uint32_t>(verdicts.verdict(i)));
    occlude::OccluderChoice choice;
    (void)occlude::choose_occluders(scene.candidates, scene.camera, {.max_occluders = 30}, choice);
    digest.add(choice.ids);
    buffer.draw(scene.set, choice.ids, view, executor);
    buffer.read(pixels);
    digest.add(pixels);
    return digest.value();
}

std::uint64_t found_occluders(std::uint32_t level_triangles) {
    Digest digest;
    for (const occlude::Sides sides : {occlude::Sides::front, occlude::Sides::both}) {
        const occlude::FindOptions how{
            .sides = sides, .max_patch_triangles = 1000, .level_triangles = level_triangles, .grid = 12};
        const auto found = occlude::find_occluders(tube(), how).value();
        for (const occlude::FoundOccluder& o : found.occluders) {
            digest.add(static_cast<std::uint32_t>(o.kind)).add(o.mean_shadow).add(o.gain).add(o.edges);
            digest.add(o.surface.positions).add(o.surface.indices).add(o.piece_bounds);
        }
        digest.add(found.covered).add(found.mean_shadow);
    }
    return digest.value();
}

}  // namespace

TEST_SUITE("determinism/occlude") {
    TEST_CASE("depth, verdicts and chosen occluders are the same bits everywhere") {
        check_everywhere(0x5de7f886acfe17c0, hidden_objects);
    }

    TEST_CASE("found occluders are the same bits everywhere") {
        check_everywhere(0x32876e14f8b86dc6, [](Executor&) { return found_occluders(0); });
    }

    TEST_CASE("the surfaces of a level are the same bits everywhere") {
        check_everywhere(0x85a12723398ec9cd, [](Executor&) { return found_occluders(20); });
    }

    TEST_CASE("the published answer hides nothing that a ray reaches, in rationals") {
        const HidingScene scene = hiding_scene(61);
        auto buffer = occlude::OcclusionBuffer::create({200, 120}).value();
        buffer.draw(scene.set, occlude::occlusion_view_of(scene.camera).value());
        std::size_t hidden = 0;
        for (const Obb& object : scene.objects) {
            if (!buffer.hides(object)) continue;
            ++hidden;
            for (const glm::dvec3& corner : corners(object)) {
                const double t_near = 0.1 / (scene.camera.position.z - corner.z);
                CHECK_FALSE(oracle::is_free({scene.camera.position, corner, t_near}, scene.walls));
            }
        }
        CHECK(hidden > 300);
    }
}
