// SPDX-License-Identifier: MIT
// Where rays start and end, exactly.
#include <doctest/doctest.h>
#include <cmath>
#include <crofton/mesh/mesh_query.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <limits>
#include <random>
#include <vector>

#include "shape/mesh/first_hit.hpp"
#include "shape/mesh/meshes.hpp"

using namespace crofton;
using namespace crofton::mesh;
using namespace crofton::testing;

TEST_SUITE("mesh/ray_ends") {
    // t is rounded, so its rounding must not say where a ray ends.
    TEST_CASE("rays that start or end on a surface, or an ulp away, are as in rational arithmetic") {
        std::mt19937_64 random(23);
        // Not an ulp of 0, whose products leave the range of exact arithmetic.
        const auto beside = [&](double x) {
            if (x == 0.0) return static_cast<double>(random() % 3) * 0x1p-60 - 0x1p-60;
            for (std::size_t ulps = random() % 3; ulps > 0; --ulps)
                x = std::nextafter(x, random() % 2 ? 1e300 : -1e300);
            return x;
        };
        int hits = 0, misses = 0;
        for (int trial = 0; trial < 4000; ++trial) {
            const double size = std::pow(10.0, static_cast<int>(random() % 9) - 4);
            TriangleMesh mesh = wavy_torus(1.0, 0.4, 0.2, 5, 4);
            for (glm::vec3& p : mesh.positions) p *= static_cast<float>(size);
            mesh.indices.resize(3 * (1 + random() % 4));  // so that nothing lies behind
            const auto tree = mesh::MeshTree::build(mesh), prepared = mesh::MeshTree::build(mesh, {.rays = true});
            const std::size_t t = random() % mesh.triangle_count();
            const glm::dvec3 a = vertex(mesh, t, 0), b = vertex(mesh, t, 1), c = vertex(mesh, t, 2);
            const double u = static_cast<double>(random() % 5) / 4.0, v = static_cast<double>(random() % 5) / 4.0;
            glm::dvec3 target = a + u * (b - a) + v * (1.0 - u) * (c - a);
            for (int i = 0; i < 3; ++i) target[i] = beside(target[i]);
            Ray ray{target, random_vector(random)};
            // Also nearly within the triangle's plane.
            if (trial % 3 == 0)
                ray.direction = (b - a) + std::pow(10.0, -static_cast<int>(random() % 18)) * ray.direction;
            ray.direction *= size * std::pow(10.0, static_cast<int>(random() % 41) - 20);
            if (trial % 2) {
                ray.max_t = beside(static_cast<double>(1 + random() % 8) / 4.0);
                ray.origin = target - ray.max_t * ray.direction;
                ray.max_t = beside(ray.max_t);
                if (trial % 8 == 7) ray.max_t = std::numeric_limits<double>::infinity();
            } else if (trial % 4) {
                ray.max_t = 0.0;
            }
            const auto truth = oracle_hit(ray, mesh);
            const auto hit = raycast(ray, *tree);
            CHECK(hit.has_value() == truth.has_value());
            CHECK(are_same(hit, raycast(ray, *prepared)));
            CHECK(hits_any(ray, *tree) == truth.has_value());
            CHECK(hits_any(ray, *prepared) == truth.has_value());
            const std::vector<Ray> rays(8, ray);
            std::vector<std::optional<TriangleHit>> together(rays.size());
            raycast(rays, *prepared, together);
            CHECK(are_same(together[7], hit));
            std::optional<TriangleHit> nearest;
            for (std::uint32_t i = 0; i < mesh.triangle_count(); ++i) {
                const auto at = raycast(ray, Triangle{vertex(mesh, i, 0), vertex(mesh, i, 1), vertex(mesh, i, 2)});
                if (at && (!nearest || *at < nearest->t)) nearest = {*at, i};
            }
            CHECK(are_same(nearest, hit));  // the same bits
            if (hit) CHECK((hit->t >= 0.0 && hit->t <= ray.max_t));
            ++(truth ? hits : misses);
        }
        CHECK(hits > 1000);
        CHECK(misses > 1000);
    }

    TEST_CASE("rays that start and end at a corner of a triangle") {
        const Triangle a{glm::dvec3(6.5, 6, 7), glm::dvec3(-0.125), glm::dvec3(-0.125, 13.5, 13.5)};
        const Ray at_corner{{-0x1.0000000000001p-3, 0, 0}, {0x1p-55, -0x1p-3, -0x1p-3}};
        CHECK(raycast(at_corner, a).has_value());
        const Triangle b{glm::dvec3(-0.125, -7.25, -7.25), glm::dvec3(13.5, 13.5, 0), glm::dvec3(0)};
        const Ray past{{6.5, 0x1.9ffffffffffffp+2, 0}, {-6.5, -0x1.9ffffffffffffp+2, 3.5}};
        CHECK_FALSE(raycast(past, b).has_value());
    }
}
