// SPDX-License-Identifier: MIT
// Scanned and modelled meshes of the shared data, against brute force.
#include <doctest/doctest.h>
#include <algorithm>
#include <crofton/mesh/mesh_distance.hpp>
#include <crofton/mesh/mesh_parts.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <glm/geometric.hpp>
#include <shared_mesh.hpp>

#include "oracle/exact_triangles.hpp"
#include "shape/mesh/meshes.hpp"

using namespace crofton;
using namespace crofton::mesh;
using namespace crofton::testing;

namespace {

struct Posed {
    Vector<Triangle> triangles;
    Vector<glm::dvec3> low, high;
};

Posed posed(const TriangleMesh& mesh, const RigidTransform& pose) {
    Posed result;
    for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
        const Triangle p{transform(pose, vertex(mesh, t, 0)), transform(pose, vertex(mesh, t, 1)),
                         transform(pose, vertex(mesh, t, 2))};
        result.triangles.push_back(p);
        result.low.push_back(glm::min(p[0], glm::min(p[1], p[2])));
        result.high.push_back(glm::max(p[0], glm::max(p[1], p[2])));
    }
    return result;
}

bool bounds_meet(const Posed& a, std::size_t i, const Posed& b, std::size_t j) {
    for (int k = 0; k < 3; ++k)
        if (a.low[i][k] > b.high[j][k] || b.low[j][k] > a.high[i][k]) return false;
    return true;
}

// Triangles that reach into the bound of all of the other mesh; no other can meet it.
Vector<std::uint32_t> within_bound(const Posed& mesh, const Posed& other) {
    Posed whole;
    whole.low.push_back(other.low[0]);
    whole.high.push_back(other.high[0]);
    for (std::size_t i = 0; i < other.low.size(); ++i) {
        whole.low[0] = glm::min(whole.low[0], other.low[i]);
        whole.high[0] = glm::max(whole.high[0], other.high[i]);
    }
    Vector<std::uint32_t> found;
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i)
        if (bounds_meet(mesh, i, whole, 0)) found.push_back(i);
    return found;
}

// Every triangle with every other; the near misses are handed out too.
Vector<TrianglePair> brute_force(const Posed& a, const Posed& b, Vector<TrianglePair>& near_misses) {
    Vector<TrianglePair> pairs;
    const auto of_a = within_bound(a, b), of_b = within_bound(b, a);
    for (const std::uint32_t i : of_a)
        for (const std::uint32_t j : of_b)
            if (bounds_meet(a, i, b, j))
                (intersects(a.triangles[i], b.triangles[j]) ? pairs : near_misses).push_back({i, j});
    return pairs;
}

// Random rotation; along a random direction, a little nearer than where contact ends.
RigidTransform close_pose(std::mt19937_64& random, const mesh::MeshTree& a, const mesh::MeshTree& b) {
    RigidTransform pose = random_pose(random, 0.0);
    const auto center = [](const mesh::MeshTree& tree) {
        const float(&c)[3] = tree.parts().root_box.center;
        return glm::dvec3(double(c[0]), double(c[1]), double(c[2]));
    };
    const glm::dvec3 together = center(a) - pose.rotation * center(b),
                     direction = glm::normalize(random_vector(random));
    double meeting = 0.0, apart = 4.0 * (double(a.extent()) + double(b.extent()));
    for (int step = 0; step < 30; ++step) {
        const double middle = 0.5 * (meeting + apart);
        pose.translation = together + middle * direction;
        (intersects(a, b, pose) ? meeting : apart) = middle;
    }
    pose.translation = together + 0.97 * meeting * direction;
    return pose;
}

}  // namespace

TEST_SUITE("mesh/shared_mesh") {
    TEST_CASE("real meshes in close poses: the very pairs of triangles that brute force finds") {
        if (shared_mesh("cow").positions.empty()) {
            MESSAGE("skipped: no shared data");
            return;
        }
        struct Case {
            const char *a, *b;
            int poses;
        };
        std::mt19937_64 random(21);
        int checked = 0;
        for (const Case& c :
             {Case{"cow", "cow", 2}, Case{"teapot", "cow", 1}, Case{"suzanne", "bunny", 2}, Case{"spider", "woody", 3},
              Case{"fandisk", "suzanne", 2}, Case{"homer", "wuson", 1}, Case{"spider", "armadillo", 1}}) {
            CAPTURE(std::string(c.a) + " and " + c.b);
            const TriangleMesh a = shared_mesh(c.a), b = shared_mesh(c.b);
            const auto tree_a = mesh::MeshTree::build(a), tree_b = mesh::MeshTree::build(b);
            REQUIRE(tree_a.has_value());
            REQUIRE(tree_b.has_value());
            for (int k = 0; k < c.poses; ++k) {
                const RigidTransform pose = close_pose(random, *tree_a, *tree_b);
                const Posed in_a = posed(a, {}), in_b = posed(b, pose);
                Vector<TrianglePair> near_misses, pairs;
                const auto expected = brute_force(in_a, in_b, near_misses);
                intersecting_triangles(*tree_a, *tree_b, pose, pairs);
                CHECK(pairs == expected);
                CHECK(intersects(*tree_a, *tree_b, pose) == !expected.empty());
                // What brute force goes by, against rational arithmetic.
                for (std::size_t i = 0; i < std::min<std::size_t>(10, expected.size()); ++i, ++checked)
                    CHECK(
                        oracle::triangles_meet(in_a.triangles[expected[i].first], in_b.triangles[expected[i].second]));
                for (std::size_t i = 0; i < std::min<std::size_t>(10, near_misses.size()); ++i, ++checked)
                    CHECK_FALSE(oracle::triangles_meet(in_a.triangles[near_misses[i].first],
                                                       in_b.triangles[near_misses[i].second]));
            }
        }
        CHECK(checked > 100);
    }

    TEST_CASE("a mesh laid on itself meets itself in every triangle and its neighbours") {
        const TriangleMesh mesh = shared_mesh("suzanne");
        if (mesh.positions.empty()) {
            MESSAGE("skipped: no shared data");
            return;
        }
        const auto tree = mesh::MeshTree::build(mesh);
        const Posed in_place = posed(mesh, {});
        Vector<TrianglePair> near_misses, pairs;
        intersecting_triangles(*tree, *tree, {}, pairs);
        CHECK(pairs == brute_force(in_place, in_place, near_misses));
        CHECK(pairs.size() > 10 * mesh.triangle_count());
    }
}
