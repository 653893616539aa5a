// SPDX-License-Identifier: MIT
// Scenes that are made to break margins.
#pragma once
#include <algorithm>
#include <cmath>
#include <limits>

#include "depth_scenes.hpp"

namespace crofton::testing {

enum class Hostile {
    coplanar,      // walls one upon the other, or nearly
    fences,        // slats at exactly the same depth, some of them twice
    t_junctions,   // a wall whose rows are cut at different places
    slivers,       // fans of needles of down to a hundredth of a degree
    degenerate,    // a wall with triangles of no area among the others
    dense,         // thousands of triangles in a few pixels
    sizes,         // from a millionth to a million
    through_near,  // the near plane cuts most of it
    inside,        // of a ball and of a box
    poking,        // steep triangles that reach through a wall, or nearly
    needles,       // quads of down to a hundred-thousandth of their length, through the near plane, over a vast ground
    count
};

// A wall of squares in the plane z = 0 over [−1, 1]², moved by up to `bend` along z.
inline TriangleMesh wall(std::uint32_t columns, std::uint32_t rows, double bend, oracle::NearMisses& random) {
    TriangleMesh mesh;
    for (std::uint32_t j = 0; j <= rows; ++j)
        for (std::uint32_t i = 0; i <= columns; ++i) {
            const double z = bend * random.number(-1.0, 1.0);
            mesh.positions.push_back(glm::vec3(2.0 * i / columns - 1.0, 2.0 * j / rows - 1.0, z));
        }
    for (std::uint32_t j = 0; j < rows; ++j)
        for (std::uint32_t i = 0; i < columns; ++i) {
            const std::uint32_t p = j * (columns + 1) + i, q = p + columns + 1;
            for (const std::uint32_t v : {p, p + 1, q + 1, p, q + 1, q}) mesh.indices.push_back(v);
        }
    return mesh;
}

inline void append(TriangleMesh& mesh, const TriangleMesh& other, const glm::vec3& offset, const glm::vec3& scale) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const glm::vec3& p : other.positions) mesh.positions.push_back(p * scale + offset);
    for (const std::uint32_t i : other.indices) mesh.indices.push_back(first + i);
}

// Rows of the wall one above the other, each cut into another number of squares: no vertex of one is one of the next.
inline TriangleMesh t_junctions(oracle::NearMisses& random) {
    TriangleMesh mesh;
    const std::uint32_t rows = 2 + random.index(8);
    for (std::uint32_t r = 0; r < rows; ++r) {
        const float half = 1.0f / float(rows);
        append(mesh, wall(1 + random.index(17), 1, 0.0, random), {0.0f, (2.0f * float(r) + 1.0f) * half - 1.0f, 0.0f},
               {1.0f, half, 1.0f});
    }
    return mesh;
}

// Needles around a common corner, of angles down to 2e-4, some missing, some turned round.
inline TriangleMesh slivers(oracle::NearMisses& random) {
    TriangleMesh mesh;
    mesh.positions.push_back(glm::vec3(0.0f));
    const std::uint32_t n = 3 + random.index(60);
    const double angle = std::exp(random.number(std::log(2e-4), std::log(5e-2)));
    for (std::uint32_t i = 0; i <= n; ++i) {
        const double a = angle * i, r = random.number(0.7, 1.4);
        mesh.positions.push_back(glm::vec3(r * std::cos(a), r * std::sin(a), random.number(-0.02, 0.02)));
    }
    for (std::uint32_t i = 1; i <= n; ++i) {
        if (random.index(9) == 0) continue;
        const bool turned = random.index(20) == 0;
        for (const std::uint32_t v : {0u, turned ? i + 1 : i, turned ? i : i + 1}) mesh.indices.push_back(v);
    }
    if (mesh.indices.empty()) mesh.indices = {0, 1, 2};
    return mesh;
}

inline TriangleMesh with_degenerate(oracle::NearMisses& random) {
    const TriangleMesh whole = wall(6, 6, 0.01, random);
    TriangleMesh mesh;
    mesh.positions = whole.positions;
    for (std::size_t t = 0; t < whole.indices.size(); t += 3) {
        const std::uint32_t a = whole.indices[t], b = whole.indices[t + 1], c = whole.indices[t + 2];
        for (const std::uint32_t v : {a, b, c}) mesh.indices.push_back(v);
        if (random.index(3) != 0) continue;
        // A corner twice; three on a line; the neighbour's edge folded back upon itself.
        const auto middle = static_cast<std::uint32_t>(mesh.positions.size());
        mesh.positions.push_back(0.5f * (mesh.positions[a] + mesh.positions[b]));
        const std::uint32_t more[3][3] = {{a, b, b}, {a, middle, b}, {b, a, b}};
        for (const std::uint32_t v : more[random.index(3)]) mesh.indices.push_back(v);
    }
    return mesh;
}

