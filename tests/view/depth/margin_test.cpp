// SPDX-License-Identifier: MIT
// Each margin of docs/notes/depth.md is needed in one of these tests: without it, samples are lost.
#include <crofton/depth/depth_culler.hpp>

#include <doctest/doctest.h>

#include "margin_scenes.hpp"
#include "owner_check.hpp"

namespace crofton::testing {
namespace {

// A scene of aimed meshes.
struct Aim {
    oracle::NearMisses& random;
    MarginScenes meshes;
    Scene scene = {};
    glm::dmat4 to_clip = MarginScenes::flat();
    double most_offset = 0.0;  // from the origin of a mesh's coordinates; 0: none

    void add(TriangleMesh mesh, std::uint32_t triangles_in_cluster) {
        glm::dmat4 placed = to_clip;
        if (most_offset > 0.0 && random.index(4) != 0) meshes.offset(mesh, placed, 1e-3 * most_offset, most_offset);
        scene.meshes.emplace_back(std::move(mesh), triangles_in_cluster);
        const bool one_sided = random.index(3) == 0;
        scene.objects.push_back({&scene.meshes.back(), placed, one_sided});
    }
    std::uint32_t some_size() { return 1 + random.index(64); }
    void offset(double most) { most_offset = meshes.some(4.0, most); }
};

// Pictures of `least` to `most` pixels each way. A renderer may round a vertex's clip coordinates, its place in the
// picture and depth by as much as the notes say.
template <class Build>
void try_aimed(std::uint64_t count, std::uint32_t least, std::uint32_t most, const Build& build,
               std::uint32_t samples = 1) {
    depth::DepthCuller culler;
    std::uint64_t lost = 0, too_near = 0, owners = 0;
    for (std::uint64_t seed = 1; seed <= count; ++seed) {
        oracle::NearMisses random(70'000 + seed);
        const std::uint32_t width = least + random.index(most - least + 1);
        const std::uint32_t height = least + random.index(most - least + 1);
        Aim aim{random, MarginScenes(width, height, random)};
        build(aim);
        oracle::Rounding rounding{
            .wobble = 0x1p-22 * std::max(width, height), .clip_share = 0x1p-22, .depth_share = 0x1p-22};
        std::vector<oracle::Rounding> roundings = {{}, rounding};
        rounding.bias = 1.0 / 256.0;
        roundings.push_back(rounding);
        rounding.snaps_plane = false;
        roundings.push_back(rounding);
        const Checked c = check(aim.scene, glm::dmat4(1.0), width, height, seed, culler, roundings, samples);
        if (c.lost + c.too_near > 0) MESSAGE("seed ", seed, ": lost ", c.lost, ", too near ", c.too_near);
        lost += c.lost, too_near += c.too_near, owners += c.owners;
    }
    CHECK(lost == 0);
    CHECK(too_near == 0);
    CHECK(owners > count);
}

TEST_SUITE("depth/margins") {
    TEST_CASE("a triangle that barely reaches through a wall is listed") {
        const auto build = [](Aim& aim) {
            const double z = aim.random.number(0.1, 0.9);
            aim.add(aim.meshes.wall(z, 0.0), 0);
            for (int i = 0; i < 19; ++i) aim.add(aim.meshes.specks(z, 1), 1);
        };
        try_aimed(2000, 8, 40, build);
        try_aimed(2000, 8, 40, [&](Aim& aim) {
            aim.offset(1e6);
            build(aim);
        });
    }

    TEST_CASE("a triangle that barely covers a sample is listed") {
        const auto build = [](Aim& aim) { aim.add(aim.meshes.specks(0.5, 60), aim.some_size()); };
        try_aimed(1000, 8, 40, build);
        try_aimed(1000, 8, 40, [&](Aim& aim) {
            aim.offset(1e6);
            build(aim);
        });
    }

    TEST_CASE("surfaces whose corners and edges lie at samples hide no more than they cover") {
        const auto build = [](Aim& aim) {
            for (int i = 0; i < 6; ++i) {
                const double deep = i % 2 == 0 ? 0.3 : 0.02;
                aim.add(aim.random.index(2) == 0 ? aim.meshes.fan(deep) : aim.meshes.patch(deep),
                        aim.random.index(2) == 0 ? 64 : aim.some_size());
            }
        };
        try_aimed(3000, 8, 40, build);
        try_aimed(1000, 8, 40, [&](Aim& aim) {
            aim.offset(1e6);
            build(aim);
        });
    }

    TEST_CASE("a corner at a sample hides no more than the steepest triangle around it covers") {
        try_aimed(1000, 8, 40, [](Aim& aim) {
            for (int i = 0; i < 6; ++i) aim.add(aim.meshes.crown(), 64);
        });
    }

    TEST_CASE("two triangles nearly in one plane, which are drawn as one, hide no more than they cover") {
        try_aimed(4000, 8, 40, [](Aim& aim) {
            if (aim.random.index(4) == 0) aim.offset(1e6);
            for (int i = 0; i < 6; ++i) aim.add(aim.meshes.bent_square(), 64);
        });
    }

    TEST_CASE("needles around a corner do not close an edge far away from it") {
        try_aimed(5000, 8, 40, [](Aim& aim) {
            for (int i = 0; i < 6; ++i) aim.add(aim.meshes.fan(0.0), 64);
        });
    }

    TEST_CASE("a surface full of holes at samples hides nothing there") {
        try_aimed(500, 8, 40, [](Aim& aim) {
            for (int i = 0; i < 3; ++i) aim.add(aim.meshes.sieve(), 64);
        });
    }

    TEST_CASE("long needles that are steep along their length hide no more than they cover") {
        try_aimed(500, 8, 40, [](Aim& aim) { aim.add(aim.meshes.long_needles(12), 64); });
    }

    TEST_CASE("triangles that reach a hundred thousand pixels beyond the picture hide no more than they cover") {
        try_aimed(3000, 8, 40, [](Aim& aim) { aim.add(aim.meshes.far_lines(6, aim.meshes.some(10.0, 2e5)), 1); });
    }

    TEST_CASE("depths whose w is a difference of large numbers hide no more than they cover") {
        try_aimed(1000, 8, 40, [](Aim& aim) {
            aim.to_clip = MarginScenes::deep(0.01);
            aim.offset(1e6);
            const double w = aim.meshes.some(0.1, 5.0);
            const auto put = [&](TriangleMesh mesh, double part) {
                aim.meshes.deepen(mesh, w * (1.0 - part), w * (1.0 + part), false);
                aim.add(std::move(mesh), aim.some_size());
            };
            put(aim.meshes.wall(0.5, 0.0), 0.0);
            put(aim.meshes.specks(0.5, 30), 1e-3);
            put(aim.meshes.specks(0.5, 30), 1e-6);
        });
    }

    TEST_CASE("a wall on the near plane, which a renderer may clip, hides nothing") {
        try_aimed(1000, 8, 40, [](Aim& aim) {
            // Depth is the matrix's last column, and nearly nothing else.
            aim.to_clip[2][2] = 0x1p-10;
            aim.to_clip[3][2] = 1.0 - aim.random.index(20) * 0x1p-24;
            TriangleMesh wall = aim.meshes.wall(0.0, 0.0), specks = aim.meshes.specks(0.5, 8);
            for (glm::vec3& p : specks.positions) p.z -= 0.5f;
            aim.add(std::move(wall), 0);
            aim.add(std::move(specks), aim.some_size());
        });
        try_aimed(1000, 8, 40, [](Aim& aim) {
            aim.add(aim.meshes.wall(1.0 - aim.random.index(20) * 0x1p-24, 0.0), 0);
            aim.add(aim.meshes.specks(1.0 - aim.random.index(20) * 0x1p-24, 8), aim.some_size());
        });
    }

    TEST_CASE("triangles through the near plane hide no more than they cover, and are listed") {
        const auto build = [](Aim& aim) {
            const double near = aim.meshes.some(0.01, 1.0);
            aim.to_clip = MarginScenes::deep(near);
            for (int i = 0; i < 12; ++i) aim.add(aim.meshes.through_near(1, near), 1);
            for (int i = 0; i < 3; ++i)
                aim.add(aim.meshes.through_near(2, near), aim.random.index(2) == 0 ? 64 : aim.some_size());
        };
        try_aimed(1000, 8, 40, build);
        try_aimed(1000, 8, 40, [&](Aim& aim) {
            aim.offset(1e6);
            build(aim);
        });
    }

    // A renderer that clips it draws other triangles, whose corners and planes are rounded once more.
    TEST_CASE("a hidden triangle that rounding may move through the near plane is listed, and one before it is not") {
        const float near = 0.1f;
        glm::mat4 to_clip(1.0f);
        to_clip[2] = {0.0f, 0.0f, 0.0f, -1.0f}, to_clip[3] = {0.0f, 0.0f, near, 0.0f};
        TriangleMesh mesh;
        mesh.positions = {{-1, -1, -0.2f}, {3, -1, -0.2f}, {-1, 3, -0.2f}};
        mesh.indices = {0, 1, 2};
        const CutMesh wall(mesh);
        // Both corners on the left are beside the picture; so is all of the triangle that is nearer than the wall.
        const auto listed = [&](float left) {
            mesh.positions = {{0.5f, 0, -left}, {-50, -50, -100}, {-50, 50, -100},   // the one that is asked
                              {2, 0, 1},        {-50, -50, -101}, {-50, 50, -101}};  // surely through the near plane
            mesh.indices = {0, 1, 2, 3, 4, 5};
            const CutMesh behind(mesh, 2, false);
            REQUIRE(behind.clusters.clusters().size() == 1);
            const auto first = static_cast<std::uint32_t>(
                std::find_if(behind.mesh.indices.begin(), behind.mesh.indices.end(), [](auto i) { return i < 3; }) -
                behind.mesh.indices.begin());
            depth::DepthCuller culler;
            const depth::DepthObject objects[] = {{&wall.clusters, to_clip}, {&behind.clusters, to_clip}};
            const auto found = culler.find_visible(objects, {64, 64});
            REQUIRE(found);
            for (const depth::VisibleCluster& c : *found)
                if (c.object == 1) return (c.triangles >> first / 3 & 1) != 0;
            return false;
        };
        // Coordinates are rounded by up to 2^-21 of the sum of their terms: depth's is 0.1, that of w 101.
        const float error = (near + 101.0f) * 0x1p-21f;
        CHECK(listed(near - 2 * error));
        CHECK(listed(near));
        CHECK(listed(near + 0.5f * error));
        CHECK(listed(near + error));
        CHECK(!listed(near + 3 * error));
        CHECK(!listed(2 * near));
    }

    TEST_CASE("surfaces through the near plane, with corners at samples, hide no more than they cover") {
        const auto build = [](Aim& aim) {
            const double near = aim.meshes.some(0.01, 1.0);
            aim.to_clip = MarginScenes::deep(near);
            for (int i = 0; i < 6; ++i) {
                TriangleMesh mesh = aim.random.index(2) == 0 ? aim.meshes.fan(0.3) : aim.meshes.patch(0.3);
                aim.meshes.deepen(mesh, 0.99 * near, 20.0 * near, true);
                aim.add(std::move(mesh), aim.random.index(2) == 0 ? 64 : aim.some_size());
            }
        };
        try_aimed(1000, 8, 40, build);
        try_aimed(1000, 8, 40, [&](Aim& aim) {
            aim.offset(1e6);
            build(aim);
        });
    }

    TEST_CASE("a triangle outside the picture that rounding may move into it is listed") {
        try_aimed(1500, 8, 40, [](Aim& aim) {
            aim.most_offset = 4e6;
            aim.add(aim.meshes.beside(30), aim.random.index(2) == 0 ? 1 : aim.some_size());
        });
    }

    TEST_CASE("a triangle that owns any sample of a multisampled pixel is listed") {
        for (const std::uint32_t samples : {2u, 4u, 8u}) {
            CAPTURE(samples);
            const auto build = [&](Aim& aim) {
                aim.meshes.aim_at(samples_of_pixel(samples)[aim.random.index(samples)]);
                const double z = aim.random.number(0.1, 0.9);
                aim.add(aim.meshes.wall(z, 0.0), 0);
                aim.add(aim.meshes.specks(z, 20), aim.some_size());
                for (int i = 0; i < 3; ++i) aim.add(aim.meshes.fan(0.3), aim.some_size());
                aim.add(aim.meshes.crown(), 64);
            };
            try_aimed(300, 8, 40, build, samples);
            try_aimed(100, 1, 4, build, samples);
            const auto deep = [&](Aim& aim) {
                aim.meshes.aim_at(samples_of_pixel(samples)[aim.random.index(samples)]);
                const double near = aim.meshes.some(0.01, 1.0);
                aim.to_clip = MarginScenes::deep(near);
                aim.add(aim.meshes.through_near(2, near), 1);
                for (int i = 0; i < 3; ++i) {
                    TriangleMesh mesh = aim.random.index(2) == 0 ? aim.meshes.fan(0.3) : aim.meshes.patch(0.3);
                    aim.meshes.deepen(mesh, 0.99 * near, 20.0 * near, true);
                    aim.add(std::move(mesh), aim.some_size());
                }
            };
            try_aimed(200, 8, 40, deep, samples);
        }
    }

    TEST_CASE("pictures of one to four pixels lose nothing") {
        try_aimed(2000, 1, 4, [](Aim& aim) {
            if (aim.random.index(2) == 0) aim.offset(1e6);
            const double z = aim.random.number(0.1, 0.9);
            aim.add(aim.meshes.wall(z, 0.0), 0);
            aim.add(aim.meshes.specks(z, 10), aim.some_size());
            aim.add(aim.meshes.fan(0.3), aim.some_size());
        });
        try_aimed(2000, 1, 4, [](Aim& aim) {
            if (aim.random.index(2) == 0) aim.offset(1e6);
            const double near = aim.meshes.some(0.01, 1.0);
            aim.to_clip = MarginScenes::deep(near);
            for (int i = 0; i < 3; ++i) {
                TriangleMesh mesh = aim.random.index(2) == 0 ? aim.meshes.fan(0.3) : aim.meshes.specks(0.5, 5);
                aim.meshes.deepen(mesh, 1.01 * near, 20.0 * near, aim.random.index(4) == 0);
                aim.add(std::move(mesh), aim.random.index(2) == 0 ? 64 : aim.some_size());
            }
        });
    }
}

}  // namespace
}  // namespace crofton::testing
