// SPDX-License-Identifier: MIT
// A proof in rationals for what the culler drops.
#include <crofton/depth/depth_culler.hpp>

#include <doctest/doctest.h>
#include <hwy/targets.h>

#include <cstdlib>
#include <limits>
#include <oracle/depth_certificate.hpp>

#include "hostile_scenes.hpp"
#include "owner_check.hpp"

namespace crofton::testing {
namespace {

using depth::DepthObject;
using oracle::DepthCertificate;

// CROFTON_CERTIFICATES=100000 asks for so many (`.ci/long depth`).
std::uint64_t wanted_proofs() {
    const char* const text = std::getenv("CROFTON_CERTIFICATES");
    return text != nullptr ? std::strtoull(text, nullptr, 10) : 2000;
}

// Whether the first corner is in the picture: most triangles are far from it.
bool is_in_middle(const oracle::DrawnMesh& mesh, std::uint32_t triangle) {
    const glm::vec4 p = mesh.to_clip * glm::vec4(mesh.positions[mesh.indices[3 * triangle]], 1.0f);
    return p.w > 0.0f && std::abs(p.x) < p.w && std::abs(p.y) < p.w;
}

struct Proofs {
    std::array<std::uint64_t, 5> of{};  // by DepthCertificate::Proof
    std::uint64_t pixels = 0, pixels_unproved = 0;

