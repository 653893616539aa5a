// SPDX-License-Identifier: MIT
// The nearest triangle to a point, and the side on which a point is: in meshes of few leaves and of many, against all
// triangles one by one.
#include <doctest/doctest.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/geometry/closest_points.hpp>
#include <crofton/mesh/mesh_distance.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <cstdint>
#include <map>
#include <random>

#include "shape/mesh/meshes.hpp"

using namespace crofton;
using namespace crofton::mesh;
using namespace crofton::testing;

namespace {

using Grid = std::array<std::int64_t, 3>;

Grid minus(const Grid& a, const Grid& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Grid cross(const Grid& a, const Grid& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
std::int64_t dot(const Grid& a, const Grid& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
int orientation(const Grid& a, const Grid& b, const Grid& c, const Grid& d) {
    const std::int64_t det = dot(cross(minus(b, a), minus(c, a)), minus(d, a));
    return det > 0 ? 1 : det < 0 ? -1 : 0;
}

using GridTriangle = std::array<Grid, 3>;

bool is_on(const Grid& p, const GridTriangle& t) {
    for (std::size_t k = 0; k < 3; ++k) {
        const Grid u = minus(t[k], p), v = minus(t[(k + 1) % 3], p);
        if (cross(u, v) == Grid{} && dot(u, v) <= 0) return true;
    }
    const Grid n = cross(minus(t[1], t[0]), minus(t[2], t[0]));
    if (n == Grid{} || dot(n, minus(p, t[0])) != 0) return false;
    for (std::size_t k = 0; k < 3; ++k)
        if (dot(cross(minus(t[(k + 1) % 3], t[k]), minus(p, t[k])), n) < 0) return false;
    return true;
}

// By the crossings of a segment in general position, in integers.
bool is_inside(const Grid& p, const std::vector<GridTriangle>& triangles, std::mt19937_64& random) {
    for (const GridTriangle& t : triangles)
        if (is_on(p, t)) return true;
    for (;;) {
        Grid q;
        for (std::int64_t& x : q) x = std::int64_t(random() % 400001) - 200000;
        if (*std::max_element(q.begin(), q.end()) < 100000) continue;
        bool inside = false, general = true;
        for (const GridTriangle& t : triangles) {
            const int from = orientation(t[0], t[1], t[2], p), to = orientation(t[0], t[1], t[2], q);
            const int a = orientation(p, q, t[0], t[1]), b = orientation(p, q, t[1], t[2]),
                      c = orientation(p, q, t[2], t[0]);
            const bool is_flat = cross(minus(t[1], t[0]), minus(t[2], t[0])) == Grid{};
            // From a point beside a triangle in its plane no ray crosses it. A ray that meets an edge is drawn again.
            if (is_flat || (from == 0 && to != 0)) continue;
            general = general && to != 0 && a * b * c != 0;
            if (from != to && a == b && b == c) inside = !inside;
        }
        if (general) return inside;
    }
}

// Faces of n × n squares.
TriangleMesh divided_box(const glm::vec3& low, const glm::vec3& high, int n) {
    TriangleMesh mesh;
    std::map<std::array<int, 3>, std::uint32_t> known;
    const auto vertex_at = [&](const std::array<int, 3>& at) {
        const auto [place, is_new] = known.emplace(at, std::uint32_t(mesh.positions.size()));
        glm::vec3 p;
        for (std::size_t k = 0; k < 3; ++k) {
            const auto i = glm::length_t(k);
            p[i] = at[k] == n ? high[i] : low[i] + (high[i] - low[i]) * float(at[k]) / float(n);
        }
        if (is_new) mesh.positions.push_back(p);
        return place->second;
    };
    for (std::size_t k = 0; k < 3; ++k)
        for (const int side : {0, n})
            for (int i = 0; i < n; ++i)
                for (int j = 0; j < n; ++j) {
                    std::uint32_t corner[4];
                    for (int c = 0; c < 4; ++c) {
                        std::array<int, 3> at{};
                        at[k] = side;
                        at[(k + 1) % 3] = i + (c == 1 || c == 2 ? 1 : 0);
                        at[(k + 2) % 3] = j + (c >= 2 ? 1 : 0);
                        corner[c] = vertex_at(at);
                    }
                    if (side == 0) std::swap(corner[1], corner[3]);
                    for (const int c : {0, 1, 2, 0, 2, 3}) mesh.indices.push_back(corner[c]);
                }
    return mesh;
}

void shuffle_triangles(TriangleMesh& mesh, std::mt19937_64& random) {
    for (std::size_t t = mesh.triangle_count(); t-- > 1;) {
        const std::size_t other = random() % (t + 1);
        for (std::size_t v = 0; v < 3; ++v) std::swap(mesh.indices[3 * t + v], mesh.indices[3 * other + v]);
    }
}

// All vertices are integers times `unit`, a power of two.
std::vector<GridTriangle> grid_of(const TriangleMesh& mesh, float unit) {
    std::vector<GridTriangle> triangles(mesh.triangle_count());
    for (std::size_t t = 0; t < triangles.size(); ++t)
        for (std::size_t v = 0; v < 3; ++v)
            for (std::size_t i = 0; i < 3; ++i)
                triangles[t][v][i] = std::int64_t(vertex(mesh, t, v)[glm::length_t(i)] / double(unit));
    return triangles;
}

struct Least {
    double squared = std::numeric_limits<double>::infinity();
    std::size_t triangle = 0;
};
Least least_of(const TriangleMesh& mesh, const glm::dvec3& point) {
    Least least;
    for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
        const glm::dvec3 way = point - closest_on_triangle(point, triangle(mesh, t, {}));
        if (glm::dot(way, way) < least.squared) least = {glm::dot(way, way), t};
    }
    return least;
}

void check_nearest(const TriangleMesh& mesh, const MeshTree& tree, const glm::dvec3& point, double size) {
    const MeshDistance found = distance_to_point(tree, point);
    const double least = std::sqrt(least_of(mesh, point).squared), slack = 1e-12 * size;
    CHECK(std::abs(found.distance - least) <= slack);
    CHECK(found.on_b == point);
    CHECK(std::abs(glm::distance(found.on_a, point) - found.distance) <= slack);
    const Triangle named = triangle(mesh, found.triangles.first, {});
    CHECK(glm::distance(found.on_a, closest_on_triangle(found.on_a, named)) <= slack);
}

}  // namespace

TEST_SUITE("mesh/near_point") {
    TEST_CASE("if several triangles are exactly as near to a point, the first is named, however they lie in the tree") {
        std::mt19937_64 random(4601);
        int ties = 0;
        for (int trial = 0; trial < 60; ++trial) {
            const int n = 1 << (trial % 4);  // 12, 48, 192, 768 triangles
            TriangleMesh mesh = divided_box({-4, -8, -16}, {4, 8, 16}, n);
            shuffle_triangles(mesh, random);
            const MeshTree tree = tree_of(mesh);
            for (int i = 0; i < 100; ++i) {
                // Middles, bisectors of faces, points over edges and diagonals, on the surface, and outside.
                glm::dvec3 point;
                for (glm::length_t k = 0; k < 3; ++k) point[k] = double(int(random() % 41)) - 20.0;
                if (i % 4 == 0) point.y = point.x > 0.0 ? 12.0 - point.x : point.x;
                if (i % 4 == 1) point = glm::dvec3(0.0, 0.0, point.z);
                if (i % 4 == 2) point *= 0.25;
                const MeshDistance found = distance_to_point(tree, point);
                const Least least = least_of(mesh, point);
                REQUIRE(found.distance == std::sqrt(least.squared));
                CHECK(found.triangles.first == least.triangle);
                CHECK(glm::distance(found.on_a, point) == found.distance);
                int equal = 0;
                for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
                    const glm::dvec3 way = point - closest_on_triangle(point, triangle(mesh, t, {}));
                    equal += glm::dot(way, way) == least.squared ? 1 : 0;
                }
                ties += equal > 1 ? 1 : 0;
            }
        }
        CHECK(ties > 2000);
    }

    TEST_CASE("the nearest point is that of all triangles: near and far, large and tiny, slivers and flat ones") {
        std::mt19937_64 random(4602);
        for (int trial = 0; trial < 400; ++trial) {
            TriangleMesh mesh = trial % 2 == 0 ? divided_box({-0.7f, -0.3f, -1.9f}, {1.3f, 0.3f, 2.1f}, 1 + trial % 3)
                                               : wavy_torus(1.0, 0.3, 0.2, 5 + std::uint32_t(trial) % 8, 4);
            const float scale = std::exp2(float(int(random() % 60)) - 40.0f);
            const glm::vec3 place =
                trial % 3 == 0 ? glm::vec3(1e4 * double(scale) * random_vector(random)) : glm::vec3(0.0f);
            const float thin = std::array{1.0f, 1.0f, 0.05f, 0.02f, 1e-3f, 1e-6f, 0.0f}[std::size_t(trial % 7)];
            for (glm::vec3& p : mesh.positions) p = scale * glm::vec3(p.x, thin * p.y, p.z) + place;
            shuffle_triangles(mesh, random);
            const MeshTree tree = tree_of(mesh);
            for (int i = 0; i < 40; ++i) {
                const Triangle t = triangle(mesh, random() % mesh.triangle_count(), {});
                const double away = std::pow(10.0, double(i % 9) - 6.0) * double(scale);
                glm::dvec3 point = i % 4 == 0 ? t[0] : i % 4 == 1 ? 0.5 * (t[0] + t[1]) : (t[0] + t[1] + t[2]) / 3.0;
                if (i % 4 == 3) point = glm::dvec3(place);
                point += away * random_vector(random);
                const double size = glm::length(point) + glm::length(glm::dvec3(place)) + 4.0 * double(scale);
                check_nearest(mesh, tree, point, size);
            }
        }
    }

    TEST_CASE("the nearest of thousands of triangles that are nearly as near is found") {
        std::mt19937_64 random(4603);
        for (const double unevenness : {0.0, 1e-9, 1e-7, 1e-5, 1e-3}) {
            TriangleMesh ball = wavy_torus(0.0, 1.0, unevenness, 40, 20);
            shuffle_triangles(ball, random);
            const MeshTree tree = tree_of(ball);
            for (int i = 0; i < 10; ++i) {
                const glm::dvec3 point = (i == 0 ? 0.0 : std::pow(10.0, -double(i))) * random_vector(random);
                check_nearest(ball, tree, point, 2.0);
            }
        }
    }

    TEST_CASE("a point is inside of closed meshes by the parity of crossings, exactly") {
        std::mt19937_64 random(4604);
        int inside = 0, outside = 0;
        for (int trial = 0; trial < 120; ++trial) {
            TriangleMesh mesh;
            const int kind = trial % 4;
            if (kind == 0) mesh = divided_box({-600, -700, -800}, {500, 900, 300}, 1);
            if (kind == 1) {  // boxes in each other, through each other, and side by side
                for (int box = 0; box < 1 + trial % 7; ++box) {
                    glm::vec3 low, high;
                    for (glm::length_t k = 0; k < 3; ++k) {
                        low[k] = float(random() % 900) - 900.0f;
                        high[k] = float(random() % 900);
                    }
                    const TriangleMesh one = divided_box(low, high, 1);
                    const auto first = std::uint32_t(mesh.positions.size());
                    for (const std::uint32_t index : one.indices) mesh.indices.push_back(first + index);
                    mesh.positions.insert(mesh.positions.end(), one.positions.begin(), one.positions.end());
                }
            }
            if (kind >= 2) {
                mesh = wavy_torus(kind == 2 ? 600.0 : 0.0, 300.0, 0.3, 6 + std::uint32_t(trial) % 30,
                                  4 + std::uint32_t(trial) % 9);
                if (trial % 5 == 0)
                    for (glm::vec3& p : mesh.positions) p.y *= 0.01f;  // folds and triangles without area
                for (glm::vec3& p : mesh.positions) p = glm::round(p);
            }
            shuffle_triangles(mesh, random);
            const std::vector<GridTriangle> grid = grid_of(mesh, 1.0f);
            const float unit = std::exp2(float(int(random() % 86)) - 60.0f);
            TriangleMesh scaled = mesh;
            for (glm::vec3& p : scaled.positions) p *= unit;
            const MeshTree tree = tree_of(scaled);
            REQUIRE(tree.pieces().front().closed);
            for (int i = 0; i < 150; ++i) {
                // On vertices and beside them, straight below vertices and edges, on walls, anywhere.
                const GridTriangle& t = grid[random() % grid.size()];
                Grid p;
                for (std::size_t k = 0; k < 3; ++k) {
                    p[k] = t[0][k];
                    if (i % 4 == 1) p[k] = (t[0][k] + t[1][k]) / 2;
                    if (i % 4 == 2) p[k] = (t[0][k] + t[1][k] + t[2][k]) / 3;
                    if (i % 4 == 3 || (k == 2 && i % 3 == 0)) p[k] = std::int64_t(random() % 1801) - 900;
                    if (i % 5 == 0) p[k] += std::int64_t(random() % 3) - 1;
                }
                const bool expected = is_inside(p, grid, random);
                const glm::dvec3 point = double(unit) * glm::dvec3(p[0], p[1], p[2]);
                CHECK(contains(tree, point) == expected);
                ++(expected ? inside : outside);
            }
        }
        CHECK(inside > 3000);
        CHECK(outside > 3000);
    }

    TEST_CASE(
        "a point an ulp off a wall is on that side of it, wherever the house stands, and an open one holds none") {
        std::mt19937_64 random(4605);
        for (int trial = 0; trial < 300; ++trial) {
            const glm::vec3 middle(std::exp2(double(trial % 20)) * random_vector(random));
            const glm::vec3 low = middle - glm::vec3(6, 6, 6), high = middle + glm::vec3(6, 5, 4);
            TriangleMesh mesh = divided_box(low, high, 1 + trial % 2);
            shuffle_triangles(mesh, random);
            const MeshTree tree = tree_of(mesh);
            TriangleMesh open = mesh;
            open.indices.resize(open.indices.size() - 3);
            const MeshTree open_tree = tree_of(open);
            for (int i = 0; i < 24; ++i) {
                glm::dvec3 point;
                for (glm::length_t k = 0; k < 3; ++k)
                    point[k] = std::uniform_real_distribution<double>(double(low[k]), double(high[k]))(random);
                if (i % 4 == 0) point = 0.5 * (glm::dvec3(low) + glm::dvec3(high));  // over the diagonals
                CHECK(contains(tree, point));
                const glm::length_t k = i % 3;
                point[k] = i % 2 == 0 ? double(low[k]) : double(high[k]);
                CHECK(contains(tree, point));
                CHECK(distance_to_point(tree, point).distance == 0.0);
                CHECK_FALSE(contains(open_tree, point));
                glm::dvec3 beside = point;
                beside[k] = std::nextafter(point[k], double(middle[k]));
                CHECK(contains(tree, beside));
                CHECK(distance_to_point(tree, beside).distance == doctest::Approx(std::abs(beside[k] - point[k])));
                beside[k] = std::nextafter(point[k], 2.0 * point[k] - double(middle[k]));
                CHECK_FALSE(contains(tree, beside));
                CHECK(distance_to_point(tree, beside).distance > 0.0);
            }
        }
    }

    TEST_CASE("meshes that stand turned contain a small one where its middle is inside, and only there") {
        std::mt19937_64 random(4606);
        const auto pea = tree_of(cube_mesh(1e-3f));
        int inside = 0;
        for (int trial = 0; trial < 2000; ++trial) {
            const int n = 1 + trial % 4;
            const MeshTree box = tree_of(divided_box({-1, -2, -3}, {1, 1, 1}, n));
            const RigidTransform pose = random_pose(random, trial % 2 == 0 ? 1.0 : 100.0);
            const glm::dvec3 at = 2.5 * random_vector(random);
            double depth = std::min(std::min(1.0 - std::abs(at.x), 1.0 - at.y), 1.0 - at.z);
            depth = std::min(depth, std::min(2.0 + at.y, 3.0 + at.z));
            if (std::abs(depth) < 3e-3) continue;
            const RigidTransform of_pea{glm::dmat3(1.0), transform(pose, at)};
            const Containment in_box = containment_of_disjoint(box, pea, relative(pose, of_pea)),
                              of_box = containment_of_disjoint(pea, box, relative(of_pea, pose));
            CHECK(in_box == (depth > 0.0 ? Containment::b_inside_a : Containment::none));
            CHECK(of_box == (depth > 0.0 ? Containment::a_inside_b : Containment::none));
            inside += depth > 0.0 ? 1 : 0;
        }
        CHECK(inside > 300);
    }
}
