// SPDX-License-Identifier: MIT
// Rays through sample centres, asked of a World: what they meet first is listed.
#include <crofton/crofton.hpp>

#include <doctest/doctest.h>

#include <cstdlib>
#include <glm/matrix.hpp>

#include "depth_scenes.hpp"

namespace crofton::testing {
namespace {

// CROFTON_WITNESS_RAYS=100000000 asks for so many (`.ci/long depth`).
std::uint64_t wanted_rays() {
    const char* const text = std::getenv("CROFTON_WITNESS_RAYS");
    return text != nullptr ? std::strtoull(text, nullptr, 10) : 300'000;
}

struct Met {
    std::uint32_t object = ~0u, triangle = ~0u;
    bool operator==(const Met&) const = default;
};

// The first triangle along the ray of a place in the picture, in front of the near plane and before the far one. A back
// face that is not drawn ends it too.
class RayView {
  public:
    RayView(const Scene& scene, const Camera& camera, std::uint32_t width, std::uint32_t height)
        : scene_(scene), size_(width, height), from_clip_(glm::inverse(world_to_clip(camera))) {
        std::vector<MeshHandle> meshes;
        for (const CutMesh& mesh : scene.meshes)
            meshes.push_back(world_.add_mesh({.positions = mesh.mesh.positions, .indices = mesh.mesh.indices}).value());
        for (std::uint32_t i = 0; i < scene.objects.size(); ++i) {
            const PlacedMesh& o = scene.objects[i];
            std::size_t mesh = 0;
            while (&scene.meshes[mesh] != o.mesh) ++mesh;
            const Transform place{glm::dmat3(o.world), glm::dvec3(o.world[3])};
            world_.add({.mesh = meshes[mesh], .transform = place, .user = i}).value();
        }
        world_.update().value();
    }

    [[nodiscard]] Met first(const glm::dvec2& pixel) const {
        const glm::dvec2 at = 2.0 * pixel / size_ - 1.0;
        const glm::dvec3 near = point(at, 1.0), ahead = point(at, 0.5);
        const auto hit = world_.raycast({near, glm::normalize(ahead - near)});
        if (!hit) return {};
        const auto object = static_cast<std::uint32_t>(hit->user);
        return {object, hit->triangle};
    }
    // Whether the triangle is drawn from there: its front, where it is one-sided.
    [[nodiscard]] bool is_drawn(const Met& met, const glm::mat4& to_clip) const {
        const PlacedMesh& o = scene_.objects[met.object];
        if (!o.one_sided) return true;
        glm::dvec4 c[3];
        for (std::uint32_t k = 0; k < 3; ++k)
            c[k] = glm::dmat4(to_clip) *
                   glm::dvec4(o.mesh->mesh.positions[o.mesh->mesh.indices[3 * met.triangle + k]], 1.0);
        return glm::determinant(
                   glm::dmat3({c[0].x, c[0].y, c[0].w}, {c[1].x, c[1].y, c[1].w}, {c[2].x, c[2].y, c[2].w})) > 0.0;
    }
    [[nodiscard]] bool is_before_far(const Met& met, const glm::mat4& to_clip) const {
        const PlacedMesh& o = scene_.objects[met.object];
        for (std::uint32_t k = 0; k < 3; ++k) {
            const glm::vec4 c =
                to_clip * glm::vec4(o.mesh->mesh.positions[o.mesh->mesh.indices[3 * met.triangle + k]], 1.0f);
            if (c.z < 0.0f) return false;
        }
        return true;
    }

  private:
    [[nodiscard]] glm::dvec3 point(const glm::dvec2& at, double nearness) const {
        const glm::dvec4 p = from_clip_ * glm::dvec4(at, nearness, 1.0);
        return glm::dvec3(p) / p.w;
    }

    const Scene& scene_;
    glm::dvec2 size_;
    glm::dmat4 from_clip_;
    World world_;
};

TEST_CASE("the triangles that rays through sample centres hit first are listed") {
    std::uint64_t rays = 0, hits = 0, beside = 0, lost = 0;
    depth::DepthCuller culler;
    for (std::uint64_t seed = 1; rays < wanted_rays(); ++seed) {
        CAPTURE(seed);
        oracle::NearMisses random(60'000 + seed);
        const Scene scene = random_scene(random);
        Camera camera = random_camera(random);
        const auto width = static_cast<std::uint32_t>(64 + random.index(200));
        const auto height = static_cast<std::uint32_t>(40 + random.index(120));
        camera.aspect = double(width) / height;
        std::vector<depth::DepthObject> objects;
        std::vector<std::vector<char>> listed;
        for (const PlacedMesh& o : scene.objects) {
            const glm::mat4 to_clip(world_to_clip(camera) * o.world);
            objects.push_back({&o.mesh->clusters, to_clip, o.one_sided, o.hides, 0.0f});
            listed.emplace_back(o.mesh->mesh.triangle_count(), 0);
        }
        const auto found = culler.find_visible(objects, {width, height});
        REQUIRE(found);
        for (const depth::VisibleCluster& c : *found)
            for (std::uint32_t k = 0; k < 64; ++k)
                if (c.triangles >> k & 1)
                    listed[c.object][objects[c.object].mesh->clusters()[c.cluster].first_triangle + k] = 1;
        const RayView view(scene, camera, width, height);
        for (std::uint32_t y = 0; y < height; ++y)
            for (std::uint32_t x = 0; x < width; ++x, ++rays) {
                const glm::dvec2 center(x + 0.5, y + 0.5);
                const Met met = view.first(center);
                if (met.object == ~0u) continue;
                ++hits;
                if (listed[met.object][met.triangle] != 0) continue;
                const glm::mat4& to_clip = objects[met.object].to_clip;
                if (!view.is_drawn(met, to_clip) || !view.is_before_far(met, to_clip)) continue;
                // A witness if the rays around it meet the same: a renderer's grid cannot take it away.
                bool witness = true;
                for (const glm::dvec2& aside :
                     {glm::dvec2(1, 1), glm::dvec2(-1, 1), glm::dvec2(1, -1), glm::dvec2(-1, -1)})
                    witness = witness && view.first(center + aside / 128.0) == met;
                (witness ? lost : beside) += 1;
            }
        CHECK(lost == 0);
    }
    CHECK(hits > rays / 4);
    MESSAGE(rays, " rays, ", hits, " hits; lost ", lost, "; unlisted beside an edge ", beside);
}

}  // namespace
}  // namespace crofton::testing
