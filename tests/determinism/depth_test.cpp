// SPDX-License-Identifier: MIT
// How meshes are cut and which triangles a picture needs, in the same bits everywhere.
#include <crofton/depth/depth_culler.hpp>
#include <crofton/geometry/camera.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "crowd.hpp"
#include "digest.hpp"
#include "everywhere.hpp"

using namespace crofton;
using namespace crofton::test;

namespace {

// A hilly grid of n × n squares over [−1, 1]².
TriangleMesh hilly_grid(std::uint32_t n, Random& random) {
    TriangleMesh mesh;
    for (std::uint32_t j = 0; j <= n; ++j)
        for (std::uint32_t i = 0; i <= n; ++i) {
            const double x = 2.0 * i / n - 1.0, z = 2.0 * j / n - 1.0, y = random.uniform(-0.05, 0.05);
            mesh.positions.push_back(glm::vec3(glm::dvec3(x, y + 0.3 * x * z, z)));
        }
    for (std::uint32_t j = 0; j < n; ++j)
        for (std::uint32_t i = 0; i < n; ++i) {
            const std::uint32_t p = j * (n + 1) + i, q = p + n + 1;
            for (const std::uint32_t v : {p, q, q + 1, p, q + 1, p + 1}) mesh.indices.push_back(v);
        }
    return mesh;
}

}  // namespace

TEST_SUITE("determinism/depth") {
    TEST_CASE("clusters and the triangles that pictures need") {
        check_everywhere(0x2222dacc1335fccc, [](Executor&) {
            Random random(48);
            const TriangleMesh mesh = hilly_grid(24, random);
            const auto cut = depth::ClusteredMesh::cut(mesh.positions, mesh.indices).value();
            Digest digest;
            for (const std::uint32_t triangle : cut.triangle_order()) digest.add(triangle);
            for (std::size_t c = 0; c < cut.clusters().size(); ++c) {
                const depth::ClusterBox box = cut.box_of(c);
                digest.add(cut.clusters()[c].first_triangle).add(cut.clusters()[c].triangle_count).add(box.center);
                for (const glm::vec3& edge : box.half_edges) digest.add(edge);
            }
            depth::DepthCuller culler;
            for (int view = 0; view < 8; ++view) {
                Camera camera;
                camera.position = {random.uniform(-9, 9), 0.0, 0.0};
                const glm::dmat4 to_clip = world_to_clip(camera);
                std::vector<depth::DepthObject> objects;
                for (int i = 0; i < 60; ++i) {
                    const double x = random.uniform(-15, 15), y = random.uniform(-3, 3), z = random.uniform(-40, 2);
                    const double size = random.uniform(0.5, 4.0), upright = random.uniform();
                    glm::dmat4 place = glm::scale(glm::translate(glm::dmat4(1.0), {x, y, z}), glm::dvec3(size));
                    if (upright < 0.6) std::swap(place[1], place[2]);
                    objects.push_back({&cut, glm::mat4(to_clip * place), i % 3 == 0, i % 7 != 0});
                }
                const auto found = culler.find_visible(objects, {321, 181});
                for (const depth::VisibleCluster& c : *found) digest.add(c.object).add(c.cluster).add(c.triangles);
                for (std::uint32_t p = 0; p < 321 * 181; p += 17) digest.add(culler.nearness(p % 321, p / 321));
            }
            return digest.value();
        });
    }

    TEST_CASE("casters whose shadows a camera sees") {
        check_everywhere(0xbcc4689f3d5fb5f5, [](Executor& executor) {
            Random random(7);
            const TriangleMesh mesh = hilly_grid(24, random);
            const auto cut = depth::ClusteredMesh::cut(mesh.positions, mesh.indices).value();
            Digest digest;
            depth::DepthCuller camera_culler, light_culler;
            for (int view = 0; view < 8; ++view) {
                Camera camera, light;
                camera.position = {random.uniform(-9, 9), 0.0, 0.0};
                light.position = {random.uniform(-9, 9), 12.0, -15.0};
                light.forward = {random.uniform(-0.5, 0.5), -1.0, -0.3};
                light.fov_y = 1.8;
                std::vector<depth::DepthObject> drawn, casters;
                std::vector<depth::DepthReceiver> receivers;
                for (int i = 0; i < 60; ++i) {
                    const double x = random.uniform(-15, 15), y = random.uniform(-3, 3), z = random.uniform(-40, 2);
                    // Some are so large that they are split.
                    const double size = i % 20 == 0 ? 12.0 : random.uniform(0.5, 4.0);
                    const glm::dmat4 place = glm::scale(glm::translate(glm::dmat4(1.0), {x, y, z}), glm::dvec3(size));
                    const glm::mat4 to_map(world_to_clip(light) * place);
                    drawn.push_back({&cut, glm::mat4(world_to_clip(camera) * place)});
                    casters.push_back({&cut, to_map, i % 3 == 0, i % 7 != 0});
                    receivers.push_back({&cut, to_map, i % 11 == 5});
                }
                (void)camera_culler.find_visible(drawn, {321, 181}, executor);
                const auto found =
                    light_culler.find_casters(casters, {500, 300}, {&camera_culler, receivers, 1.5f}, executor);
                for (const depth::VisibleCluster& c : *found) digest.add(c.object).add(c.cluster).add(c.triangles);
                for (std::uint32_t p = 0; p < 500 * 300; p += 17) digest.add(light_culler.nearness(p % 500, p / 500));
            }
            return digest.value();
        });
    }
}