// Long thin quads around the origin, each of two triangles.
inline TriangleMesh needles(oracle::NearMisses& random) {
    TriangleMesh mesh;
    for (int i = 0; i < 60; ++i) {
        const glm::dvec3 from(random.number(-1, 1), random.number(-1, 1), random.number(-1, 1));
        const glm::dvec3 along = std::exp(random.number(-3.0, 2.0)) * random.direction();
        const glm::dvec3 across = std::exp(random.number(-12.0, -3.0)) * random.direction();
        const auto first = static_cast<std::uint32_t>(mesh.positions.size());
        for (const glm::dvec3& p : {from, from + along, from + along + across, from + across})
            mesh.positions.push_back(glm::vec3(p));
        for (const std::uint32_t v : {0u, 1u, 2u, 0u, 2u, 3u}) mesh.indices.push_back(first + v);
    }
    return mesh;
}

// Small steep triangles around the plane z = 0.
inline TriangleMesh spikes(oracle::NearMisses& random) {
    TriangleMesh mesh;
    for (std::uint32_t i = 0; i < 300; ++i) {
        const double x = random.number(-1.0, 1.0), y = random.number(-1.0, 1.0);
        const double width = std::exp(random.number(-6.0, -2.5)), height = std::exp(random.number(-4.0, -1.0));
        const double reach =
            random.index(3) == 0 ? 0.0 : random.number(-1.0, 1.0) * std::exp(random.number(-12.0, -4.0));
        const double turn = random.number(0.0, 6.2);
        const glm::vec3 along(std::cos(turn), std::sin(turn), 0.0);
        const glm::vec3 tip(x, y, reach), foot(x, y, reach - height);
        const glm::vec3 side(-along.y, along.x, 0.0f);
        for (const glm::vec3& p : {tip, foot + float(width) * (along + side), foot + float(width) * (along - side)}) {
            mesh.indices.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
            mesh.positions.push_back(p);
        }
    }
    return mesh;
}

inline void place(Scene& scene, std::size_t mesh, const glm::dvec3& at, const glm::dvec3& scale,
                  oracle::NearMisses& random, double tilt) {
    const glm::dvec3 axis = random.direction();
    const double angle = random.number(-tilt, tilt);
    const bool one_sided = random.index(2) == 0;
    scene.objects.push_back({&scene.meshes[mesh], placed(at, scale, axis, angle), one_sided, true});
}

