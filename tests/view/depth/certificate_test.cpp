// SPDX-License-Identifier: MIT
// A proof in rationals for what the culler drops.
#include <crofton/depth/depth_culler.hpp>

#include <doctest/doctest.h>

#include <cstdlib>
#include <oracle/depth_certificate.hpp>

#include "depth_scenes.hpp"

namespace crofton::testing {
namespace {

using depth::DepthObject;
using oracle::DepthCertificate;

// CROFTON_CERTIFICATES=100000 asks for so many (`.ci/long depth`).
std::uint64_t wanted_proofs() {
    const char* const text = std::getenv("CROFTON_CERTIFICATES");
    return text != nullptr ? std::strtoull(text, nullptr, 10) : 500;
}

// Whether the first corner is in the picture: most triangles are far from it.
bool is_in_middle(const oracle::DrawnMesh& mesh, std::uint32_t triangle) {
    const glm::vec4 p = mesh.to_clip * glm::vec4(mesh.positions[mesh.indices[3 * triangle]], 1.0f);
    return p.w > 0.0f && std::abs(p.x) < p.w && std::abs(p.y) < p.w;
}

TEST_CASE("what is dropped is proved to own no sample, however a renderer rounds") {
    constexpr std::size_t kSamples = 4, kTrianglesOfView = 2000;
    std::array<std::uint64_t, 5> proofs{};
    std::uint64_t proved = 0;
    depth::DepthCuller culler;
    for (std::uint64_t seed = 1; proved < wanted_proofs(); ++seed) {
        CAPTURE(seed);
        oracle::NearMisses random(40'000 + seed);
        const Scene scene = random_scene(random);
        Camera camera = random_camera(random);
        const auto width = static_cast<std::uint32_t>(64 + random.index(200));
        const auto height = static_cast<std::uint32_t>(40 + random.index(120));
        camera.aspect = double(width) / height;
        std::vector<DepthObject> objects;
        std::vector<DepthCertificate::Body> bodies;
        for (const PlacedMesh& o : scene.objects) {
            const glm::mat4 to_clip(world_to_clip(camera) * o.world);
            objects.push_back({&o.mesh->clusters, to_clip, o.one_sided, o.hides, 0.0f});
            bodies.push_back({{o.mesh->mesh.positions, o.mesh->mesh.indices, to_clip, o.one_sided}, o.hides});
        }
        const auto found = culler.find_visible(objects, {width, height});
        REQUIRE(found);
        std::vector<std::vector<char>> listed;
        for (const PlacedMesh& o : scene.objects) listed.emplace_back(o.mesh->mesh.triangle_count(), 0);
        for (const depth::VisibleCluster& c : *found)
            for (std::uint32_t k = 0; k < 64; ++k)
                if (c.triangles >> k & 1)
                    listed[c.object][objects[c.object].mesh->clusters()[c.cluster].first_triangle + k] = 1;
        const DepthCertificate certificate(bodies, width, height);
        for (std::size_t tries = 0; tries < kTrianglesOfView; ++tries) {
            const auto object = random.index(static_cast<unsigned>(objects.size()));
            const auto triangle = random.index(static_cast<unsigned>(listed[object].size()));
            if (listed[object][triangle] != 0) continue;
            if (!is_in_middle(bodies[object].mesh, triangle) && random.index(50) != 0) continue;
            CAPTURE(object);
            CAPTURE(triangle);
            const DepthCertificate::Proof proof = certificate.prove(object, triangle, kSamples);
            CHECK(proof != DepthCertificate::Proof::none);
            ++proofs[static_cast<std::size_t>(proof)];
            proved += proof == DepthCertificate::Proof::hidden;
        }
    }
    CHECK(proofs[static_cast<std::size_t>(DepthCertificate::Proof::faces_away)] > 0);
    MESSAGE("outside ", proofs[0], ", faces away ", proofs[1], ", no sample ", proofs[2], ", hidden ", proofs[3],
            ", unproved ", proofs[4]);
}

TEST_CASE("there is no proof for what owns a sample") {
    std::uint64_t tried = 0;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        CAPTURE(seed);
        oracle::NearMisses random(50'000 + seed);
        const Scene scene = random_scene(random);
        Camera camera = random_camera(random);
        camera.aspect = 1.5;
        std::vector<DepthCertificate::Body> bodies;
        oracle::OwnerPicture picture(120, 80);
        oracle::OwnerRenderer renderer(picture, 0.0006, seed, 1.0 / 256.0);
        for (std::uint32_t i = 0; i < scene.objects.size(); ++i) {
            const PlacedMesh& o = scene.objects[i];
            bodies.push_back({{o.mesh->mesh.positions, o.mesh->mesh.indices, glm::mat4(world_to_clip(camera) * o.world),
                               o.one_sided},
                              o.hides});
            renderer.draw(bodies.back().mesh, i);
        }
        const DepthCertificate certificate(bodies, 120, 80);
        for (std::size_t p = random.index(97); p < picture.owners.size(); p += 97) {
            const std::uint64_t owner = picture.owners[p];
            if (owner == oracle::OwnerPicture::kNobody) continue;
            const auto object = static_cast<std::uint32_t>(owner >> 32);
            CHECK(certificate.prove(object, static_cast<std::uint32_t>(owner), 10'000) ==
                  DepthCertificate::Proof::none);
            ++tried;
        }
    }
    CHECK(tried > 300);
}

}  // namespace
}  // namespace crofton::testing
