// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <hwy/targets.h>
#include <algorithm>
#include <bit>
#include <cmath>
#include <crofton/mesh/mesh_distance.hpp>
#include <crofton/mesh/mesh_parts.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <cstring>
#include <error_of.hpp>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include "../../backwards.hpp"
#include "../../ranges.hpp"
#include "shape/mesh/meshes.hpp"

using namespace crofton;
using namespace crofton::mesh;
using namespace crofton::testing;

namespace {

TriangleMesh random_triangles(std::size_t count, float spread) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> number(-1.0f, 1.0f);
    TriangleMesh mesh;
    for (std::size_t t = 0; t < count; ++t) {
        const glm::vec3 place(spread * number(random), spread * number(random), 3.0f * number(random));
        for (int v = 0; v < 3; ++v) {
            mesh.indices.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
            mesh.positions.push_back(place + 0.1f * glm::vec3(number(random), number(random), number(random)));
        }
    }
    return mesh;
}

// A ring of radius 2 and thickness 1.
TriangleMesh torus(std::uint32_t around, std::uint32_t across) {
    TriangleMesh mesh;
    for (std::uint32_t i = 0; i < around; ++i)
        for (std::uint32_t j = 0; j < across; ++j) {
            const double a = 6.283185307 * i / around, b = 6.283185307 * j / across, r = 2.0 + 0.5 * std::cos(b);
            mesh.positions.push_back(glm::vec3(glm::dvec3(r * std::cos(a), r * std::sin(a), 0.5 * std::sin(b))));
            const std::uint32_t i1 = (i + 1) % around, j1 = (j + 1) % across;
            for (const std::uint32_t v :
                 {i * across + j, i1 * across + j, i1 * across + j1, i * across + j, i1 * across + j1, i * across + j1})
                mesh.indices.push_back(v);
        }
    return mesh;
}

template <class T>
bool same_bytes(const Vector<T>& a, const Vector<T>& b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

double edge_sum(const MeshTree& tree) {
    double sum = 0.0;
    for (const MeshNode& node : tree.parts().nodes)
        for (std::uint32_t lane = 0; lane < node.count; ++lane)
            for (int k = 0; k < 3; ++k) sum += 2.0 * double(node.half[k][lane]);
    return sum;
}

// By how much a point sticks out of lane `lane`'s box, along its axes.
double excess(const MeshNode& node, std::uint32_t lane, const glm::vec3& p) {
    double worst = -std::numeric_limits<double>::infinity();
    for (int k = 0; k < 3; ++k) {
        double along = 0.0;
        for (int i = 0; i < 3; ++i)
            along += (double(p[i]) - double(node.center[i][lane])) * double(node.axes[k][i][lane]);
        worst = std::max(worst, std::abs(along) - double(node.half[k][lane]));
    }
    return worst;
}

// Every triangle below `node` lies in each box above it; returns how often each triangle occurs and the depth.
void walk(const MeshTree& tree, std::uint32_t node, int depth, std::vector<int>& seen, int& deepest,
          const TriangleMesh& mesh) {
    deepest = std::max(deepest, depth);
    const MeshNode& n = tree.parts().nodes[node];
    REQUIRE(n.count >= 1);
    for (std::uint32_t lane = 0; lane < n.count; ++lane) {
        std::vector<int> below(seen.size(), 0);
        if (n.child[lane] & kMeshLeaf) {
            const MeshLeaf& leaf = tree.parts().leaves[n.child[lane] & ~kMeshLeaf];
            REQUIRE(leaf.count >= 1);
            for (std::uint32_t i = 0; i < leaf.count; ++i) {
                ++below[leaf.triangle[i]];
                for (int v = 0; v < 3; ++v)
                    for (int c = 0; c < 3; ++c)
                        CHECK(leaf.vertex[v][c][i] ==
                              mesh.positions[mesh.indices[3 * leaf.triangle[i] + std::size_t(v)]][c]);
            }
        } else {
            walk(tree, n.child[lane], depth + 1, below, deepest, mesh);
        }
        for (std::size_t t = 0; t < below.size(); ++t) {
            seen[t] += below[t];
            if (below[t] == 0) continue;
            for (std::size_t v = 0; v < 3; ++v) CHECK(excess(n, lane, mesh.positions[mesh.indices[3 * t + v]]) <= 0.0);
        }
    }
}

}  // namespace