// Around the line of sight of a camera at the origin that looks along −z, and moves a little.
inline Scene hostile_scene(Hostile kind, oracle::NearMisses& random) {
    Scene scene;
    const auto cut = [&](TriangleMesh mesh) {
        const std::uint32_t most = 1 + random.index(64);
        scene.meshes.emplace_back(std::move(mesh), most);
    };
    const auto tiny = [&] { return random.number(-1.0, 1.0) * std::exp(random.number(-18.0, -6.0)); };
    switch (kind) {
        case Hostile::coplanar: {
            cut(wall(1 + random.index(9), 1 + random.index(9), 0.0, random));
            cut(wall(1 + random.index(9), 1 + random.index(9), 1e-5, random));
            for (int i = 0; i < 8; ++i) {
                const double z = random.index(3) == 0 ? 0.0 : tiny();
                place(scene, random.index(2), {random.number(-1, 1), random.number(-1, 1), -5.0 + z},
                      glm::dvec3(random.number(0.5, 3.0)), random, random.index(2) == 0 ? 0.0 : 1e-4);
            }
            break;
        }
        case Hostile::fences: {
            cut(cube_mesh());
            cut(wall(1, 5, 0.0, random));
            const double step = random.number(0.05, 0.5);
            for (int i = -12; i <= 12; ++i)
                for (int twice = 0; twice < (i % 3 == 0 ? 2 : 1); ++twice)
                    place(scene, random.index(2), {i * step, 0.0, -4.0}, {0.4 * step, 1.0, 0.05}, random, 0.0);
            place(scene, 1, {0.0, 0.0, -6.0}, glm::dvec3(5.0), random, 0.2);
            break;
        }
        case Hostile::t_junctions:
            for (int i = 0; i < 5; ++i) {
                cut(t_junctions(random));
                place(scene, std::size_t(i), {random.number(-1, 1), random.number(-1, 1), -3.0 - i},
                      glm::dvec3(random.number(1.0, 4.0)), random, 0.4);
            }
            break;
        case Hostile::slivers:
            for (int i = 0; i < 4; ++i) cut(slivers(random));
            for (int i = 0; i < 40; ++i) {
                // In front of the near plane, however they are turned.
                const double away = random.number(2.0, 9.0);
                place(scene, random.index(4), {random.number(-2, 2), random.number(-1, 1), -away},
                      glm::dvec3(random.number(0.02, 0.3) * away), random, 3.0);
            }
            break;
        case Hostile::degenerate:
            for (int i = 0; i < 5; ++i) {
                cut(with_degenerate(random));
                place(scene, std::size_t(i), {random.number(-1, 1), random.number(-1, 1), -3.0 - i},
                      glm::dvec3(random.number(1.0, 4.0)), random, 0.6);
            }
            break;
        case Hostile::dense:
            cut(ball(24, random));
            cut(wall(3, 3, 0.0, random));
            for (int i = 0; i < 12; ++i)
                place(scene, 0, {random.number(-1, 1), random.number(-1, 1), random.number(-6, -2)},
                      glm::dvec3(std::exp(random.number(-7.0, -3.0))), random, 3.0);
            for (int i = 0; i < 3; ++i) place(scene, 1, {0, 0, -3.0 - i}, {0.5, 0.5, 1.0}, random, 0.5);
            break;
        case Hostile::sizes:
            cut(cube_mesh());
            cut(ball(8, random));
            for (int i = 0; i < 40; ++i) {
                const double size = std::exp(random.number(std::log(1e-6), std::log(1e6)));
                const glm::dvec3 way = random.direction();
                place(scene, random.index(2),
                      size * random.number(1.0, 6.0) * glm::dvec3(way.x, way.y, -std::abs(way.z)), glm::dvec3(size),
                      random, 3.0);
            }
            break;
        case Hostile::through_near:
            cut(hills(10, 1.0f, 0.1f, random));
            cut(ball(10, random));
            for (int i = 0; i < 14; ++i)
                place(scene, random.index(2), {random.number(-1, 1), random.number(-1, 1), random.number(-2, 1)},
                      glm::dvec3(std::exp(random.number(-1.0, 3.0))), random, 3.0);
            break;
        case Hostile::inside:
            cut(ball(14, random));
            cut(cube_mesh());
            for (int i = 0; i < 20; ++i)
                place(scene, random.index(2),
                      {random.number(-0.2, 0.2), random.number(-0.2, 0.2), random.number(-0.2, 0.2)},
                      glm::dvec3(random.number(1.0, 9.0)), random, 3.0);
            break;
        case Hostile::needles:
            for (int i = 0; i < 3; ++i) cut(needles(random));
            cut(wall(1 + random.index(2), 1 + random.index(2), 0.0, random));
            scene.objects.push_back(
                {&scene.meshes[3], placed({0.0, -0.6, 0.0}, glm::dvec3(1e5), {1, 0, 0}, -1.5707963267948966)});
            for (int i = 0; i < 12; ++i)
                place(scene, random.index(3), {random.number(-2, 2), random.number(-0.5, 0.5), random.number(-4, 1)},
                      glm::dvec3(std::exp(random.number(-1.0, 1.0))), random, 3.0);
            for (int i = 0; i < 12; ++i)
                place(scene, 3, {random.number(-6, 6), random.number(-0.5, 2), random.number(-9, 1)},
                      glm::dvec3(std::exp(random.number(-2.0, 1.0))), random, 3.0);
            break;
        default:
            cut(wall(1 + random.index(3), 1 + random.index(3), 0.0, random));
            cut(spikes(random));
            for (int i = 0; i < 3; ++i) {
                const glm::dvec3 at(random.number(-1, 1), random.number(-1, 1), -3.0 - i);
                const double size = random.number(1.0, 3.0);
                scene.objects.push_back({&scene.meshes[0], placed(at, glm::dvec3(size), {0, 1, 0}, 0.0)});
                scene.objects.push_back({&scene.meshes[1], placed(at, glm::dvec3(size), {0, 1, 0}, 0.0)});
            }
    }
    return scene;
}

// At `offset` from the origin, as the scene's objects are then: see moved_by().
inline Camera hostile_camera(oracle::NearMisses& random) {
    Camera camera;
    camera.position = {random.number(-0.3, 0.3), random.number(-0.3, 0.3), random.number(-0.3, 0.3)};
    camera.forward = {random.number(-0.2, 0.2), random.number(-0.2, 0.2), -1.0};
    if (random.index(3) == 0) camera.position = {0, 0, 0}, camera.forward = {0, 0, -1};
    camera.near_distance = random.index(4) == 0 ? 0.9 : random.index(3) == 0 ? 1e-3 : 0.1;
    camera.far_distance = random.index(2) == 0 ? std::numeric_limits<double>::infinity() : 200.0;
    if (random.index(5) == 0) {
        camera.projection = Projection::orthographic;
        camera.height = random.number(1.0, 8.0);
        camera.far_distance = 100.0;
    }
    return camera;
}

// Everything 10^6 away from the origin, along each axis.
inline void move_far(Scene& scene, Camera& camera) {
    const glm::dvec3 offset(1e6, -1e6, 1e6);
    camera.position += offset;
    for (PlacedMesh& o : scene.objects) o.world[3] += glm::dvec4(offset, 0.0);
}

}  // namespace crofton::testing
