// SPDX-License-Identifier: MIT
// What meshes and surfaces cover, in the same bits on every instruction set, and as a loop over pixels found it.
#include <doctest/doctest.h>
#include <hwy/targets.h>
#include <bit>
#include <cmath>
#include <crofton/occlude/occlusion.hpp>
#include <oracle/occlusion_scenes.hpp>

using namespace crofton;
using namespace crofton::test;

namespace {

// A bumpy grid of n × n squares in [-1, 1]², open, or closed by a second one below it.
TriangleMesh bumpy_sheet(Random& random, std::uint32_t n) {
    TriangleMesh mesh;
    for (std::uint32_t i = 0; i <= n; ++i)
        for (std::uint32_t j = 0; j <= n; ++j) {
            const double x = 2.0 * i / n - 1.0, y = 2.0 * j / n - 1.0, z = 0.2 * random.uniform(-1.0, 1.0);
            mesh.positions.push_back({static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)});
        }
    for (std::uint32_t i = 0; i < n; ++i)
        for (std::uint32_t j = 0; j < n; ++j) {
            if (n > 2 && pick(random, 16) == 0) continue;  // a hole
            const std::uint32_t a = i * (n + 1) + j, b = a + 1, c = a + n + 1, d = c + 1;
            for (const std::uint32_t k : {a, c, b, b, c, d}) mesh.indices.push_back(k);
        }
    return mesh;
}

struct MeshScene {
    occlude::OccluderSet set;
    Camera camera;
    occlude::BufferSize size;
};

// Sheets of one to a thousand triangles, from below a pixel to beyond the picture, some across the near plane, mirrored
// or sheared.
MeshScene mesh_scene(std::uint64_t seed) {
    Random random(seed);
    const double offset = seed % 3 == 0 ? 1e5 : 0.0;
    MeshScene scene;
    scene.camera = camera_at(random, offset);
    const auto width = static_cast<std::uint32_t>(8 + pick(random, 200));
    scene.size = {width, static_cast<std::uint32_t>(8 + pick(random, 120))};
    for (int i = 0; i < 6; ++i) {
        const std::uint32_t n = 1u << pick(random, 5);
        // One draw after the other: in which order arguments are computed is left to the compiler.
        const occlude::Sides sides = pick(random, 2) ? occlude::Sides::both : occlude::Sides::front;
        const auto shape = scene.set.add_surface(bumpy_sheet(random, n), sides);
        REQUIRE(shape.has_value());
        Transform transform;
        const int octave = static_cast<int>(pick(random, 10));
        const double size = std::ldexp(0.02 + 0.02 * random.uniform(), octave);
        transform.linear = size * sampling::rotation(random.point<3>());
        if (pick(random, 4) == 0) transform.linear[0] *= -0.5;
        transform.translation =
            point_in_view(random, scene.camera, 0.3 * scene.camera.near_distance + 20.0 * random.uniform());
        REQUIRE(scene.set.place(*shape, transform).has_value());
    }
    return scene;
}

std::uint64_t digest_of(const MeshScene& scene, std::uint64_t& covered) {
    auto buffer = *occlude::OcclusionBuffer::create(scene.size);
    buffer.draw(scene.set, *occlude::occlusion_view_of(scene.camera));
    covered += buffer.count_covered();
    std::uint64_t digest = 14695981039346656037u;
    for (std::uint32_t y = 0; y < scene.size.height; ++y)
        for (std::uint32_t x = 0; x < scene.size.width; ++x)
            digest = (digest ^ std::bit_cast<std::uint32_t>(buffer.nearness(x, y))) * 1099511628211u;
    return digest;
}

std::uint64_t digest_of_all(std::uint64_t& covered) {
    std::uint64_t digest = 0;
    for (std::uint64_t seed = 0; seed < 150; ++seed)
        digest = std::rotl(digest, 7) ^ digest_of(mesh_scene(seed), covered);
    return digest;
}

}  // namespace

TEST_SUITE("occlude/mesh_pixels") {
    // The number was taken from a loop that went through the pixels one by one, in double.
    TEST_CASE("every instruction set covers the pixels that a plain loop covers, at the same depths") {
        for (std::int64_t rest = hwy::SupportedTargets(); rest != 0; rest &= rest - 1) {
            hwy::SetSupportedTargetsForTest(rest & -rest);
            CAPTURE(hwy::TargetName(rest & -rest));
            std::uint64_t covered = 0;
            CHECK(digest_of_all(covered) == 0xff56c951f40676a0u);
            CHECK(covered > 100'000);
        }
        hwy::SetSupportedTargetsForTest(0);
    }
}