TEST_SUITE("mesh/mesh_tree") {
    TEST_CASE("no triangles, ragged indices and vertices that are NaN are errors") {
        TriangleMesh mesh;
        CHECK(error_of(MeshTree::build(mesh)).code == ErrorCode::empty);
        mesh = random_triangles(3, 1.0f);
        mesh.indices.pop_back();
        CHECK(error_of(MeshTree::build(mesh)).code == ErrorCode::invalid_argument);
        mesh = random_triangles(3, 1.0f);
        for (glm::vec3& p : mesh.positions) p.x = std::numeric_limits<float>::quiet_NaN();
        CHECK(error_of(MeshTree::build(mesh)).code == ErrorCode::empty);
    }

    TEST_CASE("bad triangles are listed and the others kept") {
        TriangleMesh mesh = random_triangles(20, 1.0f);
        mesh.positions[7].y = std::numeric_limits<float>::infinity();
        mesh.positions[30].z = 3e12f;
        mesh.indices[3 * 15] = 4000;
        const auto tree = MeshTree::build(mesh).value();
        CHECK(test::ranges::equal(tree.rejected(), std::vector<std::uint32_t>{2, 10, 15}));
        CHECK(tree.triangle_count() == 17);
    }

    TEST_CASE("every triangle is in exactly one leaf and in every box above it, only the root has few children") {
        for (const std::size_t count : {1u, 8u, 9u, 100u, 129u, 2049u, 2100u, 5000u}) {
            const TriangleMesh mesh = random_triangles(count, 30.0f);
            for (const MeshBoxes boxes :
                 {MeshBoxes::small_perimeter, MeshBoxes::principal_axes, MeshBoxes::least_perimeter}) {
                const auto tree = MeshTree::build(mesh, {boxes}).value();
                std::vector<int> seen(count, 0);
                int deepest = 0;
                walk(tree, 0, 1, seen, deepest, mesh);
                CHECK(test::ranges::all_of(seen, [](int n) { return n == 1; }));
                int levels = 1;
                for (std::size_t leaves = 16; 8 * leaves < count; leaves *= 16) ++levels;
                CHECK(deepest == levels);
                for (const MeshNode& node : std::span(tree.parts().nodes).subspan(1)) CHECK(node.count >= 8);
            }
        }
    }

    TEST_CASE("boxes of small perimeter are near the least that fit finds, and well below principal axes") {
        const TriangleMesh mesh = torus(40, 30);
        const double principal = edge_sum(*MeshTree::build(mesh, {MeshBoxes::principal_axes}));
        const double small = edge_sum(*MeshTree::build(mesh)),
                     least = edge_sum(*MeshTree::build(mesh, {MeshBoxes::least_perimeter}));
        CAPTURE(principal / least);
        CAPTURE(small / least);
        CHECK(least <= small);
        CHECK(small < 1.02 * least);
        CHECK(principal > 1.03 * least);
    }

    TEST_CASE("gives the same boxes on every instruction set") {
        const TriangleMesh mesh = random_triangles(3000, 5.0f);
        const MeshTree expected = *MeshTree::build(mesh);
        for (std::int64_t rest = hwy::SupportedTargets(); rest != 0; rest &= rest - 1) {
            hwy::SetSupportedTargetsForTest(rest & -rest);
            const MeshTree tree = *MeshTree::build(mesh);
            CHECK(std::memcmp(tree.parts().nodes.data(), expected.parts().nodes.data(),
                              tree.parts().nodes.size() * sizeof(MeshNode)) == 0);
        }
        hwy::SetSupportedTargetsForTest(0);
    }

    TEST_CASE("identical triangles, points and segments build a tree of bounded depth") {
        TriangleMesh mesh;
        mesh.positions = {glm::vec3(1.0f), glm::vec3(1.0f, 2.0f, 1.0f), glm::vec3(0.0f)};
        for (int t = 0; t < 3000; ++t)
            for (std::uint32_t v = 0; v < 3; ++v)
                mesh.indices.push_back(t % 3 == 0 ? v : std::min(v, 1u) * std::uint32_t(t % 3 - 1));
        const auto tree = MeshTree::build(mesh).value();
        std::vector<int> seen(3000, 0);
        int deepest = 0;
        walk(tree, 0, 1, seen, deepest, mesh);
        CHECK(deepest <= 6);
    }

    TEST_CASE("positions that all want one place of the table are still told apart") {
        // As mesh_pieces.cpp places 3 · 150 vertices.
        constexpr std::size_t kTriangles = 150;
        const auto place_of = [](const glm::vec3& p) {
            const std::uint64_t xy =
                std::bit_cast<std::uint32_t>(p.x) | std::uint64_t{std::bit_cast<std::uint32_t>(p.y)} << 32;
            const std::uint64_t mixed = xy * 0x9e3779b97f4a7c15u + std::bit_cast<std::uint32_t>(p.z);
            return ((mixed ^ (mixed >> 29)) * 0xbf58476d1ce4e5b9u) >> 54;
        };
        std::mt19937_64 random(8);
        std::vector<glm::vec3> places;
        while (places.size() < 6 * kTriangles)
            if (const glm::vec3 p(random_vector(random)); place_of(p) == 5) places.push_back(p);
        TriangleMesh mesh;
        for (std::uint32_t v = 0; v < 3 * kTriangles; ++v) {
            mesh.indices.push_back(v);
            mesh.positions.push_back(places[random() % places.size()]);
        }
        // Oracle: each triangle takes the lowest number of all that it shares a position with, until nothing changes.
        std::vector<std::size_t> piece(kTriangles);
        for (std::size_t t = 0; t < kTriangles; ++t) piece[t] = t;
        for (bool changed = true; changed;) {
            changed = false;
            for (std::size_t v = 0; v < 3 * kTriangles; ++v)
                for (std::size_t w = 0; w < 3 * kTriangles; ++w)
                    if (mesh.positions[v] == mesh.positions[w] && piece[w / 3] < piece[v / 3])
                        piece[v / 3] = piece[w / 3], changed = true;
        }
        std::size_t expected = 0;
        for (std::size_t t = 0; t < kTriangles; ++t) expected += piece[t] == t;
        CHECK(expected > 3);
        CHECK(expected < kTriangles);
        CHECK(MeshTree::build(mesh)->pieces().size() == expected);
    }

    TEST_CASE("the same mesh gives the same tree, with any executor") {
        for (const std::size_t count : {1u, 9u, 130u, 1000u, 40000u})
            for (const bool refittable : {false, true}) {
                CAPTURE(count);
                CAPTURE(refittable);
                const TriangleMesh mesh = random_triangles(count, 5.0f);
                const MeshTreeOptions options{.refittable = refittable, .rays = true};
                const MeshTree expected = MeshTree::build(mesh, options).value();
                const auto check = [&](Executor& executor) {
                    const MeshTree tree = MeshTree::build(mesh, options, executor).value();
                    const MeshParts &one = expected.parts(), &two = tree.parts();
                    CHECK(same_bytes(one.nodes, two.nodes));
                    CHECK(same_bytes(one.leaves, two.leaves));
                    CHECK(same_bytes(one.ray_nodes, two.ray_nodes));
                    CHECK(same_bytes(one.refit.nodes, two.refit.nodes));
                    CHECK(same_bytes(one.refit.leaves, two.refit.leaves));
                    CHECK(std::memcmp(&one.root_box, &two.root_box, sizeof one.root_box) == 0);
                    CHECK(std::memcmp(&one.refit.root, &two.refit.root, sizeof one.refit.root) == 0);
                };
                check(serial_executor());
                for (const unsigned threads : {1u, 3u, 16u}) {
                    Backwards backwards(threads);
                    check(backwards);
                    ThreadPool pool(threads);
                    check(pool);
                }
            }
    }

    TEST_CASE("a moved-from tree has no triangles, and may be assigned another") {
        const RigidTransform here;
        MeshTree first = tree_of(cube_mesh(1.0f)), second = std::move(first);
        CHECK(first.triangle_count() == 0);
        CHECK(first.extent() == 0.0f);
        CHECK_FALSE(intersects(first, second, here));
        CHECK_FALSE(contains(first, {0.0, 0.0, 0.0}));
        CHECK_FALSE(raycast(Ray{{-5.0, 0.1, 0.2}, {1.0, 0.0, 0.0}}, first).has_value());
        first = std::move(second);
        CHECK(contains(first, {0.0, 0.0, 0.0}));
        CHECK(second.triangle_count() == 0);
        CHECK_FALSE(closer_than(second, first, here, 1.0));
    }
}
