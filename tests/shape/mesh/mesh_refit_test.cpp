// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <hwy/targets.h>
#include <algorithm>
#include <cmath>
#include <crofton/mesh/mesh_distance.hpp>
#include <crofton/mesh/mesh_parts.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <cstring>
#include <error_of.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <random>
#include <vector>

#include "shape/mesh/meshes.hpp"

using namespace crofton;
using namespace crofton::mesh;
using namespace crofton::testing;

namespace {

MeshTree refittable(const TriangleMesh& mesh) {
    return MeshTree::build(mesh, {.refittable = true}).value();
}

// Bent and twisted about z, by `much`.
TriangleMesh bent(const TriangleMesh& mesh, double much) {
    TriangleMesh result = mesh;
    for (glm::vec3& p : result.positions) {
        const double angle = much * double(p.x), s = std::sin(angle), c = std::cos(angle);
        p = glm::vec3(glm::dvec3(double(p.x) + much * double(p.z) * double(p.z), c * double(p.y) - s * double(p.z),
                                 s * double(p.y) + c * double(p.z)));
    }
    return result;
}

double total_half_extents(const MeshTree& tree) {
    double sum = 0.0;
    for (const MeshNode& node : tree.parts().nodes)
        for (std::uint32_t lane = 0; lane < node.count; ++lane)
            for (int k = 0; k < 3; ++k) sum += double(node.half[k][lane]);
    return sum;
}

// A box holds p: p − c = Σ t_k axis_k with |t_k| ≤ half_k, solved by Cramer's rule for axes that need not be
// orthogonal.
bool holds(const glm::dmat3& axes, const glm::dvec3& center, const glm::dvec3& half, const glm::dvec3& p) {
    const glm::dvec3 d = p - center;
    const double whole = glm::dot(glm::cross(axes[0], axes[1]), axes[2]);
    for (int k = 0; k < 3; ++k)
        if (std::abs(glm::dot(glm::cross(axes[(k + 1) % 3], axes[(k + 2) % 3]), d) / whole) > half[k]) return false;
    return true;
}

struct DoubleBox {
    glm::dmat3 axes;
    glm::dvec3 center, half;
};

// Calls visit(box, triangle) for every box and every triangle below it.
template <class Visit>
void for_each_below(const MeshTree& tree, std::uint32_t node, std::vector<DoubleBox>& above, Visit visit) {
    const MeshNode& n = tree.parts().nodes[node];
    for (std::uint32_t lane = 0; lane < n.count; ++lane) {
        DoubleBox box{};
        for (int k = 0; k < 3; ++k) {
            box.center[k] = double(n.center[k][lane]);
            box.half[k] = double(n.half[k][lane]);
            for (int i = 0; i < 3; ++i) box.axes[k][i] = double(n.axes[k][i][lane]);
        }
        above.push_back(box);
        if (n.child[lane] & kMeshLeaf) {
            const MeshLeaf& leaf = tree.parts().leaves[n.child[lane] & ~kMeshLeaf];
            for (std::uint32_t i = 0; i < leaf.count; ++i)
                for (const DoubleBox& one : above) visit(one, leaf.triangle[i]);
        } else {
            for_each_below(tree, n.child[lane], above, visit);
        }
        above.pop_back();
    }
}

void check_boxes(const MeshTree& tree, const TriangleMesh& mesh) {
    std::vector<DoubleBox> above;
    std::size_t outside = 0, skew = 0;
    for_each_below(tree, 0, above, [&](const DoubleBox& box, std::uint32_t triangle) {
        for (std::size_t v = 0; v < 3; ++v)
            outside += !holds(box.axes, box.center, box.half, vertex(mesh, triangle, v));
        const glm::dmat3 gram = glm::transpose(box.axes) * box.axes;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                skew += std::abs(gram[i][j] - (i == j ? 1.0 : 0.0)) > 1.5e-6;  // as MeshNode says
    });
    const MeshBox& stored = tree.parts().root_box;
    DoubleBox root{};
    for (int k = 0; k < 3; ++k) {
        root.center[k] = double(stored.center[k]);
        root.half[k] = double(stored.half[k]);
        for (int i = 0; i < 3; ++i) root.axes[k][i] = double(stored.axes[k][i]);
    }
    for (std::uint32_t t = 0; t < tree.triangle_count(); ++t)
        for (std::size_t v = 0; v < 3; ++v) outside += !holds(root.axes, root.center, root.half, vertex(mesh, t, v));
    CHECK(outside == 0);
    CHECK(skew == 0);
}

bool same_bits(const MeshTree& a, const MeshTree& b) {
    return a.parts().nodes.size() == b.parts().nodes.size() && a.extent() == b.extent() &&
           std::memcmp(a.parts().nodes.data(), b.parts().nodes.data(), a.parts().nodes.size() * sizeof(MeshNode)) ==
               0 &&
           std::memcmp(a.parts().leaves.data(), b.parts().leaves.data(), a.parts().leaves.size() * sizeof(MeshLeaf)) ==
               0 &&
           std::memcmp(&a.parts().root_box, &b.parts().root_box, sizeof(MeshBox)) == 0;
}

}  // namespace

