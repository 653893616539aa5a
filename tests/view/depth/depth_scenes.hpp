// SPDX-License-Identifier: MIT
// Meshes, crowds and cameras for the tests of culling by depth.
#pragma once
#include <array>
#include <cmath>
#include <crofton/depth/depth_culler.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/geometry/mesh.hpp>
#include <deque>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <oracle/near_misses.hpp>
#include <oracle/owner_picture.hpp>
#include <vector>

#include "../../box_mesh.hpp"

namespace crofton::testing {

// A mesh and what the culler makes of it: some read the mesh in place.
struct CutMesh {
    TriangleMesh mesh;  // in the order of the clusters
    depth::ClusteredMesh clusters;

    CutMesh(CutMesh&&) = default;  // what is lent stays where it is

    explicit CutMesh(TriangleMesh source, std::uint32_t most = 0, bool may_lend = true) : mesh(std::move(source)) {
        clusters = depth::ClusteredMesh::cut(mesh.positions, mesh.indices, {.max_triangles = most}).value();
        const Vector<std::uint32_t> given = mesh.indices;
        clusters.permute(given, mesh.indices);
        if (may_lend && clusters.clusters().size() % 2 == 0) clusters.lend(mesh.positions, mesh.indices).value();
    }
};

// A grid of hills, n × n squares over [−size, size]².
inline TriangleMesh hills(std::uint32_t n, float size, float height, oracle::NearMisses& random) {
    TriangleMesh mesh;
    const double a = random.number(0.5, 2.0), b = random.number(0.5, 2.0), c = random.number(0.0, 6.0);
    for (std::uint32_t j = 0; j <= n; ++j)
        for (std::uint32_t i = 0; i <= n; ++i) {
            const float x = size * (2.0f * float(i) / float(n) - 1.0f), z = size * (2.0f * float(j) / float(n) - 1.0f);
            const float y = height * float(std::sin(a * x / size * 4 + c) * std::cos(b * z / size * 4) +
                                           random.number(-0.05, 0.05));
            mesh.positions.push_back({x, y, z});
        }
    for (std::uint32_t j = 0; j < n; ++j)
        for (std::uint32_t i = 0; i < n; ++i) {
            const std::uint32_t p = j * (n + 1) + i, q = p + n + 1;
            for (const std::uint32_t v : {p, q, q + 1, p, q + 1, p + 1}) mesh.indices.push_back(v);
        }
    return mesh;
}

// A closed ball of n bands, slightly dented.
inline TriangleMesh ball(std::uint32_t n, oracle::NearMisses& random) {
    TriangleMesh mesh;
    const std::uint32_t columns = 2 * n;
    for (std::uint32_t j = 0; j <= n; ++j)
        for (std::uint32_t i = 0; i < columns; ++i) {
            const double v = 3.14159265358979 * j / n, u = 2 * 3.14159265358979 * i / columns;
            const double r = j == 0 || j == n ? 1.0 : random.number(0.9, 1.1);
            mesh.positions.push_back(
                glm::vec3(r * std::sin(v) * std::cos(u), r * std::cos(v), r * std::sin(v) * std::sin(u)));
        }
    for (std::uint32_t j = 0; j < n; ++j)
        for (std::uint32_t i = 0; i < columns; ++i) {
            const std::uint32_t p = j * columns + i, p1 = j * columns + (i + 1) % columns;
            const std::uint32_t q = p + columns, q1 = p1 + columns;
            for (const std::uint32_t w : {p, p1, q1, p, q1, q}) mesh.indices.push_back(w);
        }
    return mesh;
}

// Needles around the origin, some of them missing.
inline TriangleMesh needles(std::uint32_t n, oracle::NearMisses& random) {
    TriangleMesh mesh;
    mesh.positions.push_back(glm::vec3(0.0f));
    const double sweep = random.number(0.2, 6.2);
    for (std::uint32_t i = 0; i <= n; ++i) {
        const double a = sweep * i / n, r = random.number(0.5, 1.5);
        mesh.positions.push_back(glm::vec3(r * std::cos(a), r * std::sin(a), random.number(-0.02, 0.02)));
    }
    for (std::uint32_t i = 1; i <= n; ++i) {
        if (random.index(9) == 0) continue;
        for (const std::uint32_t v : {0u, i, i + 1}) mesh.indices.push_back(v);
    }
    if (mesh.indices.empty()) mesh.indices = {0, 1, 2};
    return mesh;
}

// Walls in the plane x = 0, or nearly: an eye in that plane sees them edge-on, where the samples of a column lie in a
// picture of odd width.
inline TriangleMesh fins(std::uint32_t n, oracle::NearMisses& random) {
    TriangleMesh mesh;
    for (std::uint32_t i = 0; i < n; ++i) {
        const auto p = static_cast<std::uint32_t>(mesh.positions.size());
        const double near = random.number(1.0, 9.0), far = near + random.number(0.1, 3.0);
        const double low = random.number(-2.0, 1.0), high = low + random.number(0.1, 2.0);
        const auto x = [&] {
            return random.index(2) == 0 ? 0.0 : random.number(-1.0, 1.0) * std::exp(random.number(-11.0, -6.0));
        };
        for (const double z : {-near, -far})
            for (const double y : {low, high}) {
                const double at = x();
                mesh.positions.push_back(glm::vec3(at, y, z));
            }
        const bool turned = random.index(2) == 0;
        for (const std::uint32_t v : {0u, 1u, 3u, 0u, 3u, 2u}) mesh.indices.push_back(p + (turned ? 3 - v : v));
    }
    return mesh;
}

struct PlacedMesh {
    const CutMesh* mesh;
    glm::dmat4 world;
    bool one_sided = false, hides = true;
    float position_error = 0.0f;
};

inline glm::dmat4 placed(const glm::dvec3& at, const glm::dvec3& scale, const glm::dvec3& axis, double angle) {
    return glm::scale(glm::rotate(glm::translate(glm::dmat4(1.0), at), angle, axis), scale);
}

struct Scene {
    std::deque<CutMesh> meshes;
    std::vector<PlacedMesh> objects;
};

inline Scene random_scene(oracle::NearMisses& random) {
    Scene scene;
    scene.meshes.emplace_back(cube_mesh());
    scene.meshes.emplace_back(ball(8 + static_cast<std::uint32_t>(random.index(20)), random),
                              static_cast<std::uint32_t>(1 + random.index(64)));
    scene.meshes.emplace_back(
        hills(10 + static_cast<std::uint32_t>(random.index(40)), 40.0f, float(random.number(0.5, 5.0)), random),
        static_cast<std::uint32_t>(4 + random.index(61)));
    if (random.index(3) != 0)
        scene.objects.push_back({&scene.meshes[2], placed({0, -3, 0}, glm::dvec3(1), {0, 1, 0}, random.number(0, 6)),
                                 random.index(2) == 0});
    const std::size_t count = 5 + random.index(80);
    for (std::size_t i = 0; i < count; ++i) {
        const bool box = random.index(3) != 0;
        glm::dvec3 scale(std::exp(random.number(-2.0, 1.0)), std::exp(random.number(-2.0, 1.5)),
                         std::exp(random.number(-2.0, 1.0)));
        if (box && random.index(3) == 0) scale = {random.number(2.0, 10.0), random.number(1.0, 6.0), 0.1};  // walls
        glm::dvec3 axis = random.direction();
        if (random.index(2) == 0) axis = {0, 1, 0};
        scene.objects.push_back(
            {&scene.meshes[box ? 0 : 1],
             placed(glm::dvec3(random.number(-25, 25), random.number(-2, 4), random.number(-25, 25)), scale, axis,
                    random.index(3) == 0 ? 0.0 : random.number(0, 6.2)),
             random.index(2) == 0, random.index(8) != 0});
    }
    return scene;
}

inline Camera random_camera(oracle::NearMisses& random) {
    Camera camera;
    camera.position = {random.number(-25, 25), random.number(-1, 3), random.number(-25, 25)};
    camera.forward = glm::dvec3(random.number(-1, 1), random.number(-0.3, 0.2), random.number(-1, 1));
    if (random.index(4) == 0) camera.forward = {0, 0, -1};
    camera.near_distance = random.index(3) == 0 ? 1.0 : 0.1;
    camera.far_distance = random.index(2) == 0 ? std::numeric_limits<double>::infinity() : 200.0;
    if (random.index(6) == 0) {
        camera.projection = Projection::orthographic;
        camera.height = random.number(3.0, 40.0);
        camera.far_distance = 100.0;
    }
    return camera;
}

}  // namespace crofton::testing