    [[nodiscard]] std::uint64_t operator[](DepthCertificate::Proof proof) const {
        return of[static_cast<std::size_t>(proof)];
    }
};

// Proofs for `tries` triangles that the culler drops, and for what it says of the nearness of so many pixels.
void prove(const Scene& scene, const Camera& camera, std::uint32_t width, std::uint32_t height, std::size_t tries,
           std::size_t pixels, oracle::NearMisses& random, depth::DepthCuller& culler, Proofs& proofs) {
    constexpr std::size_t kSamples = 4;
    std::vector<DepthObject> objects;
    std::vector<DepthCertificate::Body> bodies;
    std::vector<std::vector<char>> listed;
    for (const PlacedMesh& o : scene.objects) {
        const glm::mat4 to_clip(world_to_clip(camera) * o.world);
        objects.push_back({&o.mesh->clusters, to_clip, o.one_sided, o.hides, 0.0f});
        bodies.push_back({{o.mesh->mesh.positions, o.mesh->mesh.indices, to_clip, o.one_sided}, o.hides});
        listed.emplace_back(o.mesh->mesh.triangle_count(), 0);
    }
    const auto found = culler.find_visible(objects, {width, height});
    REQUIRE(found);
    for (const depth::VisibleCluster& c : *found)
        for (std::uint32_t k = 0; k < 64; ++k)
            if (c.triangles >> k & 1)
                listed[c.object][objects[c.object].mesh->clusters()[c.cluster].first_triangle + k] = 1;
    const DepthCertificate certificate(bodies, width, height);
    for (std::size_t i = 0; i < tries; ++i) {
        const auto object = random.index(static_cast<unsigned>(objects.size()));
        const auto triangle = random.index(static_cast<unsigned>(listed[object].size()));
        if (listed[object][triangle] != 0) continue;
        if (!is_in_middle(bodies[object].mesh, triangle) && random.index(50) != 0) continue;
        CAPTURE(object);
        CAPTURE(triangle);
        const DepthCertificate::Proof proof = certificate.prove(object, triangle, kSamples);
        CHECK(proof != DepthCertificate::Proof::none);
        ++proofs.of[static_cast<std::size_t>(proof)];
    }
    for (std::size_t i = 0; i < pixels; ++i) {
        const std::uint32_t x = random.index(width), y = random.index(height);
        const float nearness = culler.nearness(x, y);
        if (nearness == -std::numeric_limits<float>::infinity()) continue;
        CAPTURE(x);
        CAPTURE(y);
        const bool proved = certificate.is_at_least(x, y, double(nearness));
        CHECK(proved);
        ++proofs.pixels;
        proofs.pixels_unproved += !proved;
    }
}

void report(const Proofs& p) {
    MESSAGE("outside ", p.of[0], ", faces away ", p.of[1], ", no sample ", p.of[2], ", hidden ", p.of[3], ", unproved ",
            p.of[4], "; pixels ", p.pixels, ", unproved ", p.pixels_unproved);
}

TEST_CASE("dropped triangles are proved to own no sample, however a renderer rounds") {
    Proofs proofs;
    depth::DepthCuller culler;
    for (std::uint64_t seed = 1; proofs[DepthCertificate::Proof::hidden] < wanted_proofs(); ++seed) {
        CAPTURE(seed);
        oracle::NearMisses random(40'000 + seed);
        const Scene scene = random_scene(random);
        Camera camera = random_camera(random);
        const auto width = static_cast<std::uint32_t>(64 + random.index(200));
        const auto height = static_cast<std::uint32_t>(40 + random.index(120));
        camera.aspect = double(width) / height;
        prove(scene, camera, width, height, 2000, 0, random, culler, proofs);
    }
    CHECK(proofs[DepthCertificate::Proof::faces_away] > 0);
    report(proofs);
}

// Ten views of a kind: by renderers that round in three ways, and by proofs. A renderer's vertices on the near plane
// may lie many pixels off, where proofs are not tight enough: kinds that reach it go without.
// Returns how many triangles are listed.
std::uint64_t try_hostile(Hostile kind, bool with_proofs) {
    constexpr std::uint64_t kViews = 10;
    Proofs proofs;
    Checked sum;
    depth::DepthCuller culler;
    for (std::uint64_t seed = 1; seed <= kViews; ++seed) {
        CAPTURE(seed);
        oracle::NearMisses random(1000 * static_cast<std::uint64_t>(kind) + seed);
        Scene scene = hostile_scene(kind, random);
        Camera camera = hostile_camera(random);
        const auto width = static_cast<std::uint32_t>(64 + random.index(100));
        const auto height = static_cast<std::uint32_t>(40 + random.index(80));
        camera.aspect = double(width) / height;
        if (random.index(3) == 0) move_far(scene, camera);
        const Checked c = check(scene, camera, width, height, seed, culler, 0x1p-22 * double(std::max(width, height)));
        CHECK(c.lost == 0);
        CHECK(c.too_near == 0);
        sum.owners += c.owners, sum.listed += c.listed, sum.total += c.total;
        if (with_proofs) prove(scene, camera, width, height, 200, 10, random, culler, proofs);
    }
    CHECK(sum.owners > 0);
    CHECK((proofs.pixels > 0) == with_proofs);
    MESSAGE("listed ", sum.listed, ", owners ", sum.owners, ", all ", sum.total);
    if (with_proofs) report(proofs);
    return sum.listed;
}

TEST_CASE("walls one upon the other, or nearly, lose nothing") {
    try_hostile(Hostile::coplanar, true);
}
TEST_CASE("fences at the same depth lose nothing") {
    try_hostile(Hostile::fences, true);
}
TEST_CASE("walls with T-junctions lose nothing") {
    try_hostile(Hostile::t_junctions, true);
}
TEST_CASE("slivers of a hundredth of a degree lose nothing") {
    try_hostile(Hostile::slivers, true);
}
TEST_CASE("triangles without area lose nothing") {
    try_hostile(Hostile::degenerate, true);
}
TEST_CASE("thousands of triangles in a few pixels lose nothing") {
    try_hostile(Hostile::dense, true);
}
TEST_CASE("objects of a millionth and of a million lose nothing") {
    try_hostile(Hostile::sizes, false);
}
TEST_CASE("a near plane through everything loses nothing") {
    try_hostile(Hostile::through_near, false);
}
TEST_CASE("an eye inside of things loses nothing") {
    try_hostile(Hostile::inside, false);
}
TEST_CASE("steep triangles that reach through a wall are listed") {
    try_hostile(Hostile::poking, true);
}
TEST_CASE("needles through the near plane lose nothing, and every instruction set finds the same") {
    std::vector<std::uint64_t> sums;
    for (std::int64_t rest = hwy::SupportedTargets(); rest != 0; rest &= rest - 1) {
        CAPTURE(hwy::TargetName(rest & -rest));
        hwy::SetSupportedTargetsForTest(rest & -rest);
        sums.push_back(try_hostile(Hostile::needles, false));
        hwy::SetSupportedTargetsForTest(0);
        CHECK(sums.back() == sums.front());
    }
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
        oracle::OwnerRenderer renderer(picture, {.wobble = 0.0006, .bias = 1.0 / 256.0}, seed);
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