TEST_SUITE("mesh/mesh_refit") {
    TEST_CASE(
        "a tree that keeps no vertices, another count of positions and a bad vertex are errors that change nothing") {
        const TriangleMesh mesh = wavy_torus(2.0, 0.5, 0.1);
        MeshTree fixed = *MeshTree::build(mesh), tree = refittable(mesh);
        const MeshTree before = tree;
        CHECK(error_of(fixed.refit(mesh.positions)).code == ErrorCode::invalid_argument);
        CHECK(error_of(tree.refit(std::span(mesh.positions).first(5))).code == ErrorCode::invalid_argument);
        TriangleMesh bad = bent(mesh, 0.2);
        bad.positions[17].y = std::numeric_limits<float>::quiet_NaN();
        bad.positions[40].x = 3e12f;
        const auto result = tree.refit(bad.positions);
        REQUIRE_FALSE(result.has_value());
        CHECK(error_of(result).code == ErrorCode::non_finite);
        CHECK(error_of(result).item == 17);
        CHECK(same_bits(tree, before));
        // A vertex of no triangle may be anything.
        TriangleMesh loose = mesh;
        loose.positions.push_back(glm::vec3(std::numeric_limits<float>::infinity()));
        MeshTree with_loose = refittable(loose);
        CHECK(with_loose.refit(loose.positions).has_value());
    }

    TEST_CASE(
        "boxes hold their triangles however vertices move: bent, crushed flat, to a line, to a point, far or tiny") {
        const TriangleMesh mesh = wavy_torus(2.0, 0.7, 0.2, 60, 40);
        MeshTree tree = refittable(mesh);
        std::mt19937_64 random(1);
        for (int kind = 0; kind < 9; ++kind) {
            TriangleMesh moved = bent(mesh, 0.3 * kind);
            for (glm::vec3& p : moved.positions) {
                if (kind == 2) p.z = 1.0f;
                if (kind == 3) p.z = p.y = 7.0f;
                if (kind == 4) p = glm::vec3(1.0f, 2.0f, 3.0f);
                if (kind == 5) p += glm::vec3(1e6f, -1e6f, 3e5f);
                if (kind == 6) p *= 1e-15f;
                if (kind == 7) p *= 1e11f;
                if (kind == 8) p = glm::vec3(random_vector(random));
            }
            REQUIRE(tree.refit(moved.positions).has_value());
            check_boxes(tree, moved);
            for (const MeshLeaf& leaf : tree.parts().leaves)
                for (std::uint32_t i = 0; i < leaf.count; ++i)
                    for (int v = 0; v < 3; ++v)
                        for (int c = 0; c < 3; ++c)
                            REQUIRE(leaf.vertex[v][c][i] ==
                                    moved.positions[moved.indices[3 * leaf.triangle[i] + std::size_t(v)]][c]);
        }
    }

    TEST_CASE("queries after a refit answer as on a new tree: pairs, distance, rays") {
        const TriangleMesh mesh = wavy_torus(2.0, 0.7, 0.2, 50, 30);
        MeshTree tree = refittable(mesh);
        const MeshTree other = *MeshTree::build(wavy_torus(1.0, 0.4, 0.1));
        std::mt19937_64 random(2);
        std::size_t met = 0, hit = 0;
        for (int trial = 0; trial < 20; ++trial) {
            const TriangleMesh moved = bent(mesh, 0.1 * trial);
            REQUIRE(tree.refit(moved.positions).has_value());
            const MeshTree anew = *MeshTree::build(moved);
            const RigidTransform pose = random_pose(random, 2.5);
            Vector<TrianglePair> pairs, expected;
            intersecting_triangles(tree, other, pose, pairs);
            intersecting_triangles(anew, other, pose, expected);
            CHECK(pairs == expected);
            met += !pairs.empty();
            CHECK(distance(tree, other, pose).distance == distance(anew, other, pose).distance);
            for (int r = 0; r < 20; ++r) {
                const Ray ray{4.0 * random_vector(random), random_vector(random)};
                const auto got = raycast(ray, tree), want = raycast(ray, anew);
                REQUIRE(got.has_value() == want.has_value());
                if (got) CHECK(got->triangle == want->triangle);
                hit += got.has_value();
            }
        }
        CHECK(met > 5);
        CHECK(hit > 50);
    }

    TEST_CASE("depends on the positions alone: the same bits after any refits, on every instruction set") {
        const TriangleMesh mesh = wavy_torus(2.0, 0.7, 0.2, 50, 30);
        const MeshTree built = refittable(mesh);
        MeshTree expected = built;
        REQUIRE(expected.refit(bent(mesh, 0.4).positions).has_value());
        for (std::int64_t rest = hwy::SupportedTargets(); rest != 0; rest &= rest - 1) {
            hwy::SetSupportedTargetsForTest(rest & -rest);
            MeshTree tree = built;
            REQUIRE(tree.refit(bent(mesh, 1.7).positions).has_value());
            REQUIRE(tree.refit(bent(mesh, 0.4).positions).has_value());
            CHECK(same_bits(tree, expected));
        }
        hwy::SetSupportedTargetsForTest(0);
    }

    TEST_CASE("boxes turn with the mesh: as tight after any rigid motion as when built") {
        const TriangleMesh mesh = wavy_torus(2.0, 0.7, 0.2, 50, 30);
        MeshTree tree = refittable(mesh);
        const double built = total_half_extents(tree);
        REQUIRE(tree.refit(mesh.positions).has_value());
        CHECK(total_half_extents(tree) == doctest::Approx(built).epsilon(1e-4));
        std::mt19937_64 random(3);
        for (int trial = 0; trial < 5; ++trial) {
            const RigidTransform pose = random_pose(random, 3.0);
            TriangleMesh moved = mesh;
            for (glm::vec3& p : moved.positions) p = glm::vec3(transform(pose, glm::dvec3(p)));
            REQUIRE(tree.refit(moved.positions).has_value());
            CHECK(total_half_extents(tree) == doctest::Approx(built).epsilon(1e-4));
        }
    }

    TEST_CASE("a piece held together by equal positions opens when these part, and closes when they meet again") {
        TriangleMesh mesh;
        const TriangleMesh torus = wavy_torus(2.0, 0.7, 0.2);
        for (const std::uint32_t index : torus.indices) {
            mesh.indices.push_back(std::uint32_t(mesh.positions.size()));
            mesh.positions.push_back(torus.positions[index]);
        }
        MeshTree tree = refittable(mesh);
        REQUIRE(tree.pieces().size() == 1);
        CHECK(tree.pieces()[0].closed);
        CHECK(contains(tree, {2.0, 0.0, 0.0}));
        TriangleMesh torn = mesh;
        torn.positions[100].z += 0.01f;
        REQUIRE(tree.refit(torn.positions).has_value());
        CHECK_FALSE(tree.pieces()[0].closed);
        CHECK_FALSE(contains(tree, {2.0, 0.0, 0.0}));
        REQUIRE(tree.refit(mesh.positions).has_value());
        CHECK(tree.pieces()[0].closed);
    }

    TEST_CASE("if a refit separates a piece, each part is tested for containment") {
        const TriangleMesh cube = cube_mesh(1.0f);
        const auto around = [&](float size) {
            TriangleMesh mesh = cube;
            for (glm::vec3& p : mesh.positions) p *= size;
            return std::move(*MeshTree::build(mesh));
        };
        const MeshTree room = around(50.0f);
        // Two cubes that share a corner by position; then one of separate triangles.
        TriangleMesh pair = cube, soup;
        TriangleMesh moved = cube;
        for (glm::vec3& p : moved.positions) p += glm::vec3(2.0f);
        append(pair, moved);
        for (const std::uint32_t index : cube.indices) {
            soup.indices.push_back(std::uint32_t(soup.positions.size()));
            soup.positions.push_back(cube.positions[index]);
        }
        for (const TriangleMesh& mesh : {pair, soup}) {
            MeshTree tree = refittable(mesh);
            REQUIRE(tree.pieces().size() == 1);
            CHECK(tree.pieces()[0].closed);
            CHECK(containment(tree, room, {}) == Containment::a_inside_b);
            TriangleMesh torn = mesh;
            const std::size_t gone = mesh.positions.size() == 16 ? 8 : 3;  // a cube, or a triangle
            for (std::size_t v = 0; v < gone; ++v) torn.positions[torn.positions.size() - 1 - v].x += 1000.0f;
            REQUIRE(tree.refit(torn.positions).has_value());
            CHECK_FALSE(tree.pieces()[0].closed);
            CHECK(containment(tree, room, {}) == Containment::partly);
            CHECK(containment(room, tree, {}) == Containment::partly);
            const MeshTree copy = tree;
            CHECK(containment(copy, room, {}) == Containment::partly);
            REQUIRE(tree.refit(mesh.positions).has_value());
            CHECK(tree.pieces()[0].closed);
            CHECK(containment(tree, room, {}) == Containment::a_inside_b);
        }
    }
}
