// SPDX-License-Identifier: MIT
// The example of docs/depth.md, compiled and run.
#include <doctest/doctest.h>
#include <crofton/crofton.hpp>
#include <cstdio>
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

}  // namespace

TEST_SUITE("depth/guide") {
    TEST_CASE("the guide's example draws the front of the first box and nothing of the one behind it") {
        World world;
        const TriangleMesh box = crofton::testing::cube_mesh();
        std::vector<std::uint32_t> objects;
        const auto draw = [&](std::uint32_t object, std::uint32_t) { objects.push_back(object); };
        CHECK(show(world, box.positions, box.indices, {}, {-5.0, -12.0}, draw) == 0);
        CHECK(objects == std::vector<std::uint32_t>{0, 0});
        CHECK(show(world, box.positions, {}, {}, {}, draw) == 1);
    }
}
