// SPDX-License-Identifier: MIT
// The example of docs/depth.md, compiled and run.
#include <doctest/doctest.h>
#include <crofton/crofton.hpp>
#include <cstdio>
#include <set>
#include <vector>

#include "../../box_mesh.hpp"

namespace {

using namespace crofton;

int report(const Error& error) {
    std::printf("%s\n", error.message.c_str());
    return 1;
}

template <class Draw>
int show(World& world, const Vector<glm::vec3>& positions, const Vector<std::uint32_t>& indices, const Camera& camera,
         const std::vector<double>& places, const Draw& draw) {
    const auto mesh = world.add_mesh({.positions = positions, .indices = indices, .clusters = true, .one_sided = true});
    if (!mesh) return report(mesh.error());
    // Draw the mesh by the clusters' order of triangles.
    const depth::ClusteredMesh& clusters = *world.clusters_of(*mesh);
    std::vector<std::uint32_t> index_buffer(indices.size());
    clusters.permute(indices, index_buffer);

    for (const double z : places)
        world.add({.mesh = *mesh, .transform = Transform{glm::dmat3(1.0), {0, 0, z}}}).value();
    world.update().value();
    ViewResult visible;
    // Each frame.
    world.view({.camera = camera, .picture = depth::PictureView{1280, 720}}, visible).value();
    for (const depth::VisibleCluster& listed : visible.triangles()) {
        const depth::Cluster& cluster = clusters.clusters()[listed.cluster];
        for (std::uint32_t k = 0; k < cluster.triangle_count; ++k)
            if (listed.triangles >> k & 1) draw(listed.object, cluster.first_triangle + k);
    }
    return 0;
}

int lend(depth::ClusteredMesh& clusters, std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices,
         std::span<std::uint32_t> index_buffer) {
    clusters.permute(indices, index_buffer);
    if (const auto lent = clusters.lend(positions, index_buffer); !lent) return report(lent.error());
    return 0;
}

template <class Draw>
void show_shadows(const World& world, const Camera& camera, const Camera& sun, ViewResult& visible, ViewResult& casters,
                  const Draw& draw_into_map) {
    world.view({.camera = camera, .picture = depth::PictureView{1280, 720}}, visible).value();
    // The map of 2048 x 2048 texels, looked up by 3 x 3 bilinear comparisons.
    const ShadowReceivers receivers{.seen = &visible, .radius = 2.0f};
    world.view({.camera = sun, .picture = depth::PictureView{2048, 2048}, .receivers = receivers}, casters).value();
    for (const depth::VisibleCluster& listed : casters.triangles()) draw_into_map(listed);
}

}  // namespace

TEST_SUITE("depth/guide") {
    TEST_CASE("the guide's mesh can be lent once it is permuted") {
        const TriangleMesh box = crofton::testing::cube_mesh();
        auto clusters = depth::ClusteredMesh::cut(box.positions, box.indices).value();
        std::vector<std::uint32_t> index_buffer(box.indices.size());
        CHECK(lend(clusters, box.positions, box.indices, index_buffer) == 0);
    }

    TEST_CASE("the guide's example draws the front of the first box and nothing of the one behind it") {
        World world;
        const TriangleMesh box = crofton::testing::cube_mesh();
        std::vector<std::uint32_t> objects;
        const auto draw = [&](std::uint32_t object, std::uint32_t) { objects.push_back(object); };
        CHECK(show(world, box.positions, box.indices, {}, {-5.0, -12.0}, draw) == 0);
        CHECK(objects == std::vector<std::uint32_t>{0, 0});
        CHECK(show(world, box.positions, {}, {}, {}, draw) == 1);
    }

    TEST_CASE("the example of shadows draws the box that throws one on the other, and not the box that nobody sees") {
        World world;
        const TriangleMesh box = crofton::testing::cube_mesh();
        const auto mesh =
            world.add_mesh({.positions = box.positions, .indices = box.indices, .clusters = true}).value();
        // Seen; above it, out of the picture; behind it, and in nobody's light.
        for (const glm::dvec3& at : {glm::dvec3(0, 0, -5), glm::dvec3(1, 8, -5), glm::dvec3(0, 0, -12)})
            world.add({.mesh = mesh, .transform = Transform{glm::dmat3(1.0), at}}).value();
        world.update().value();
        Camera sun;
        sun.projection = Projection::orthographic;
        sun.position = {0, 20, -5};
        sun.forward = {0, -1, 0};
        sun.up = {0, 0, -1};
        sun.height = 30;
        ViewResult visible, casters;
        std::set<std::uint32_t> drawn;
        show_shadows(world, {}, sun, visible, casters,
                     [&](const depth::VisibleCluster& listed) { drawn.insert(listed.object); });
        CHECK(drawn == std::set<std::uint32_t>{0, 1});
    }
}
