// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <hwy/targets.h>
#include <box_mesh.hpp>
#include <crofton/mesh/mesh_parts.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <vector>

#include "shape/mesh/first_hit.hpp"
#include "shape/mesh/meshes.hpp"

using namespace crofton;
using namespace crofton::mesh;
using namespace crofton::testing;

TEST_SUITE("mesh/ray") {
    TEST_CASE("rays that are not finite or have no direction hit nothing") {
        const auto mesh = mesh::MeshTree::build(wavy_torus(1.0, 0.4, 0.0));
        const double nan = std::numeric_limits<double>::quiet_NaN();
        CHECK_FALSE(raycast(Ray{{nan, 0.0, 0.0}}, *mesh).has_value());
        CHECK_FALSE(raycast(Ray{{1.0, 0.0, -5.0}, {0.0, 0.0, 0.0}}, *mesh).has_value());
        for (const double limit : {-1.0, nan}) {
            CHECK_FALSE(raycast(Ray{{1.0, 0.0, -5.0}, {0.0, 0.0, 1.0}, limit}, *mesh).has_value());
            CHECK_FALSE(hits_any(Ray{{1.0, 0.0, -5.0}, {0.0, 0.0, 1.0}, limit}, *mesh));
        }
        CHECK(raycast(Ray{{1.0, 0.0, -5.0}}, *mesh).has_value());
        CHECK_FALSE(raycast(Ray{{0.0, 0.0, -5.0}, {0.0, nan, 1.0}}, Obb{}).has_value());
        const Triangle triangle{glm::dvec3(-1, -1, 0), glm::dvec3(1, -1, 0), glm::dvec3(0, 1, 0)};
        CHECK(raycast(Ray{{0.0, 0.0, -5.0}}, triangle) == 5.0);
        CHECK_FALSE(raycast(Ray{{0.0, 0.0, -5.0}, {0.0, nan, 1.0}}, triangle).has_value());
        CHECK_FALSE(raycast(Ray{{0.0, 0.0, -5.0}}, Triangle{glm::dvec3(nan), triangle[1], triangle[2]}).has_value());
        CHECK_FALSE(raycast(Ray{{0.0, 0.0, -5.0}, {0.0, 0.0, 1.0}, 4.5}, triangle).has_value());
        CHECK_FALSE(raycast(Ray{{-5.0, 0.0, 0.0}, {1.0, 0.0, 0.0}}, triangle).has_value());  // in its plane
    }

    TEST_CASE("a box is entered where it should be") {
        const Obb box{{10.0, 0.0, 0.0}, glm::mat3(1.0f), glm::vec3(1.0f, 2.0f, 0.0f)};
        CHECK(raycast(Ray{{0.0, 0.0, 0.0}, {2.0, 0.0, 0.0}}, box) == 4.5);
        CHECK(raycast(Ray{{10.0, 0.0, 0.0}, {1.0, 1.0, 0.0}}, box) == 0.0);
        CHECK_FALSE(raycast(Ray{{0.0, 0.0, 0.1}, {1.0, 0.0, 0.0}}, box).has_value());
        CHECK_FALSE(raycast(Ray{{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, 8.9}, box).has_value());
        CHECK_FALSE(raycast(Ray{{0.0, 0.0, 0.0}, {-1.0, 0.0, 0.0}}, box).has_value());
    }

    TEST_CASE("segments end where they end, and the nearest of equal hits has the lowest index") {
        TriangleMesh mesh;
        mesh.positions = {{0, 0, 1}, {4, 0, 1}, {0, 4, 1}};
        mesh.indices = {0, 1, 2, 0, 1, 2, 0, 2, 1};
        const auto tree = mesh::MeshTree::build(mesh), prepared = mesh::MeshTree::build(mesh, {.rays = true});
        const auto hit = raycast(Ray{{1, 1, 0}, {0, 0, 1}, 1.0}, *tree);
        CHECK(are_same(hit, raycast(Ray{{1, 1, 0}, {0, 0, 1}, 1.0}, *prepared)));
        REQUIRE(hit.has_value());
        CHECK(hit->t == 1.0);
        CHECK(hit->triangle == 0);
        CHECK_FALSE(raycast(Ray{{1, 1, 0}, {0, 0, 1}, std::nextafter(1.0, 0.0)}, *tree).has_value());
        CHECK(hits_any(Ray{{1, 1, 0}, {0, 0, 1}, 1.0}, *tree));
        CHECK(raycast(Ray{{0, 0, 0}}, *tree).has_value());  // through a corner
        CHECK(raycast(Ray{{2, 0, 0}}, *tree).has_value());  // through an edge
        CHECK_FALSE(raycast(Ray{{std::nextafter(0.0, -1.0), 1, 0}}, *tree).has_value());
    }

    TEST_CASE("random rays, rays at vertices and at edges: as rational arithmetic says") {
        std::mt19937_64 random(3);
        const TriangleMesh mesh = wavy_torus(1.0, 0.4, 0.2, 12, 8);
        const auto tree = mesh::MeshTree::build(mesh), prepared = mesh::MeshTree::build(mesh, {.rays = true});
        int hits = 0;
        for (int trial = 0; trial < 600; ++trial) {
            Ray ray{3.0 * random_vector(random), random_vector(random)};
            const std::size_t t = random() % mesh.triangle_count();
            if (trial % 3 == 1) ray.direction = vertex(mesh, t, 0) - ray.origin;
            if (trial % 3 == 2) ray.direction = 0.5 * (vertex(mesh, t, 0) + vertex(mesh, t, 1)) - ray.origin;
            if (trial % 5 == 0) ray.origin = glm::dvec3(glm::ivec3(ray.origin));
            const auto truth = oracle_hit(ray, mesh);
            const auto hit = raycast(ray, *tree);
            CHECK(are_same(hit, raycast(ray, *prepared)));
            CHECK(hits_any(ray, *prepared) == hit.has_value());
            CHECK(hit.has_value() == truth.has_value());
            CHECK(hits_any(ray, *tree) == truth.has_value());
            std::optional<double> nearest;
            for (std::size_t i = 0; i < mesh.triangle_count(); ++i)
                if (const auto at = raycast(ray, Triangle{vertex(mesh, i, 0), vertex(mesh, i, 1), vertex(mesh, i, 2)}))
                    nearest = nearest ? std::min(*nearest, *at) : at;
            CHECK(nearest.has_value() == truth.has_value());
            if (nearest && truth) CHECK(*nearest == doctest::Approx(*truth).epsilon(1e-9));
            if (hit && truth) CHECK(hit->t == doctest::Approx(*truth).epsilon(1e-9));
            hits += truth.has_value();
        }
        CHECK(hits > 200);
    }

    // Rays an ulp or a few beside edges and vertices, at all scales of the mesh, of the ray's offset and of its
    // direction.
    TEST_CASE("rays that all but miss: as rational arithmetic says, at every scale and distance") {
        std::mt19937_64 random(12);
        int hits = 0, misses = 0;
        for (int trial = 0; trial < 4000; ++trial) {
            const double size = std::pow(10.0, static_cast<int>(random() % 13) - 6);
            const double away = size * std::pow(10.0, static_cast<int>(random() % 6) - 1);
            TriangleMesh mesh = wavy_torus(1.0, 0.4, 0.2, 5, 4);
            const glm::vec3 shift(trial % 2 ? 0.0f : static_cast<float>(1e3 * size));
            for (glm::vec3& p : mesh.positions) p = p * static_cast<float>(size) + shift;
            const auto tree = mesh::MeshTree::build(mesh), prepared = mesh::MeshTree::build(mesh, {.rays = true});
            const std::size_t t = random() % mesh.triangle_count();
            const glm::dvec3 a = vertex(mesh, t, 0), b = vertex(mesh, t, 1);
            const double along = static_cast<double>(random() % 5) / 4.0;
            glm::dvec3 target = a + along * (b - a);
            for (int i = 0; i < 3; ++i)
                for (std::size_t ulps = random() % 3; ulps > 0; --ulps)
                    target[i] = std::nextafter(target[i], random() % 2 ? 1e300 : -1e300);
            Ray ray{target + away * random_vector(random), {}};
            ray.direction = (target - ray.origin) * std::pow(10.0, static_cast<int>(random() % 201) - 100);
            const auto truth = oracle_hit(ray, mesh);
            const auto hit = raycast(ray, *tree);
            CHECK(are_same(hit, raycast(ray, *prepared)));
            CHECK(hits_any(ray, *prepared) == hit.has_value());
            CHECK(hit.has_value() == truth.has_value());
            CHECK(hits_any(ray, *tree) == truth.has_value());
            if (hit && truth) CHECK(hit->t == doctest::Approx(*truth).epsilon(1e-6));
            ++(truth ? hits : misses);
        }
        CHECK(hits > 1000);
        CHECK(misses > 300);
    }

    TEST_CASE("rays are prepared on request, and answered by the same bits before, after a refit and in a copy") {
        std::mt19937_64 random(17);
        TriangleMesh mesh = wavy_torus(1.0, 0.4, 0.2, 90, 60);
        auto plain = mesh::MeshTree::build(mesh, {.refittable = true}).value();
        CHECK(plain.parts().ray_nodes.empty());
        auto asked = plain;
        REQUIRE(asked.prepare_rays().has_value());
        const std::size_t count = asked.parts().ray_nodes.size();
        CHECK(count > 100);
        REQUIRE(asked.prepare_rays().has_value());  // the second time nothing is done
        CHECK(asked.parts().ray_nodes.size() == count);
        CHECK(plain.parts().ray_nodes.empty());
        int hits = 0;
        for (int round = 0; round < 2; ++round) {
            for (int trial = 0; trial < 5000; ++trial) {
                Ray ray{2.0 * random_vector(random), random_vector(random)};
                if (trial % 4 == 0) ray.direction[trial / 4 % 3] = 0.0;
                if (trial % 7 == 0) ray.max_t = 1.0;
                const auto hit = raycast(ray, asked);
                CHECK(are_same(hit, raycast(ray, plain)));
                CHECK(hits_any(ray, plain) == hit.has_value());
                hits += hit.has_value();
            }
            for (glm::vec3& p : mesh.positions) p.x += 0.3f * p.y * p.y;
            REQUIRE(asked.refit(mesh.positions).has_value());
            REQUIRE(plain.refit(mesh.positions).has_value());
        }
        CHECK(hits > 1000);
        CHECK(mesh::MeshTree().prepare_rays().has_value());  // of no triangles
    }

    // A leaf has 384 bytes, a node of oriented boxes 1,088, one of aligned boxes 256.
    TEST_CASE("a mesh that is prepared for rays takes 70 bytes a triangle") {
        const TriangleMesh mesh = wavy_torus(1.0, 0.4, 0.2, 300, 200);
        const auto tree = mesh::MeshTree::build(mesh, {.rays = true}).value();
        const MeshParts& parts = tree.parts();
        const auto bytes = [](const auto& vector) {
            return static_cast<double>(vector.capacity() * sizeof(vector[0]));
        };
        const double all = bytes(parts.leaves) + bytes(parts.nodes) + bytes(parts.ray_nodes);
        CHECK(all <= 70.0 * static_cast<double>(mesh.triangle_count()));
    }

    // Rays of one place: into a narrow cone, a wider one, everywhere; and each from elsewhere.
    TEST_CASE("many rays at once are answered as one by one, whether they lie together or not") {
        std::mt19937_64 random(31);
        TriangleMesh mesh = wavy_torus(1.0, 0.4, 0.2, 60, 40);
        for (const float shift : {0.0f, 3e4f}) {
            for (glm::vec3& p : mesh.positions) p.x += shift;
            const auto plain = mesh::MeshTree::build(mesh), prepared = mesh::MeshTree::build(mesh, {.rays = true});
            std::vector<std::optional<TriangleHit>> hits;
            int met = 0, missed = 0;
            for (int trial = 0; trial < 1500; ++trial) {
                const double cone = std::pow(10.0, -static_cast<double>(trial % 5));
                const double spread = trial % 3 == 0 ? 0.0 : 0.1 * cone;
                const std::size_t count = 1 + random() % 40;
                const glm::dvec3 eye = glm::dvec3(shift, 0, 0) + 4.0 * random_vector(random);
                const glm::dvec3 way = vertex(mesh, random() % mesh.triangle_count(), 0) - eye;
                std::vector<Ray> rays;
                for (std::size_t i = 0; i < count; ++i) {
                    Ray ray{eye + spread * random_vector(random), way + cone * random_vector(random)};
                    // Directions of any length, along an axis, at a vertex, or ending near the surface.
                    if (trial % 4 == 1) ray.direction *= std::pow(10.0, static_cast<int>(random() % 3) - 1);
                    if (trial % 4 == 2) ray.direction[static_cast<int>(random() % 3)] = 0.0;
                    if (trial % 7 == 3) ray.direction = vertex(mesh, random() % mesh.triangle_count(), 0) - ray.origin;
                    if (trial % 4 == 3) ray.max_t = 0.9 + 0.1 * static_cast<double>(random() % 4);
                    if (trial % 11 == 4 && i % 5 == 2) ray.max_t = -1.0;
                    if (trial % 11 == 5 && i % 5 == 3) ray.direction.y = std::numeric_limits<double>::quiet_NaN();
                    if (trial % 11 == 6 && i % 5 == 1) ray.direction = glm::dvec3(0.0);
                    rays.push_back(ray);
                }
                for (const auto* tree : {&*plain, &*prepared}) {
                    hits.assign(count + 1, TriangleHit{-7.0, 7u});
                    raycast(rays, *tree, hits);
                    for (std::size_t i = 0; i < count; ++i) {
                        const auto alone = raycast(rays[i], *plain);
                        CHECK(are_same(hits[i], alone));
                        ++(alone ? met : missed);
                    }
                    CHECK(are_same(hits[count], TriangleHit{-7.0, 7u}));  // of no ray
                }
            }
            CHECK(met > 5000);
            CHECK(missed > 5000);
        }
        raycast(std::span<const Ray>(), mesh::MeshTree(), std::span<std::optional<TriangleHit>>());
        const std::vector<Ray> same(20, Ray{{0.0, 0.0, -5.0}});
        std::vector<std::optional<TriangleHit>> none(20, TriangleHit{});
        raycast(same, mesh::MeshTree(), none);
        for (const auto& hit : none) CHECK_FALSE(hit.has_value());
        CHECK_FALSE(raycast(same[0], mesh::MeshTree()).has_value());
        CHECK_FALSE(hits_any(same[0], mesh::MeshTree()));
    }

    TEST_CASE("packets through vertices and edges: as alone, on every instruction set") {
        const TriangleMesh mesh = wavy_torus(1.0, 0.4, 0.2, 90, 60);
        const auto tree = mesh::MeshTree::build(mesh, {.rays = true});
        const glm::dvec3 eye(0.3, 0.4, 6.0);
        std::vector<Ray> rays;
        for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
            for (const double along : {0.0, 0.5, 1.0}) {
                const glm::dvec3 a = vertex(mesh, t, 0), b = vertex(mesh, t, 1);
                rays.push_back({eye, a + along * (b - a) - eye});
            }
        std::vector<std::optional<TriangleHit>> alone, hits(rays.size());
        for (const Ray& ray : rays) alone.push_back(raycast(ray, *tree));
        for (std::int64_t rest = hwy::SupportedTargets(); rest != 0; rest &= rest - 1) {
            hwy::SetSupportedTargetsForTest(rest & -rest);
            raycast(rays, *tree, hits);
            CHECK(std::equal(hits.begin(), hits.end(), alone.begin(), are_same));
        }
        hwy::SetSupportedTargetsForTest(0);
    }

    TEST_CASE("packets at triangles that all their rays come to: as alone, on every instruction set") {
        std::mt19937_64 random(32);
        TriangleMesh shreds = wavy_torus(1.0, 0.4, 0.2, 7, 5);  // large triangles, and larger ones across them
        for (int t = 0; t < 40; ++t)
            for (int v = 0; v < 3; ++v) {
                shreds.indices.push_back(static_cast<std::uint32_t>(shreds.positions.size()));
                shreds.positions.push_back(glm::vec3(1.5 * random_vector(random)));
            }
        for (int t = 0; t < 60; ++t)  // two and more in one place
            shreds.indices.push_back(shreds.indices[shreds.indices.size() - 120]);
        const auto tree = mesh::MeshTree::build(shreds, {.rays = true});
        std::vector<Ray> rays;
        for (int packet = 0; packet < 600; ++packet) {
            const glm::dvec3 eye = packet % 3 == 0 ? glm::dvec3(4.0) : 4.0 * random_vector(random);
            const std::size_t t = random() % shreds.triangle_count();
            // At an inner point, a point of an edge, a vertex; or along the diagonal of all axes.
            const double a = packet % 4 == 1 ? 0.0 : 0.3, b = packet % 4 == 2 ? 0.0 : 0.2;
            const glm::dvec3 at = vertex(shreds, t, 0) + a * (vertex(shreds, t, 1) - vertex(shreds, t, 0)) +
                                  b * (vertex(shreds, t, 2) - vertex(shreds, t, 0));
            const glm::dvec3 way = packet % 12 == 3 ? glm::dvec3(-1.0) : at - eye;
            for (std::size_t i = 0; i < 16; ++i) {
                Ray ray{eye, way};
                if (i % 4 != 0) ray.direction += 1e-3 * random_vector(random);
                if (packet % 5 == 1) ray.origin += 1e-2 * random_vector(random);
                if (packet % 5 == 2) ray.max_t = i % 3 == 0 ? 1.0 : 0.5 + 0.1 * static_cast<double>(i);
                if (packet % 7 == 1) ray.direction *= packet % 2 == 0 ? 1e-20 : 3.0;
                rays.push_back(ray);
            }
        }
        std::vector<std::optional<TriangleHit>> alone, hits(rays.size());
        for (const Ray& ray : rays) alone.push_back(raycast(ray, *tree));
        CHECK(std::count_if(alone.begin(), alone.end(), [](const auto& hit) { return hit.has_value(); }) > 4000);
        for (std::int64_t rest = hwy::SupportedTargets(); rest != 0; rest &= rest - 1) {
            hwy::SetSupportedTargetsForTest(rest & -rest);
            raycast(rays, *tree, hits);
            CHECK(std::equal(hits.begin(), hits.end(), alone.begin(), are_same));
        }
        hwy::SetSupportedTargetsForTest(0);
    }

    TEST_CASE("a closed mesh has no leaks: rays from inside always hit") {
        std::mt19937_64 random(4);
        const auto tree = mesh::MeshTree::build(wavy_torus(0.6, 0.59, 0.0, 16, 16));
        for (int trial = 0; trial < 20000; ++trial) CHECK(hits_any(Ray{{0.6, 0.0, 0.0}, random_vector(random)}, *tree));
    }

    TEST_CASE("rays within a triangle's plane do not hit it, but what bounds it in a closed mesh is hit") {
        TriangleMesh sheet;
        sheet.positions = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
        sheet.indices = {0, 1, 2};
        const auto flat = mesh::MeshTree::build(sheet);
        CHECK_FALSE(raycast(Ray{{-1, 1, 0}, {1, 0, 0}}, *flat).has_value());
        CHECK_FALSE(raycast(Ray{{-1, 0, 0}, {1, 0, 0}}, *flat).has_value());  // along an edge
        CHECK_FALSE(raycast(Ray{{1, 1, 0}, {0.3, 0.7, 0}}, *flat).has_value());
        CHECK(raycast(Ray{{-1, 1, 0}, {1, 0, 1e-300}}, *flat).has_value() == false);
        CHECK(raycast(Ray{{-1, 1, -1e-60}, {1, 0, 1e-60}}, *flat).has_value());  // meets x = 0, if ever so flatly
        const auto cube = mesh::MeshTree::build(testing::cube_mesh());
        for (const double y : {-1.0, -0.5, 0.0, 0.25, 1.0}) {
            const auto hit = raycast(Ray{{-5, y, 1}, {1, 0, 0}}, *cube);  // within the plane of a face
            REQUIRE(hit.has_value());
            CHECK(hit->t == 4.0);
        }
        CHECK(raycast(Ray{{-5, 1, 1}, {2, 0, 0}}, *cube)->t == 2.0);    // along an edge
        CHECK(raycast(Ray{{-5, -5, -5}, {1, 1, 1}}, *cube)->t == 4.0);  // along a diagonal, through two corners
        CHECK_FALSE(raycast(Ray{{-5, 0, std::nextafter(1.0, 2.0)}, {1, 0, 0}}, *cube).has_value());
    }

    TEST_CASE("watertight: no ray from inside a closed mesh is lost at an edge or a vertex") {
        TriangleMesh meshes[] = {testing::cube_mesh(), wavy_torus(1.0, 0.6, 0.2, 24, 12), testing::cube_mesh(),
                                 wavy_torus(1.0, 0.6, 0.2, 24, 12)};
        for (TriangleMesh& mesh : meshes) {
            // Products of the last two's coordinates are less than float's normal numbers.
            const float size = &mesh < meshes + 2 ? 1.0f : 1e-21f;
            for (glm::vec3& p : mesh.positions) p *= size;
            const auto tree = mesh::MeshTree::build(mesh), prepared = mesh::MeshTree::build(mesh, {.rays = true});
            std::mt19937_64 random(8);
            std::vector<glm::dvec3> origins;
            while (origins.size() < 4) {
                const glm::dvec3 p =
                    static_cast<double>(size) * (glm::dvec3(0.8, 0.0, 0.0) + 0.3 * random_vector(random));
                if (contains(*tree, p)) origins.push_back(p);
            }
            int lost = 0;
            const auto shoot = [&](const glm::dvec3& from, const glm::dvec3& target) {
                lost += !raycast(Ray{from, target - from}, *tree).has_value();
                lost += !raycast(Ray{from, target - from}, *prepared).has_value();
                lost += !hits_any(Ray{from, 1e-7 * (target - from)}, *tree);
            };
            for (const glm::dvec3& from : origins)
                for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
                    for (std::size_t k = 0; k < 3; ++k) {
                        const glm::dvec3 a = vertex(mesh, t, k), b = vertex(mesh, t, (k + 1) % 3);
                        shoot(from, a);
                        for (const double s : {0.5, 0.25, 1.0 / 3.0, 0.1, 1e-9}) shoot(from, a + s * (b - a));
                    }
            CHECK(lost == 0);
        }
    }

    TEST_CASE("grazing rays: needles of triangles seen edge-on are hit where rational arithmetic hits them") {
        std::mt19937_64 random(9);
        int hits = 0;
        for (int trial = 0; trial < 3000; ++trial) {
            const glm::dvec3 direction = glm::normalize(random_vector(random)), origin = 2.0 * random_vector(random);
            const double off = std::pow(10.0, -double(trial % 18));
            TriangleMesh mesh;
            for (int k = 0; k < 3; ++k)
                mesh.positions.push_back(
                    glm::vec3(origin + (3.0 + random_vector(random).x) * direction + off * random_vector(random)));
            mesh.indices = {0, 1, 2};
            const auto tree = mesh::MeshTree::build(mesh), prepared = mesh::MeshTree::build(mesh, {.rays = true});
            const Ray ray{origin, direction};
            const auto truth = oracle_hit(ray, mesh);
            const auto hit = raycast(ray, *tree);
            CHECK(are_same(hit, raycast(ray, *prepared)));
            CHECK(hits_any(ray, *prepared) == hit.has_value());
            CHECK(hit.has_value() == truth.has_value());
            if (hit && truth) {
                CHECK(hit->t > 1.9);
                CHECK(hit->t < 6.0);
            }
            hits += truth.has_value();
        }
        CHECK(hits > 100);
    }
}
